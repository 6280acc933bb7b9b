// SPDX-License-Identifier: Apache-2.0
// Runs a motion on the simulated board in real time until the axes rest; the guard on the wire is
// another program.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "core/machine/machine.hpp"
#include "hil_replay/board/live_loop.hpp"
#include "hil_replay/drive/drive_run.hpp"

namespace axg {

struct BusDriveOptions {
    BoardOptions board;
    double* speed_share = nullptr;  // as in DriveOptions
    bool obeys_cap = true;
    const double* lost_s = nullptr;
};

struct BusDriveResult {
    DriveResult drive;  // of guard_stop only the tool is set; frames_lost: refused
    LiveWireReport wire;
};

struct BusDriveObservers {
    std::function<void(const MotionBoard&)> each;  // after every sample; may be empty
    std::function<void(std::int64_t, const MotionBoard&)> watch;  // the true axes; may be empty
    std::int64_t watch_us = 500;
};

/// Waits for the first permit until a person ends the run. Sends no frame if another board is on
/// the wire. Sends more samples after the axes rest, so that the guard detects the standstill.
/// @param is_ended  set by a person: a board that moves brakes first
[[nodiscard]] BusDriveResult drive_on_bus(const Machine& machine, CanTransport& wire,
                                          const LiveClock& clock, std::span<const double> start,
                                          CommandedMotion motion, const BusDriveOptions& options,
                                          const std::atomic<bool>& is_ended,
                                          const BusDriveObservers& observers = {});

/// Options for drawing a board that fulfils the promises of the machine file. Its samples have no
/// simulated jitter: this computer adds enough.
[[nodiscard]] BoardOptions promised_live_board(const Machine& machine, std::uint64_t seed);

}  // namespace axg
