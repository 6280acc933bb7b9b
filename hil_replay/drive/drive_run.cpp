// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/drive_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/guard/margin_advisory.hpp"

namespace axg {

namespace {

constexpr double kSecondsPerUs = 1e-6;

}  // namespace

BoardOptions promised_board(const Machine& machine, std::uint64_t seed) {
    BoardOptions board;
    board.seed = seed;
    board.reaction_us_max =
        static_cast<std::int64_t>(std::floor(machine.guard.board_reaction_s * 1e6));
    // The time between two samples is off by twice the jitter of one.
    board.latch_jitter_us_max =
        static_cast<std::int64_t>(std::floor(machine.guard.latch_jitter_s * 0.5e6));
    board.latched_age = machine.can.latched_age;
    board.cap = machine.guard.cap;
    return board;
}

void keep_caps(const Machine& machine, double smooth_s, double* share, AxisShares* shares,
               BoardOptions& board) {
    if (machine.guard.cap == CapPromise::none) {
        return;
    }
    const bool is_per_axis = machine.guard.cap == CapPromise::per_axis;
    board.speed_share = is_per_axis ? nullptr : share;
    board.axis_shares = is_per_axis ? shares : nullptr;
    board.cap_smooth_s = smooth_s;
    board.slow_share = has_clearance_levels(machine) ? kSlowShare : 1;
}

AxisSnapshot snapshot_at_rest(const Machine& machine, const DriveResult& result) {
    AxisSnapshot snapshot = result.guard_stop.snapshot;
    snapshot.mode = kModeStandstill;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
        snapshot.position[i] = result.rest[i].position;
    }
    return snapshot;
}

namespace {

/// Treats a cap of 0 as the lowest feed, because axes at rest would wait forever. If that feed is
/// not certified either, the end of the permit stops them.
double share_of(const PermitWatch& permits, bool obeys_cap) noexcept {
    const double capped = std::max<double>(permits.speed_cap(), 1) / kSpeedCapRapid;
    return std::min(obeys_cap ? capped : 1, permits.is_slow() ? kSlowShare : 1);
}

}  // namespace

void DriveTally::note(const MotionBoard& board) noexcept {
    const bool is_moving = board.state() == BoardState::moving;
    const std::uint8_t speed_cap = board.permits().speed_cap();
    is_cap_known_ = is_cap_known_ || speed_cap > 0;
    if (is_cap_known_ && is_moving) {
        speed_cap_ = std::min(speed_cap_, speed_cap);
    }
    if (speed_share_ != nullptr) {
        *speed_share_ = share_of(board.permits(), obeys_cap_);
    }
    slow_samples_ += is_moving && board.permits().is_slow() ? 1U : 0U;
    const std::uint8_t samples = board.permits().samples();
    if (is_moving && samples != 0) {
        samples_least_ = samples_least_ == 0 ? samples : std::min(samples_least_, samples);
    }
    if (lost_s_ != nullptr && is_moving) {
        note_cap(board);
    }
}

void DriveTally::note_cap(const MotionBoard& board) noexcept {
    const std::uint8_t cap = board.permits().speed_cap();
    const double now_s =
        static_cast<double>(board.next_latch_us() - board.moving_since_us()) * kSecondsPerUs;
    if (cap < kCapRapid && !is_slowed_ && slow_downs_.size() < kSlowDownsMax) {
        slow_downs_.push_back({.begin_s = now_s});
        lost_before_s_ = *lost_s_;
    }
    is_slowed_ = cap < kCapRapid;
    if (!slow_downs_.empty()) {  // its cost is final when the axes are fast again
        SlowDown& last = slow_downs_.back();
        last.least = is_slowed_ ? std::min(last.least, cap) : last.least;
        last.seconds = is_slowed_ ? now_s - last.begin_s : last.seconds;
        last.lost_s = *lost_s_ - lost_before_s_;
    }
}

DriveResult DriveTally::result(const Machine& machine, const MotionBoard& board) const {
    DriveResult result;
    result.state = board.state();
    result.board_stop = board.stop();
    result.encoded = board.encode_status();
    std::copy(board.axes().begin(), board.axes().end(), result.rest.begin());
    result.samples = board.samples();
    result.permits = board.permits().permits();
    result.moving_since_us = board.moving_since_us();
    result.ended_us = board.next_latch_us() - machine.can.sample_us;
    result.speed_cap = speed_cap_;
    result.slow_samples = slow_samples_;
    result.samples_least = samples_least_;
    result.slow_downs = slow_downs_;
    result.lost_s = lost_s_ != nullptr ? *lost_s_ : 0;
    result.cap_breaches = board.cap_breaches();
    return result;
}

DriveResult drive(const Machine& machine, GuardChain& chain, std::span<const double> start,
                  CommandedMotion motion, const DriveOptions& options,
                  const DriveObservers& observers) {
    MotionBoard board(machine, start, std::move(motion), options.board);
    if (observers.watch) {
        board.watch(observers.watch, observers.watch_us);
    }
    DriveGuard guard(machine, chain, options.board.hashes, options.response_us,
                     board.next_latch_us(), options.faults.killed_from_us);
    BusOptions bus;
    bus.permit_id = machine.can.permit_id;
    bus.heartbeat_id = machine.can.heartbeat_out_id;
    bus.guard_sync_id = machine.can.guard_sends_sync ? machine.can.sync_id : 0;
    bus.period_us = machine.can.sample_us;
    bus.faults = options.faults;
    bus.seed = options.board.seed + 1;
    ClosedLoop loop(board, bus, guard.node());
    // A board with a look-ahead path fills its buffer first.
    const std::int64_t buffer_us =
        std::int64_t{machine.can.look_ahead_samples} * machine.can.sample_us;
    const std::int64_t wait_ends_us = kBoardStartUs + options.wait_us_max + buffer_us;
    bool goes_on = true;
    DriveTally tally(options.speed_share, options.obeys_cap, options.lost_s);
    bool is_held = false;
    while (goes_on && !board.is_at_rest()) {
        if (!loop.cycle()) {
            break;
        }
        tally.note(board);
        const bool is_waiting = board.state() == BoardState::waiting;
        is_held = guard.result().is_held;
        goes_on = !is_held && (!is_waiting || board.next_latch_us() < wait_ends_us) &&
                  board.next_latch_us() - kBoardStartUs < options.time_us_max &&
                  !(is_waiting && guard.stop().cause != GuardFault::none);
        if (observers.each) {
            goes_on = observers.each(board, guard) && goes_on;
        }
    }
    DriveResult result = tally.result(machine, board);
    result.guard_stop = guard.stop();
    if (result.state == BoardState::waiting && result.guard_stop.cause == GuardFault::none) {
        result.guard_stop = guard.withheld();
    }
    result.frames_lost = loop.bus().lost();
    result.is_held = is_held;
    return result;
}

}  // namespace axg
