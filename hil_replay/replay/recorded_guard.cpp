// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/recorded_guard.hpp"

#include <algorithm>

namespace axg {
namespace {

bool is_same(const CanFrame& a, const CanFrame& b) noexcept {
    return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.fd == b.fd &&
           a.bit_rate_switch == b.bit_rate_switch && a.length_bytes == b.length_bytes &&
           std::equal(a.data.begin(), a.data.begin() + a.length_bytes, b.data.begin());
}

}  // namespace

void RecordedWire::differ(const SentFrame& sent) noexcept {
    ++comparison_.different;
    if (!comparison_.first_different) {
        comparison_.first_different = sent;
    }
}

SendStatus RecordedWire::send(const CanFrame& frame) noexcept {
    if (made_ == sent_.size()) {
        differ({.frame = frame, .status = SendStatus::ok});
        return SendStatus::ok;
    }
    const SentFrame& recorded = sent_[made_++];
    if (is_same(frame, recorded.frame)) {
        ++comparison_.same;
    } else {
        differ(recorded);
    }
    return recorded.status;
}

ReadStatus RecordedWire::read(CanArrival& out) noexcept {
    if (read_ == readings_.size()) {
        return ReadStatus::none;
    }
    out = readings_[read_].arrival;
    return readings_[read_++].status;
}

void RecordedWire::end_turn() noexcept {
    for (; made_ < sent_.size(); ++made_) {
        differ(sent_[made_]);
    }
    readings_.clear();
    sent_.clear();
    read_ = made_ = 0;
}

RecordedGuard::RecordedGuard(const Machine& machine, const LiveOptions& options, bool is_latched,
                             std::int64_t now_us)
    : turn_us_(now_us) {
    set_latch(latch_, is_latched);
    guard_.emplace(machine, options, wire_, queues_, latch_, now_us);
}

void RecordedGuard::on_turn(std::int64_t time_us) {
    if (has_turn_ && time_us != turn_us_) {
        run();
    }
    has_turn_ = true;
    turn_us_ = time_us;
}

// A turn gets results, then reads, then sends: a record of an earlier kind begins the next one.
void RecordedGuard::on(const RecordedWire::Reading& reading, std::int64_t time_us) {
    if (wire_.has_sent()) {
        run();
    }
    on_turn(time_us);
    wire_.add(reading);
}

void RecordedGuard::on(const SentFrame& sent, std::int64_t time_us) {
    on_turn(time_us);
    wire_.add(sent);
}

void RecordedGuard::on(const LiveResult& live_result, std::int64_t time_us) {
    if (wire_.has_readings() || wire_.has_sent()) {
        run();
    }
    on_turn(time_us);
    // The guard removes all results in this turn.
    [[maybe_unused]] const bool is_pushed = queues_.results.push(live_result);
}

/// Defers the call to the next turn, because the frames it sends are recorded with that turn.
void RecordedGuard::on(const LiveCall& call, std::int64_t time_us) {
    run();
    calls_.push_back({call, time_us});
}

void RecordedGuard::make(const LiveCall& call, std::int64_t time_us) {
    switch (call.kind) {
        case LiveCall::Kind::arm:
            guard_->arm(time_us);
            break;
        case LiveCall::Kind::reset:
            guard_->reset(time_us);
            break;
        case LiveCall::Kind::report:
            guard_->report(call.fault, time_us);
            break;
    }
}

void RecordedGuard::make_calls() {
    for (const auto& [call, time_us] : calls_) {
        make(call, time_us);
    }
    calls_.clear();
}

void RecordedGuard::end() {
    run();
    make_calls();
    run();
}

void RecordedGuard::run() {
    if (has_turn_) {
        make_calls();
        guard_->turn(turn_us_);
        has_turn_ = false;
    }
    wire_.end_turn();
    LiveQuery query;
    while (queues_.queries.pop(query)) {  // the recorded results replace theirs
    }
    LiveNote note;
    while (queues_.notes.pop(note)) {
        if (note.kind == LiveNote::Kind::input) {
            fault_ = note.fault;
        } else if (note.kind == LiveNote::Kind::phase && note.phase == GuardPhase::stopped) {
            stop_ = note;
            stop_fault_ = note.cause == GuardFault::input ? fault_ : ReceiverFault::none;
        }
    }
}

}  // namespace axg
