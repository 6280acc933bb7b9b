// SPDX-License-Identifier: Apache-2.0
// The deployed guard as a node of the simulated wire: it receives and sends frames, and each
// cycle's result follows its sample after a stated time. It arms when it is ready.
#pragma once

#include <cstdint>
#include <vector>

#include "core/guard/distance_need.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "hil_replay/guard/timed_guard.hpp"

namespace axg {

/// Why the guard withdrew the permit, or never issued one.
struct DriveStop {
    GuardFault cause = GuardFault::none;   // none: it has not stopped
    StopReason reason = StopReason::none;  // cause none, verdict or input
    std::uint32_t pair = kNoIndex;
    ReceiverFault fault = ReceiverFault::none;  // cause input
    LimitFact limit{};                          // for left_limits
    CapFact cap{};                              // for left_cap
    AxisSnapshot snapshot;                      // the last one
    UnprovenPair unproven{};                    // stoppable mode: `pair`, as its proof failed
};

[[nodiscard]] constexpr bool has_reason(const DriveStop& stop) noexcept {
    return stop.reason != StopReason::none || stop.cause != GuardFault::none;
}
/// The reason of a verdict, an input fault or a withheld permit; the cause of any other stop.
[[nodiscard]] inline const char* reason_text(const DriveStop& stop) noexcept {
    return stop.reason != StopReason::none ? to_text(stop.reason) : to_text(stop.cause);
}

class DriveGuard {
  public:
    /// `machine` and `chain` must outlive it.
    /// @param response_us  time of a cycle, from the last frame of a sample to its permit
    /// @param killed_us  from this time on the guard neither reads nor sends
    DriveGuard(const Machine& machine, GuardChain& chain, const ConfigurationHashes& hashes,
               std::int64_t response_us, std::int64_t now_us, std::int64_t killed_us);
    DriveGuard(const DriveGuard&) = delete;  // its node contains its address
    DriveGuard& operator=(const DriveGuard&) = delete;

    [[nodiscard]] LoopGuard node();
    [[nodiscard]] const DriveStop& stop() const noexcept { return stop_; }
    /// Why the newest sample has no permit, although the guard has not stopped.
    [[nodiscard]] DriveStop withheld() const noexcept {
        return {.reason = result_.reason,
                .pair = result_.pair,
                .limit = result_.limit,
                .snapshot = chain_.snapshot(),
                .unproven = chain_.unproven(result_.pair)};
    }
    [[nodiscard]] const CycleResult& result() const noexcept { return result_; }
    /// Whether a permit was sent for the newest result.
    [[nodiscard]] bool has_permit() const noexcept { return has_permit_; }

  private:
    void note_stop();

    void take_wire(std::vector<CanFrame>& sent);

    GuardChain& chain_;
    bool sends_sync_;
    std::int64_t killed_us_;
    std::vector<CanFrame>* sent_ = nullptr;
    std::vector<CanFrame> first_;  // frames of the start, before it has a wire
    DriveStop stop_;
    CycleResult result_;
    bool has_permit_ = false;
    TimedGuard guard_;
};

}  // namespace axg
