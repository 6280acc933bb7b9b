// SPDX-License-Identifier: Apache-2.0
// A motion on the simulated board with the guard on the other end of the wire, until the axes rest.
#pragma once

#include <functional>
#include <span>

#include "core/machine/machine.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "hil_replay/drive/drive_guard.hpp"

namespace axg {

// What a board of ours makes of the word slow: no axis faster than this share of its largest speed.
inline constexpr double kSlowShare = 0.25;

struct DriveOptions {
    BoardOptions board;  // the guard is given the same hashes
    BusFaults faults;
    std::int64_t response_us = 500;        // of a cycle of the guard
    std::int64_t wait_us_max = 500'000;    // for the first permit
    std::int64_t time_us_max = INT64_MAX;  // of motion
    // A board that obeys the speed cap, or the word slow: where the motion reads which share of
    // their largest speeds its axes may use. Written once a sample, after the guard's frames have
    // come.
    double* speed_share = nullptr;
    bool obeys_cap = true;  // false: the word slow alone
};

struct DriveResult {
    BoardState state = BoardState::waiting;
    BoardStopRecord board_stop;
    DriveStop guard_stop;
    EncodeResult encoded;  // not ok: a position did not fit the frames
    AxisMotions rest{};    // the true axes at the end
    std::uint64_t samples = 0, permits = 0, frames_lost = 0;
    std::int64_t moving_since_us = INT64_MIN;
    std::int64_t ended_us = 0;       // to one sample
    std::uint8_t speed_cap = 250;    // 1/250 of rapid: the least in motion since one was known
    std::uint64_t slow_samples = 0;  // in motion under a permit that says slow
};

/// What both kinds of drive do after each sample: the board obeys what a permit advises, and the
/// result counts it.
class DriveTally {
  public:
    /// @param speed_share, obeys_cap  as in DriveOptions
    DriveTally(double* speed_share, bool obeys_cap) noexcept
        : speed_share_(speed_share), obeys_cap_(obeys_cap) {}

    void note(const MotionBoard& board) noexcept;
    /// All that the board knows; of the guard and of the wire nothing.
    [[nodiscard]] DriveResult result(const Machine& machine, const MotionBoard& board) const;

  private:
    double* speed_share_;
    bool obeys_cap_, is_cap_known_ = false;
    std::uint8_t speed_cap_ = 250;
    std::uint64_t slow_samples_ = 0;
};

/// The true axes where they rest, with the tool of the stop.
[[nodiscard]] AxisSnapshot snapshot_at_rest(const Machine& machine, const DriveResult& result);

/// What a board is drawn from that keeps what the machine file promises of it, and no more.
[[nodiscard]] BoardOptions promised_board(const Machine& machine, std::uint64_t seed);

/// @param each  called after every sample; false ends the run. May be empty
/// @param watch  the true axes, every `watch_us`; may be empty
struct DriveObservers {
    std::function<bool(const MotionBoard&, const DriveGuard&)> each;
    AxisObserver watch;
    std::int64_t watch_us = 500;
};

/// `machine` and `chain` must outlive the call. Ends when the axes rest at the end of the motion or
/// after a stop, when no permit comes, or when the time is over.
[[nodiscard]] DriveResult drive(const Machine& machine, GuardChain& chain,
                                std::span<const double> start, CommandedMotion motion,
                                const DriveOptions& options, const DriveObservers& observers = {});

}  // namespace axg
