// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_run.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "firmware_if/protocol/handshake.hpp"

namespace axg {

const char* reason_text(const StopEvent& stop) noexcept {
    const bool has_reason = stop.cause == GuardFault::verdict || stop.cause == GuardFault::input;
    return has_reason ? to_text(stop.reason) : to_text(stop.cause);
}

void CountTable::add(std::uint32_t count) noexcept {
    ++cycles[std::min<std::size_t>(count, cycles.size() - 1)];
}

std::uint32_t CountTable::at_share(double share) const noexcept {
    const double all = static_cast<double>(std::accumulate(cycles.begin(), cycles.end(), 0ULL));
    double seen = 0;
    std::uint32_t count = 0;
    for (; count + 1 < cycles.size(); ++count) {
        seen += static_cast<double>(cycles[count]);
        if (seen >= share * all) {
            break;
        }
    }
    return count;
}

namespace {

/// Whether the board reports motion, or the axes moved between the last two cycles.
bool is_in_motion(const Machine& machine, const AxisSnapshot& before, const AxisSnapshot& newest) {
    if (newest.mode == kModeMoving || newest.mode == kModeJog) {
        return true;
    }
    for (std::uint32_t i = 0; i < std::min(before.axis_count, newest.axis_count); ++i) {
        if (std::abs(newest.position[i] - before.position[i]) >
            2 * machine.axes[i].position_error) {
            return true;
        }
    }
    return false;
}

}  // namespace

ReplayRun::ReplayRun(const Machine& machine, Engine engine, const ContainmentTest& containment_test,
                     const ReplayOptions& options, std::function<void(const ReplayCycle&)> observe)
    : machine_(machine),
      chain_(machine, engine, containment_test, options.parts),
      options_(options),
      observe_(std::move(observe)),
      live_{.machine = machine, .chain = chain_, .clock = options.clock},
      pairs_(machine.pairs.size()),
      limits_(machine) {
    chain_.ignore_obedience();
}

void ReplayRun::start(std::int64_t now_us) {
    TimedGuardOptions options;
    options.guard.accepts_local = true;  // of the computer that wrote the trace
    options.guard.supposes_sync = true;
    options.guard.hashes = options_.hashes;
    options.arm_from_us = options_.arm_from_us;
    options.sent = [this](const CanFrame& frame) {
        if (!is_over_ && options_.sent) {
            options_.sent(frame);
        }
    };
    if (options_.is_realtime) {
        options.response_us = [](std::int64_t spent_ns) { return (spent_ns + 999) / 1000; };
    }
    options.evaluated = [this](std::int64_t spent_ns) {
        if (!is_over_ && (!was_stopped_ || options_.keep_going)) {
            note_time(spent_ns, chain_.snapshot());
        }
    };
    options.each = [this](const TimedCycle& cycle) { on_cycle(cycle); };
    guard_.emplace(live_, options, now_us);
}

bool ReplayRun::on_frame(const CanFrame& frame) {
    ++frame_count_;
    if (frame.time_us >= ends_us_) {
        return false;
    }
    const bool is_data = !frame.error && !frame.extended;
    const bool is_guards_sync =
        is_data && machine_.can.guard_sends_sync && frame.id == machine_.can.sync_id;
    const bool is_of_a_guard = is_data && !is_guards_sync && is_guard_id(machine_.can, frame.id);
    guard_frames_ += is_of_a_guard ? 1 : 0;
    marks_guard_ = marks_guard_ || (is_of_a_guard && frame.sent_by_host);
    const bool is_read = !is_of_a_guard && !is_guards_stop(frame);
    if (!guard_ && !is_read) {
        return true;
    }
    if (!guard_) {
        start(frame.time_us);
    } else if (frame.time_us - last_us_ > kHoleUs && !guard_->was_armed()) {
        restart(frame.time_us);
    }
    last_us_ = std::max(frame.time_us, guard_->now_us());
    run_before(frame.time_us);
    if (frame.time_us >= ends_us_) {
        return false;
    }
    note_hash(frame);
    if (is_read) {  // other frames only advance the time
        guard_->arrive({.frame = frame, .is_own = is_guards_sync});
        note_guard();
    }
    return true;
}

void ReplayRun::note_hash(const CanFrame& frame) {
    HashFrame hash;
    if (frame.id == machine_.can.hashes_in_id && decode_hash(frame, hash)) {
        hashes_heard_ |= 1U << hash.part;
    }
}

/// Whether the guard in the trace sent this stop frame: by the direction that the log states. If
/// the log marks no frame of the guard, any stop frame counts while the trace has a guard. Before
/// arming any counts: no motion is permitted that a stop could end.
bool ReplayRun::is_guards_stop(const CanFrame& frame) const noexcept {
    if (!is_stop_frame(machine_.can, frame)) {
        return false;
    }
    const bool is_armed = guard_ && guard_->was_armed();
    return !is_armed || frame.sent_by_host || (guard_frames_ != 0 && !marks_guard_);
}

/// Runs timer by timer, so that a stop is noted at its time.
void ReplayRun::run_before(std::int64_t until_us) {
    while (guard_->next_due_us() < std::min(until_us, ends_us_)) {
        guard_->run_before(guard_->next_due_us() + 1);
        note_guard();
    }
}

void ReplayRun::finish() {
    if (!guard_) {
        return;
    }
    if (ends_us_ == INT64_MAX) {
        guard_->hear_result();  // in real time the last result is still pending
        note_guard();
    }
    if (ends_us_ != INT64_MAX) {
        run_before(ends_us_);
    } else if (!was_stopped_ && newest_.axis_count != 0 &&
               is_in_motion(machine_, before_, newest_)) {
        input_at_end_ = input();
        is_over_ = true;  // the trace has ended: ignore later cycles
        end_in_motion_ = {.cause = GuardFault::none, .time_us = last_us_, .snapshot = newest_};
        if (guard_->was_armed()) {
            while (!guard_->is_stopped()) {  // no further frame arrives
                guard_->run_before(guard_->next_due_us() + 1);
            }
            end_in_motion_.cause = guard_->guard().guard().cause;
            end_in_motion_.reason = guard_->guard().reason();
            end_in_motion_.fault = guard_->guard().receiver().stop_cause();
            end_in_motion_.stop_us = guard_->now_us();
        }
    }
}

void ReplayRun::restart(std::int64_t now_us) {
    permits_ = permits();
    input_ = input();
    guard_->restart(now_us);
}

std::uint64_t ReplayRun::permits() const noexcept {
    return permits_ + (guard_ ? guard_->guard().counters().permits : 0);
}

ReceiverCounters ReplayRun::input() const noexcept {
    return input_at_end_ ? *input_at_end_
           : guard_      ? input_ + guard_->guard().receiver().counters()
                         : input_;
}

void ReplayRun::on_cycle(const TimedCycle& cycle) {
    if (is_over_ || (was_stopped_ && !options_.keep_going)) {
        return;
    }
    before_ = newest_;
    newest_ = chain_.snapshot();
    const CycleResult& result = cycle.result.result;
    limits_.add(newest_, guard_->guard().receiver().state() != ReceiverState::valid);
    proven_ += result.has_permit && result.reason == StopReason::none ? 1 : 0;
    note_pairs();
    note_proofs(result);
    note_withheld(result);
    note_verdict(result);
    note_clearance_levels();
    if (observe_) {
        observe_({newest_, chain_.pair_queries(), chain_.results(), chain_.containment_results(),
                  result, cycle.result.sync_counter, cycle.sent_permit, chain_.stop_certificate(),
                  cycle.spent_ns, chain_.margin_advisory()});
    }
}

/// Notes the guard's phase after the last turns.
void ReplayRun::note_guard() {
    const GuardPhase phase = guard_->guard().guard().phase;
    was_ready_ = was_ready_ || phase == GuardPhase::ready || phase == GuardPhase::armed;
    if (phase == GuardPhase::armed && !armed_us_) {
        armed_us_ = guard_->now_us();
    }
    if (phase == GuardPhase::stopped && !was_stopped_) {
        was_stopped_ = true;
        const GuardFault cause = guard_->guard().guard().cause;
        if (cause != GuardFault::verdict) {  // that one is noted with its cycle
            note_fault(cause, guard_->guard().reason());
        }
        ends_us_ = options_.keep_going ? INT64_MAX : guard_->now_us() + kAfterStopUs;
    }
    if (was_stopped_ && options_.keep_going) {
        keep_going();
    }
}

/// Notes a fault as an event of its own, not as part of an episode.
void ReplayRun::note_fault(GuardFault cause, StopReason reason) {
    in_episode_ = false;
    note_stop({.cause = cause,
               .reason = reason,
               .fault = guard_->guard().receiver().stop_cause(),
               .measured_period_ns = guard_->guard().receiver().counters().measured_period_ns,
               .time_us = guard_->now_us(),
               .snapshot = newest_});
    in_episode_ = false;
}

/// Resets at once, as by a person, except after a verdict: its episode lasts as long as its reason,
/// unless the input fails.
void ReplayRun::keep_going() {
    const bool is_blind = guard_->guard().receiver().state() == ReceiverState::invalid &&
                          guard_->guard().receiver().stop_cause() != ReceiverFault::none;
    const bool is_verdict = guard_->guard().guard().cause == GuardFault::verdict;
    if (is_verdict && is_blind) {
        note_fault(GuardFault::input, StopReason::input);
    }
    if (!is_verdict || is_blind) {
        restart(guard_->now_us());
        was_stopped_ = false;
    }
}

void ReplayRun::note_pairs() {
    const std::span<const ContainmentResult> containment_results = chain_.containment_results();
    for (std::uint32_t i = 0; i < containment_results.size(); ++i) {
        PairStatistics& pair = pairs_[chain_.pair_queries().pair[i]];
        if (!chain_.pair_ns().empty()) {
            pair.time.add(chain_.pair_ns()[i]);
        }
        pair.not_proven += containment_results[i].containment == Containment::none ? 0 : 1;
    }
}

void ReplayRun::note_proofs(const CycleResult& result) {
    if (!is_stoppable()) {
        return;
    }
    const StopCertificate& certificate = *chain_.stop_certificate();
    std::uint32_t last = kNoIndex;  // a pair with several tools counts once
    for (const PairProof& proof : certificate.cycle().proofs) {
        const bool proven = proof.surfaces.proof == JointBoxProof::proven &&
                            proof.containment_result.containment == Containment::none;
        if (!proven && proof.pair != last) {
            ++pairs_[proof.pair].not_proven;
            last = proof.pair;
        }
    }
    ProofStatistics& all = *proofs_;
    all.queries.add(certificate.work().queries);
    all.stages.add(certificate.work().stages);
    all.queries_most = std::max(all.queries_most, certificate.work().queries);
    all.stages_most = std::max(all.stages_most, certificate.work().stages);
    all.withheld += !result.has_permit && !guard_->is_stopped() ? 1 : 0;
}

void ReplayRun::note_withheld(const CycleResult& result) {
    const bool is_settled = is_stoppable() && chain_.stop_certificate()->cycle().is_settled;
    const bool is_trusted = guard_->guard().receiver().state() == ReceiverState::valid;
    if (result.has_permit || guard_->is_stopped()) {
        return;
    }
    if (!is_trusted || !is_settled) {
        ++early_;
        return;
    }
    if (withheld_.samples++ == 0) {
        withheld_.reason = result.reason;
        withheld_.pair = result.pair;
        withheld_.limit = result.limit;
        withheld_.time_us = newest_.arrived_us;
        withheld_.snapshot = newest_;
        withheld_.unproven = chain_.unproven(result.pair);
    }
}

void ReplayRun::note_clearance_levels() {
    if (!has_clearance_levels()) {
        return;
    }
    const MarginAdvisory& advisory = *chain_.margin_advisory();
    ClearanceLevel worst = ClearanceLevel::clear;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
        const ClearanceLevel level = advisory.clearance_levels()[i].level;
        pairs_[i].slow += level == ClearanceLevel::slow ? 1 : 0;
        pairs_[i].warn += level == ClearanceLevel::warn ? 1 : 0;
        worst = std::min(worst, level);
    }
    clearance_levels_->slow += worst == ClearanceLevel::slow ? 1 : 0;
    clearance_levels_->warn += worst == ClearanceLevel::warn ? 1 : 0;
    clearance_levels_->queries.add(advisory.queries());
    clearance_levels_->queries_most = std::max(clearance_levels_->queries_most, advisory.queries());
}

