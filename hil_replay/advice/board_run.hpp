// SPDX-License-Identifier: Apache-2.0
// A program on the simulated board once more, with other values of the machine file.
#pragma once

#include <cstdint>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/advice/trace_run.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

struct BoardRun {
    Engine engine;
    const ContainmentTest& containment_test;  // of the surfaces of the machine
    const Program& program;
    const AxisPositions& start;
    std::uint64_t seed = 1;
    std::uint32_t pair = kNoIndex;  // a hold is a stop for this one
    std::int64_t time_us_max = 0;   // of the board
};
/// Runs the program on a board that fulfils the promises of the machine file, and no more.
/// @return  nullopt if memory ran out
[[nodiscard]] std::optional<RunEnd> run_board(const LoadedMachine& loaded, const BoardRun& run);

}  // namespace axg
