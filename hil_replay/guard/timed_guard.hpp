// SPDX-License-Identifier: Apache-2.0
// The deployed guard, with a wire in memory and a clock that is passed in: under a recorded trace
// and a simulated board. Its timers fire when the live guard's would; the engine's thread is a
// call, whose result comes as much later as its caller says. No allocation after construction.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "firmware_if/guard/host_wire.hpp"
#include "firmware_if/guard/live_engine.hpp"

namespace axg {

/// A cycle whose result the guard has heard.
struct TimedCycle {
    const LiveResult& result;
    std::int64_t spent_ns = 0;  // by the clock of LiveEngine; 0: there is none
    bool sent_permit = false;   // a permit for it was handed to the wire
};

struct TimedGuardOptions {
    LiveOptions guard{};
    /// When the guard is ready, it is armed: at once, or not before this. INT64_MAX: never.
    std::int64_t arm_from_us = INT64_MIN;
    /// The wire gives each frame back at once. False: echoes come by `arrive`.
    bool echoes = true;
    /// Says the guard's own hashes in place of a board that says none: a recorded one may have been
    /// asked before the recording began.
    bool answers_hashes = true;
    /// Takes each frame that leaves, `time_us`: when.
    std::function<void(const CanFrame&)> sent{};
    /// us that the engine takes for a cycle, of ns that it took here; empty: none.
    std::function<std::int64_t(std::int64_t spent_ns)> response_us{};
    /// After each evaluation, whether its result will be heard or not: ns that it took here.
    std::function<void(std::int64_t spent_ns)> evaluated{};
    // After each cycle, and for each note; may be empty.
    std::function<void(const TimedCycle&)> each{};
    std::function<void(const LiveNote&)> noted{};
};

class TimedGuard {
  public:
    /// `live` and what it names must outlive it.
    TimedGuard(const LiveEngine& live, const TimedGuardOptions& options, std::int64_t now_us);
    TimedGuard(const TimedGuard&) = delete;
    TimedGuard& operator=(const TimedGuard&) = delete;

    /// Timers and results that are due before `until_us`, in order of time.
    void run_before(std::int64_t until_us);
    /// The same, then the frame at its time, or now where that has passed.
    void arrive(const CanArrival& arrival);
    /// Turns on until the result that the engine works on is heard: nothing comes any more.
    void hear_result();
    /// When something is due, never before now_us(); INT64_MAX: never.
    [[nodiscard]] std::int64_t next_due_us() const noexcept;
    /// A new process on the same wire, after a person's reset.
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
    // Of the engine: a query waits; a result comes at its done_us.
    bool has_query_ = false, has_result_ = false, was_armed_ = false;
    LiveResult result_{};
    std::int64_t spent_ns_ = 0;
};

}  // namespace axg