void ReplayRun::note_time(std::int64_t spent_ns, const AxisSnapshot& snapshot) {
    cycles_.add(spent_ns);
    overruns_ += spent_ns > options_.deadline_us * 1000 ? 1 : 0;
    const auto end = slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_);
    const auto at = std::find_if(slowest_.begin(), end, [spent_ns](const SlowCycle& slow) {
        return spent_ns > slow.spent_ns;
    });
    if (at == slowest_.end()) {
        return;  // eight slower ones are stored
    }
    slow_count_ = std::min(slow_count_ + 1, kSlowCyclesKept);
    std::move_backward(at, slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_) - 1,
                       slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_));
    *at = {spent_ns, snapshot};
}

void ReplayRun::note_verdict(const CycleResult& result) {
    // A missing proof before arming only withholds the permit: no stop.
    if (result.reason == StopReason::none || !guard_->is_stopped()) {
        in_episode_ = false;
        return;
    }
    note_stop({.reason = result.reason,
               .pair = result.pair,
               .limit = result.limit,
               .time_us = newest_.arrived_us,
               .snapshot = newest_,
               .unproven = in_episode_ ? UnprovenPair{} : chain_.unproven(result.pair)});
}

void ReplayRun::note_stop(const StopEvent& stop) {
    if (in_episode_) {
        if (stop_count_ <= kStopsKept) {
            ++stops_[stop_count_ - 1].samples;
        }
        return;
    }
    in_episode_ = true;
    if (++stop_count_ <= kStopsKept) {
        stops_[stop_count_ - 1] = stop;
    }
}

}  // namespace axg
