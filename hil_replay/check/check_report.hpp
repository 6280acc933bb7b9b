// SPDX-License-Identifier: Apache-2.0
// What `axguard check` says about a machine, section by section: words for people and the same
// facts as JSON. Each section prints and fills its own key; a section adds nothing to what was
// computed elsewhere.
#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

struct CheckReport {
    const LoadedMachine& loaded;
    std::FILE* words;
    nlohmann::ordered_json& document;
    std::vector<std::string> warnings;  // what does not hinder, but ought to be looked at
    EngineChoice engine = EngineChoice::cpu;
    std::uint32_t multiprocessors = 0;  // of the GPU; 0: all
    int exit_code = 0;                  // other than 0: the engine asked for may not run here
};

void report_axes(CheckReport& report);
/// Where the axes stand in the frames on the bus.
void report_frames(CheckReport& report);
void report_bodies(CheckReport& report);
void report_tools(CheckReport& report);
void report_pairs(CheckReport& report);
/// How far the axes can get before they stand, as stoppable mode reckons.
void report_guard(CheckReport& report);
/// Memory, capacities, and which pairs touch at positions spread over the travel.
void report_engine(CheckReport& report);
/// Lines of the machine file that are still guesses of `axguard init`; warnings only.
void report_guesses(CheckReport& report, const std::string& file);

}  // namespace axg
