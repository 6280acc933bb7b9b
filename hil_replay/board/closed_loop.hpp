// SPDX-License-Identifier: Apache-2.0
// Board and guard on one bus, cycle by cycle: each receives the other's frames when their bits have
// passed. The board's clock is the only one.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hil_replay/board/can_bus.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

/// Interface of the guard to the bus. Appends the frames it sends; `time_us`: when each is ready.
struct LoopGuard {
    std::function<void(const CanFrame& frame, std::vector<CanFrame>& sent)> on_frame;
    /// Time without a frame: at `next_due_us`, and once a cycle if the board sends SYNC; may be
    /// empty.
    std::function<void(std::int64_t now_us, std::vector<CanFrame>& sent)> on_time;
    // For a guard that receives its own frames and has timers; may be empty.
    std::function<void(const CanFrame& frame, std::vector<CanFrame>& sent)> on_echo{};
    std::function<std::int64_t()> next_due_us{};
};

class ClosedLoop {
  public:
    ClosedLoop(MotionBoard& board, const BusOptions& bus, LoopGuard guard)
        : board_(board),
          bus_(bus),
          guard_(std::move(guard)),
          guard_sync_id_(bus.guard_sync_id),
          period_us_(bus.period_us) {}

    /// Runs one sample of the board and every frame up to the next. If the guard sends SYNC: every
    /// frame up to SYNC and the sample, or a period without. False: the board cannot send.
    [[nodiscard]] bool cycle();

    [[nodiscard]] const CanBus& bus() const noexcept { return bus_; }

  private:
    void post_sent();
    void post_of_board(std::span<const CanFrame> frames);
    void deliver(const CanBus::Delivery& delivery);
    [[nodiscard]] bool next_event(std::int64_t end_us, CanBus::Delivery& delivery);
    [[nodiscard]] bool cycle_on_sync();

    MotionBoard& board_;
    CanBus bus_;
    LoopGuard guard_;
    std::uint32_t guard_sync_id_;  // 0: the board sends SYNC
    std::int64_t period_us_;
    std::vector<CanFrame> sent_;
};

}  // namespace axg
