// SPDX-License-Identifier: Apache-2.0
// The simulation of a program with its progress, for the commands `simulate` and `verify`.
#pragma once

#include <cstdint>
#include <string>

#include "hil_replay/simulate/trace_simulation.hpp"

namespace axg {

/// Writes the trace, with a line of progress on a terminal.
[[nodiscard]] SimulationSummary simulate_with_progress(const Machine& machine,
                                                       const Program& program,
                                                       std::uint32_t line_count,
                                                       SimulationOptions options,
                                                       const std::string& output);

}  // namespace axg
