// SPDX-License-Identifier: Apache-2.0
// The guard's chain as a node of the simulated wire: frames in, the frames that it decides on out,
// a stated time later.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware_if/guard/guard_chain.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "hil_replay/replay/guard_sender.hpp"

namespace axg {

/// Why the guard withdrew the permit, or why it never gave one.
struct DriveStop {
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    ReceiverFault fault = ReceiverFault::none;  // reason input
    AxisSnapshot snapshot;                      // the last one
};

class DriveGuard {
  public:
    /// `chain` and `layout` must outlive it.
    /// @param response_us  from the last frame of a sample to its permit: what a cycle may take
    DriveGuard(GuardChain& chain, const CanLayout& layout, std::int64_t response_us);
    DriveGuard(const DriveGuard&) = delete;  // its node holds its address
    DriveGuard& operator=(const DriveGuard&) = delete;

    [[nodiscard]] GuardNode node();
    [[nodiscard]] const DriveStop& stop() const noexcept { return stop_; }
    /// Why the newest sample has no permit, though nothing is stopped.
    [[nodiscard]] DriveStop withheld() const noexcept {
        return {result_.reason, result_.pair, ReceiverFault::none, chain_.snapshot()};
    }
    [[nodiscard]] const CycleResult& result() const noexcept { return result_; }

  private:
    void on_event(const ReceiverEvent& event);

    GuardChain& chain_;
    std::int64_t response_us_;
    std::vector<CanFrame>* sent_ = nullptr;
    GuardSender sender_;
    DriveStop stop_;
    CycleResult result_;
};

}  // namespace axg
