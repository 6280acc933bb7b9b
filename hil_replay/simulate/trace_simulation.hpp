// SPDX-License-Identifier: Apache-2.0
// Writes a program's motion to a log, as the CAN frames that a motion board would send.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "hil_replay/motion/motion_limits.hpp"
#include "hil_replay/motion/motion_path.hpp"
#include "hil_replay/motion/program.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {

inline constexpr std::int64_t kTraceStartUs =
    1'000'000;  // fixed, so that equal programs give equal bytes
inline constexpr double kStandstillCounts =
    0.05;  // frame counts a sample; slower axes count as at rest

struct SimulationOptions {
    std::uint32_t sample_us = 1000;  // a multiple of 100
    std::uint64_t samples_max = UINT64_MAX;
    MotionOptions motion;
    std::function<void(double program_s, std::uint32_t line)>
        progress;  // now and then; may be empty
};

struct SimulationSummary {
    std::string error;  // empty: the log is complete under its name
    std::int32_t exit_code = 0;
    double program_s = 0;
    double path_mm = 0;  // of X Y Z
    std::uint64_t samples = 0, frames = 0;
    std::uint32_t runs = 0, blends = 0;  // standstill to standstill; corners passed without one
    ProgramLines lines;                  // the line of every sample; blocks and files not yet
    std::array<LimitMeter::Peak, kAxesMax> peaks{};  // mm/s.. or rad/s.., on the 0.1 ms grid
};

/// Writes `path` under a temporary name first. The log begins at kTraceStartUs with the start pose
/// and ends with one sample of the end pose at rest. The machine's CanLayout defines the frames;
/// options.sample_us replaces its sample_us.
[[nodiscard]] SimulationSummary simulate_trace(const Machine& machine, const Program& program,
                                               const SimulationOptions& options,
                                               const std::string& path);

}  // namespace axg
