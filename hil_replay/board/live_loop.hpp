// SPDX-License-Identifier: Apache-2.0
// The board on a wire in real time: it latches and sends each sample when the clock of the wire has
// reached its instant, and hears each frame at the instant at which it arrived. Clock and wait are
// passed in: a test has its own of both. No allocation in a cycle.
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
    /// Returns at this instant; before it where a frame may be there.
    std::function<void(std::int64_t until_us)> wait;
};

/// What the wire did to the board.
struct LiveWireReport {
    std::uint64_t late_periods = 0;        // frames left more than half a period after the latch
    std::int64_t late_us_max = 0;          // of all periods, from the latch to the last frame
    std::uint64_t frames_refused = 0;      // by the interface: they were never sent
    bool is_lost = false;                  // the interface went down, or was removed
    std::uint32_t other_board_id = 0;      // frame of the board from another sender; 0: none
    std::optional<Emergency> emergency{};  // the last one of the guard that told of a stop
};

class LiveLoop {
  public:
    // Before the first sample: 20 heartbeats of another board.
    static constexpr std::int64_t kListenUs = 200'000;

    /// `machine`, `board` and `wire` must outlive it. What the wire holds already is forgotten: the
    /// stop of an earlier guard is none of this board's.
    LiveLoop(const Machine& machine, MotionBoard& board, CanTransport& wire, LiveClock clock);

    /// Hears until the first sample is due. False: another node sends the frames of the board, and
    /// may move a machine: nothing may be sent.
    [[nodiscard]] bool listen();
    /// One sample when it is due, and every frame up to the next. False: the board can not send.
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
    std::int64_t later_us_;    // instants of the clock less those of the board
    std::int64_t latched_us_;  // last sample, on the board's clock
    LiveWireReport report_;
};

}  // namespace axg
