// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/black_box_replay.hpp"

#include <algorithm>
#include <cstring>

namespace axg {
namespace {

bool is_same(const ReceiverEvent& a, const ReceiverEvent& b) noexcept {
    const AxisSnapshot &p = a.snapshot, &q = b.snapshot;
    return a.kind == b.kind && a.state == b.state && a.sync_counter == b.sync_counter &&
           p.latched_us == q.latched_us && p.arrived_us == q.arrived_us && p.tool == q.tool &&
           p.mode == q.mode && p.flags == q.flags && p.axis_count == q.axis_count &&
           std::memcmp(p.position.data(), q.position.data(), p.axis_count * sizeof(double)) == 0;
}

bool is_same(const CycleResult& a, const CycleResult& b) noexcept {
    return a.has_permit == b.has_permit && a.is_stop == b.is_stop && a.reason == b.reason &&
           a.pair == b.pair && a.not_proven == b.not_proven &&
           a.known_answer_signature == b.known_answer_signature &&
           (!a.has_permit || a.is_jog == b.is_jog);
}

/// Numbers are counted modulo 2^32.
bool is_after(std::uint32_t a, std::uint32_t b) noexcept {
    return static_cast<std::int32_t>(a - b) > 0;
}

}  // namespace

bool can_be_reproduced(const ReplayedBlackBox& result) noexcept {
    return result.recorded && (result.sent || result.recorded->cause == GuardFault::verdict ||
                               result.recorded->cause == GuardFault::input);
}

bool is_reproduced(const ReplayedBlackBox& result) noexcept {
    if (!result.recorded || !result.replayed) {
        return false;
    }
    const BlackBoxStop &a = *result.recorded, &b = *result.replayed;
    return a.cause == b.cause && a.reason == b.reason && a.pair == b.pair && a.fault == b.fault &&
           a.latched_us == b.latched_us;
}

void BlackBoxReplay::on_record(const BlackBoxRecord& record) {
    const std::int64_t time_us = record.entry.time_us;
    if (result_.records == 0) {
        result_.first_us = time_us;
        turn_us_ = time_us;
        is_whole_ = record.sequence == 0;
        runs_in_snapshots_ = runs_in_verdicts_ = !is_whole_;
        if (!is_whole_) {
            receiver_.suppose_period();
        }
    }
    if (time_us != turn_us_) {  // that turn of the bus thread ended with a look at the clock
        on_receiver(receiver_.on_time(turn_us_));
        turn_us_ = time_us;
    }
    ++result_.records;
    result_.last_us = time_us;
    std::visit([this](const auto& content) { on(content); }, record.entry.content);
}

/// Without the guard, chain and receiver each stop once until a reset; the guard's note states
/// which of the two it was.
ReplayedBlackBox BlackBoxReplay::result() {
    ReplayedBlackBox out = result_;
    const bool is_input = out.recorded && out.recorded->cause == GuardFault::input;
    out.replayed = is_input ? input_ : verdict_;
    if (guard_) {
        compare_sent(out);
    }
    if (!out.recorded) {
        out.refused = withheld_;
    } else if (out.replayed && out.replayed->cause == GuardFault::verdict) {
        out.refused = stopped_;
    }
    return out;
}

/// Adds the frames and the stop of the guard that ran again.
void BlackBoxReplay::compare_sent(ReplayedBlackBox& out) {
    guard_->end();
    out.sent = guard_->comparison();
    out.replayed.reset();
    if (const std::optional<LiveNote>& stop = guard_->stop()) {
        out.replayed = BlackBoxStop{.cause = stop->cause,
                                    .reason = stop->reason,
                                    .pair = stop->pair,
                                    .fault = guard_->stop_fault(),
                                    .time_us = stop->time_us,
                                    .latched_us = stop->cause == GuardFault::verdict && verdict_
                                                      ? verdict_->latched_us
                                                      : 0};
    }
}

void BlackBoxReplay::on(const CanArrival& arrival) {
    if (guard_) {
        guard_->on({.status = ReadStatus::frame, .arrival = arrival}, turn_us_);
    }
    if (arrival.is_own) {
        ++result_.echoes;
        on_echo(arrival.frame);
        if (machine_.can.guard_sends_sync && arrival.frame.id == machine_.can.sync_id) {
            CanFrame sync = arrival.frame;
            sync.sent_by_host = false;
            on_receiver(receiver_.on_frame(sync));
        }
        return;
    }
    ++result_.frames_read;
    on_receiver(receiver_.on_frame(arrival.frame));
}

void BlackBoxReplay::on_echo(const CanFrame& frame) {
    const bool is_permit = frame.id == machine_.can.permit_id && frame.length_bytes == 8 &&
                           frame.data[0] != static_cast<std::uint8_t>(PermitWord::stop);
    if (is_permit && frame.data[1] < arrived_us_.size() && arrived_us_[frame.data[1]] != 0) {
        std::int64_t& arrived_us = arrived_us_[frame.data[1]];
        result_.permit_time.add((frame.time_us - arrived_us) * 1000);
        arrived_us = 0;
    } else if (frame.id == machine_.can.stop_id && stop_since_us_ != 0) {
        result_.stop_us = frame.time_us - stop_since_us_;
        stop_since_us_ = 0;
    }
}

void BlackBoxReplay::on(ReadStatus status) {
    if (guard_) {
        guard_->on({.status = status, .arrival = {}}, turn_us_);
    }
}

void BlackBoxReplay::on(const EmptyTurn&) {
    if (guard_) {
        guard_->on_turn(turn_us_);
    }
}

void BlackBoxReplay::on(const LiveCall& call) {
    if (guard_) {
        guard_->on(call, turn_us_);
    }
}

void BlackBoxReplay::on(const SentFrame& sent) {
    if (guard_) {
        guard_->on(sent, turn_us_);
    }
    ++(sent.status == SendStatus::ok ? result_.frames_sent : result_.frames_refused);
}

void BlackBoxReplay::on_receiver(const ReceiverEvent& event) {
    if (event.kind == ReceiverEvent::Kind::snapshot ||
        event.kind == ReceiverEvent::Kind::look_ahead) {
        made_ = event;
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        input_ = {.cause = GuardFault::input,
                  .reason = StopReason::input,
                  .fault = event.fault,
                  .time_us = event.time_us};
    }
}

void BlackBoxReplay::on(const LiveQuery& query) {
    const ReceiverEvent& event = query.event;
    if (query.kind == LiveQuery::Kind::snapshot && event.sync_counter < arrived_us_.size()) {
        arrived_us_[event.sync_counter] = event.snapshot.arrived_us;
    }
    if (query.kind != LiveQuery::Kind::self_test && made_) {
        if (query.kind == LiveQuery::Kind::snapshot) {
            compare(query.event);
        }
        waiting_.push_back({query.number, query.kind, query.is_armed, *made_, query.caps});
    } else if (query.kind == LiveQuery::Kind::snapshot) {
        ++(runs_in_snapshots_ ? result_.snapshots.run_in : result_.snapshots.different);
    }
    made_.reset();
}

void BlackBoxReplay::compare(const ReceiverEvent& recorded) {
    const bool agrees = is_same(recorded, *made_);
    runs_in_snapshots_ = runs_in_snapshots_ && !agrees;
    ++(agrees               ? result_.snapshots.same
       : runs_in_snapshots_ ? result_.snapshots.run_in
                            : result_.snapshots.different);
}

void BlackBoxReplay::on(const LiveResult& live_result) {
    if (live_result.kind != LiveQuery::Kind::snapshot) {
        if (guard_) {
            guard_->on(live_result, turn_us_);
        }
        return;
    }
    std::optional<Heard> queried;
    while (!waiting_.empty() && !is_after(waiting_.front().number, live_result.taken)) {
        const Heard& heard = waiting_.front();
        chain_.take(heard.event, heard.caps);
        taken_ += heard.kind == LiveQuery::Kind::snapshot ? 1 : 0;
        if (heard.number == live_result.number) {
            queried = heard;
        }
        waiting_.pop_front();
    }
    if (!queried) {  // its frames were before the dump
        ++(runs_in_verdicts_ ? result_.verdicts.run_in : result_.verdicts.different);
        return;
    }
    chain_.evaluate();
    const CycleResult made =
        chain_.decide(queried->event.state == ReceiverState::valid, queried->is_armed);
    withheld_.reset();
    if (!made.has_permit) {
        withheld_ = chain_.refused(made);
    }
    if (guard_) {
        LiveResult dated = live_result;
        dated.result = made;
        guard_->on(dated, turn_us_);
    }
    if (made.is_stop && !has_verdict_) {
        stopped_ = withheld_;
        has_verdict_ = !runs_in_verdicts_;
        verdict_ = {.cause = GuardFault::verdict,
                    .reason = made.reason,
                    .pair = made.pair,
                    .time_us = live_result.done_us,
                    .latched_us = queried->event.snapshot.latched_us};
    }
    compare(live_result, made);
    if (!guard_) {  // the chain lacks earlier state: follow the recorded order
        chain_.set_cap_order(live_result.result.cap_order);
    }
    // Advice of a permit; of an enforced cap, when it requests the proof of a raise.
    if (guard_ || machine_.guard.cap != CapPromise::none) {
        chain_.update_advisories();
    }
}

void BlackBoxReplay::compare(const LiveResult& recorded, const CycleResult& made) {
    const bool agrees = is_same(recorded.result, made);
    runs_in_verdicts_ = runs_in_verdicts_ && (!agrees || taken_ < kRunInSnapshots);
    ++(runs_in_verdicts_ ? result_.verdicts.run_in
       : agrees          ? result_.verdicts.same
                         : result_.verdicts.different);
    if (!agrees && !runs_in_verdicts_ && !result_.first_different) {
        result_.first_different = recorded;
    }
    if (recorded.result.is_stop && !is_stopped_) {  // its note states the guard's reaction
        stopping_us_ = recorded.latched_us;
        stop_since_us_ = recorded.arrived_us;
    }
}

void BlackBoxReplay::on(const LiveNote& note) {
    if (note.kind == LiveNote::Kind::phase) {
        if (is_whole_ && !guard_) {  // the first note of a process states its first phase
            guard_.emplace(machine_, options_, note.phase == GuardPhase::stopped, note.time_us);
        }
        is_stopped_ = note.phase == GuardPhase::stopped;
        if (note.phase == GuardPhase::init) {  // by a person's reset
            receiver_.acknowledge();
            has_verdict_ = false;
        }
    }
    if (note.kind == LiveNote::Kind::input) {
        recorded_fault_ = note.fault;
    } else if (note.kind == LiveNote::Kind::phase && note.phase == GuardPhase::stopped) {
        const bool is_verdict = note.cause == GuardFault::verdict;
        const bool is_input = note.cause == GuardFault::input;
        result_.recorded = {.cause = note.cause,
                            .reason = note.reason,
                            .pair = note.pair,
                            .fault = is_input ? recorded_fault_ : ReceiverFault::none,
                            .time_us = note.time_us,
                            .latched_us = is_verdict ? stopping_us_ : 0};
    }
}

void BlackBoxReplay::on(const LostRecords& lost) {
    result_.lost += lost.count;
    is_whole_ = false;
    guard_.reset();
    runs_in_snapshots_ = runs_in_verdicts_ = true;
    taken_ = 0;
}

}  // namespace axg
