// SPDX-License-Identifier: Apache-2.0
// axguard replay of a black box: a dump of axguardd in the place of a trace.
#pragma once

#include <string>

#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/place/program_finder.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {

struct BlackBoxArguments {
    std::string file, engine;
    std::string frames_out{};          // candump log of every frame in it; empty: none
    bool any_machine = false;          // judge with another machine than the dump's
    ProgramFinder* program = nullptr;  // opened; null: no program
    Detail detail = Detail::brief;     // of the reason
    JsonOutput json{};
};

/// Whether a file begins as a dump does.
[[nodiscard]] bool is_black_box_file(const std::string& path);

/// An exit code of docs/reference/commands.md.
[[nodiscard]] int replay_black_box(const BlackBoxArguments& arguments, LoadedMachine& loaded);

}  // namespace axg
