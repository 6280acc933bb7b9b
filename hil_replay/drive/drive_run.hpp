// SPDX-License-Identifier: Apache-2.0
// Runs a motion on the simulated board, with the guard on the same wire, until the axes rest.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "hil_replay/drive/drive_guard.hpp"

namespace axg {

// Under the word slow a simulated board limits each axis to this share of its largest speed.
inline constexpr double kSlowShare = 0.25;

/// A stretch of time in which the permits ordered less than rapid.
struct SlowDown {
    double begin_s = 0, seconds = 0;  // since the axes began to move
    double lost_s = 0;                // its cost, if the motion reports it
    std::uint8_t least = kCapRapid;   // 1/250 of rapid
};

struct DriveOptions {
    BoardOptions board;  // the guard is given the same hashes
    BusFaults faults;
    std::int64_t response_us = 500;        // of a cycle of the guard
    std::int64_t wait_us_max = 500'000;    // for the first permit
    std::int64_t time_us_max = INT64_MAX;  // of motion
    // For a board that obeys the speed cap or the word slow: bound of its axes as a share of their
    // largest speeds, which the motion reads. Written once a sample, after the guard's frames have
    // arrived.
    double* speed_share = nullptr;
    bool obeys_cap = true;  // false: only the word slow
    // For a board with enforced caps (BoardOptions::cap): their cost so far, from the motion.
    const double* lost_s = nullptr;
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
    std::uint8_t speed_cap = 250;    // 1/250 of rapid: the least in motion since the first
    std::uint64_t slow_samples = 0;  // in motion, with the word slow
    std::uint8_t samples_least = 0;  // n of the shortest permit in motion; 0: there was none
    // For a board with enforced caps.
    std::vector<SlowDown> slow_downs{};
    double lost_s = 0;
    std::uint64_t cap_breaches = 0;  // MotionBoard::cap_breaches
    bool is_held = false;            // it waits on its path for so long that a person has to act
};

/// Work of both kinds of drive after each sample: passes the permit's advice to the motion, and
/// counts it for the result.
class DriveTally {
  public:
    /// @param speed_share, obeys_cap, lost_s  as in DriveOptions
    DriveTally(double* speed_share, bool obeys_cap, const double* lost_s = nullptr)
        : speed_share_(speed_share), lost_s_(lost_s), obeys_cap_(obeys_cap) {
        slow_downs_.reserve(kSlowDownsMax);
    }

    void note(const MotionBoard& board) noexcept;
    /// Returns the board's part of the result; the fields of guard and wire have their defaults.
    [[nodiscard]] DriveResult result(const Machine& machine, const MotionBoard& board) const;

    static constexpr std::size_t kSlowDownsMax = 10'000;  // further ones are added to the last

  private:
    void note_cap(const MotionBoard& board) noexcept;

    double* speed_share_;
    const double* lost_s_;
    std::vector<SlowDown> slow_downs_;
    double lost_before_s_ = 0;  // before the last slow-down
    bool is_slowed_ = false;
    std::uint8_t samples_least_ = 0;
    bool obeys_cap_, is_cap_known_ = false;
    std::uint8_t speed_cap_ = 250;
    std::uint64_t slow_samples_ = 0;
};

/// The true axes where they rest, with the tool of the stop.
[[nodiscard]] AxisSnapshot snapshot_at_rest(const Machine& machine, const DriveResult& result);

/// Options for drawing a board that fulfils the promises of the machine file, and no more.
[[nodiscard]] BoardOptions promised_board(const Machine& machine, std::uint64_t seed);

/// If the machine file promises a cap, makes the board follow the caps of the permits: it sets
/// `share` or `shares` at every tick, and the motion reads them. Both must outlive the drive.
void keep_caps(const Machine& machine, double smooth_s, double* share, AxisShares* shares,
               BoardOptions& board);

/// @param each  called after every sample; false ends the run. May be empty
/// @param watch  the true axes, every `watch_us`; may be empty
struct DriveObservers {
    std::function<bool(const MotionBoard&, const DriveGuard&)> each;
    AxisObserver watch;
    std::int64_t watch_us = 500;
};

/// `machine` and `chain` must outlive the call. Ends when the axes rest at the end of the motion or
/// after a stop, when no permit arrives, when a hold lasts too long, or when the time is over.
[[nodiscard]] DriveResult drive(const Machine& machine, GuardChain& chain,
                                std::span<const double> start, CommandedMotion motion,
                                const DriveOptions& options, const DriveObservers& observers = {});

}  // namespace axg
