// SPDX-License-Identifier: Apache-2.0
// The deployed guard with a wire in memory and the caller's clock, for a recorded trace and a
// simulated board. Its timers fire when the live guard's would; a call replaces the engine's
// thread, and its result arrives after the caller's delay. No allocation after construction.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "firmware_if/guard/host_wire.hpp"
#include "firmware_if/guard/live_engine.hpp"

namespace axg {

/// A cycle whose result the guard has received.
struct TimedCycle {
    const LiveResult& result;
    std::int64_t spent_ns = 0;  // by the clock of LiveEngine; 0: there is none
    bool sent_permit = false;   // a permit for it was handed to the wire
};

struct TimedGuardOptions {
    LiveOptions guard{};
    /// Arms the guard when it is ready, but not before this. INT64_MAX: never.
    std::int64_t arm_from_us = INT64_MIN;
    /// The wire echoes each frame at once. False: echoes arrive by `arrive`.
    bool echoes = true;
    /// Sends the guard's own hashes in place of a board that sends none: a recorded board may have
    /// sent them before the recording began.
    bool answers_hashes = true;
    /// Receives each frame that leaves; `time_us`: when.
    std::function<void(const CanFrame&)> sent{};
    /// Returns the engine's us for a cycle from the ns spent here; empty: 0.
    std::function<std::int64_t(std::int64_t spent_ns)> response_us{};
    /// Called after each evaluation with the ns spent here, even if its result is never received.
    std::function<void(std::int64_t spent_ns)> evaluated{};
    // After each cycle, and for each note; may be empty.
    std::function<void(const TimedCycle&)> each{};
    std::function<void(const LiveNote&)> noted{};
};

class TimedGuard {
  public:
    /// The objects that `live` refers to must outlive it.
    TimedGuard(const LiveEngine& live, const TimedGuardOptions& options, std::int64_t now_us);
    TimedGuard(const TimedGuard&) = delete;
    TimedGuard& operator=(const TimedGuard&) = delete;

    /// Runs the timers and results that are due before `until_us`, in order of time.
    void run_before(std::int64_t until_us);
    /// The same, then processes the frame at its time, or now if that has passed.
    void arrive(const CanArrival& arrival);
    /// After the last frame: runs until the guard has received the engine's pending result.
    void hear_result();
    /// Time of the next timer or result, never before now_us(); INT64_MAX: none.
    [[nodiscard]] std::int64_t next_due_us() const noexcept;
    /// Starts a new process on the same wire, after a person's reset.
    void restart(std::int64_t now_us);

    [[nodiscard]] const GuardNode& guard() const noexcept { return *guard_; }
    [[nodiscard]] bool is_stopped() const noexcept {
        return guard_->guard().phase == GuardPhase::stopped;
    }
    [[nodiscard]] bool was_armed() const noexcept { return was_armed_; }
    [[nodiscard]] std::int64_t now_us() const noexcept { return now_us_; }

  private:
    void start();
    void turn(std::int64_t now_us);
    void evaluate();
    bool take_frames();
    bool agree(const CanFrame& frame);
    void arm();

    LiveEngine live_;
    TimedGuardOptions options_;
    HostWire wire_;
    LiveQueues queues_;
    LatchCell latch_{};
    std::optional<GuardNode> guard_;
    std::int64_t now_us_;
    // State of the engine: a query waits; a result is due at its done_us.
    bool has_query_ = false, has_result_ = false, was_armed_ = false;
    LiveResult result_{};
    std::int64_t spent_ns_ = 0;
};

}  // namespace axg
