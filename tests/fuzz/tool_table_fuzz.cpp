// SPDX-License-Identifier: Apache-2.0
// Any text as a tool table of LinuxCNC: each number once, finite lengths, and faults that do not
// steer a terminal.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <set>

#include "config/init/tool_table.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::tool_table(const std::uint8_t* data, std::size_t size) {
    const axg::ToolTable table =
        axg::read_tool_table({reinterpret_cast<const char*>(data), size}, "fuzz.tbl", 25.4);
    for (const std::string& fault : table.faults) {
        for (const char c : fault) {
            if (static_cast<unsigned char>(c) < 0x20) {
                std::abort();
            }
        }
    }
    std::set<std::uint32_t> numbers;
    for (const axg::TableTool& tool : table.tools) {
        if (!std::isfinite(tool.length_mm + tool.diameter_mm.value_or(0)) ||
            !numbers.insert(tool.number).second) {
            std::abort();
        }
    }
    return 0;
}
