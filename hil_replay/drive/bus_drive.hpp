// SPDX-License-Identifier: Apache-2.0
// A motion on the simulated board in real time, on a wire whose guard is another program, until the
// axes rest.
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
    DriveResult drive;  // of the guard's stop only the tool is known; frames_lost: refused
    LiveWireReport wire;
};

struct BusDriveObservers {
    std::function<void(const MotionBoard&)> each;  // after every sample; may be empty
    std::function<void(std::int64_t, const MotionBoard&)> watch;  // the true axes; may be empty
    std::int64_t watch_us = 500;
};

/// Waits for the first permit as long as nobody ends it. Sends nothing where another board is on
/// the wire. When the axes rest, some samples more tell the guard so.
/// @param is_ended  set by a person: a board that moves brakes first
[[nodiscard]] BusDriveResult drive_on_bus(const Machine& machine, CanTransport& wire,
                                          const LiveClock& clock, std::span<const double> start,
                                          CommandedMotion motion, const BusDriveOptions& options,
                                          const std::atomic<bool>& is_ended,
                                          const BusDriveObservers& observers = {});

/// What a board is drawn from that keeps what the machine file promises of it. Its samples have no
/// jitter of their own: this computer adds enough.
[[nodiscard]] BoardOptions promised_live_board(const Machine& machine, std::uint64_t seed);

}  // namespace axg
