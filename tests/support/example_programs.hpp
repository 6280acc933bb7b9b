// SPDX-License-Identifier: Apache-2.0
// The example programs that do no harm: five, on three types of machine. Those that are called near
// come within half a millimetre of a margin.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>

#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"

namespace axg::test {

struct Example {
    const char *machine, *program;
};
inline constexpr std::array<Example, 5> kExamples{
    {{"paper-trunnion", "paper-trunnion-clean"},
     {"paper-trunnion", "paper-trunnion-near"},
     {"spindle-tilting", "spindle-tilting"},
     {"table-spindle-tilting", "table-spindle-tilting"},
     {"table-spindle-tilting", "table-spindle-tilting-near"}}};

inline bool load_example(const std::string& machine, LoadedMachine& loaded) {
    return load(std::string(AXG_SOURCE_DIR) + "/config/machines/" + machine + ".yaml", "", loaded,
                stderr);
}

/// The program's lines, `times` in a row, with one end.
inline Program read_example(const std::string& name, const Machine& machine,
                            std::uint64_t times = 1) {
    std::ifstream file(std::string(AXG_SOURCE_DIR) + "/hil_replay/programs/" + name + ".ngc");
    std::string body, line, all;
    while (std::getline(file, line)) {
        if (line != "%" && line != "M30") {
            body += line + "\n";
        }
    }
    for (std::uint64_t i = 0; i < times; ++i) {
        all += body;
    }
    GcodeOptions options;
    options.start = default_start(machine);
    GcodeResult reading = read_gcode(all + "M30\n", machine, options);
    for (const ProgramFault& fault : reading.faults) {
        ADD_FAILURE() << fault.line << ": " << fault.message;
    }
    return std::move(reading.program);
}

/// As a name of a test.
inline std::string name_of(const Example& example) {
    std::string name = example.program;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

}  // namespace axg::test
