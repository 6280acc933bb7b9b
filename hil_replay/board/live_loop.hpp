// SPDX-License-Identifier: Apache-2.0
// Runs the board on a wire in real time: it latches and sends each sample when the clock of the
// wire reaches its instant, and processes each frame with its arrival time. The caller passes in
// clock and wait, so that a test can replace both. A cycle allocates no memory.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/machine/machine.hpp"
#include "firmware_if/can/can_transport.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

/// The clock that stamps the frames of the wire, us.
struct LiveClock {
    std::function<std::int64_t()> now_us;
    /// Returns at this instant, or earlier if a frame may have arrived.
    std::function<void(std::int64_t until_us)> wait;
};

/// Events on the wire that concern the board.
struct LiveWireReport {
    std::uint64_t late_periods = 0;        // frames left more than half a period after the latch
    std::int64_t late_us_max = 0;          // of all periods, from the latch to the last frame
    std::uint64_t frames_refused = 0;      // by the interface: they were never sent
    bool is_lost = false;                  // the interface went down, or was removed
    std::uint32_t other_board_id = 0;      // frame of the board from another sender; 0: none
    std::optional<Emergency> emergency{};  // the guard's last one that reports a stop
};

class LiveLoop {
  public:
    // Before the first sample: 20 heartbeats of another board.
    static constexpr std::int64_t kListenUs = 200'000;

    /// `machine`, `board` and `wire` must outlive it. Discards the frames already queued on the
    /// wire: the stop of an earlier guard does not concern this board.
    LiveLoop(const Machine& machine, MotionBoard& board, CanTransport& wire, LiveClock clock);

    /// Receives until the first sample is due. False: another node sends the frames of the board
    /// and may move a machine: do not send.
    [[nodiscard]] bool listen();
    /// Sends one sample when it is due, and processes every frame up to the next. False: the board
    /// cannot send.
    [[nodiscard]] bool cycle();

    [[nodiscard]] const LiveWireReport& report() const noexcept { return report_; }
    /// Now, on the board's clock.
    [[nodiscard]] std::int64_t board_now_us() const { return clock_.now_us() - later_us_; }

  private:
    void hear_until_latch();
    void drain();
    void on_arrival(const CanArrival& arrival);
    void send(const CanFrame& frame);
    [[nodiscard]] bool is_of_a_board(const CanFrame& frame) const noexcept;

    const CanLayout& can_;
    AxisFrameSet set_;
    MotionBoard& board_;
    CanTransport& wire_;
    LiveClock clock_;
    std::int64_t later_us_;    // time of the clock minus time of the board
    std::int64_t latched_us_;  // last sample, on the board's clock
    LiveWireReport report_;
};

}  // namespace axg
