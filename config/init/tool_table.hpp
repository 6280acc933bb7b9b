// SPDX-License-Identifier: Apache-2.0
// The tool table of LinuxCNC, and how it differs from the tools of a machine file.
// Source: LinuxCNC 2.9, "Tool Table Format", and tooldata_common.cc, tooldata_read_entry: a line
// has a word of a letter and a number for each value, in any order, then perhaps a semicolon and a
// comment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::size_t kToolTableBytesMax = 1U << 20U;

struct TableTool {
    std::uint32_t number = 0;
    double length_mm = 0;               // Z: what G43 adds
    std::optional<double> diameter_mm;  // D
    bool has_other_offset = false;      // along X, Y or another axis, which length_mm does not have
    std::string comment;
    std::string source;  // "tool.tbl:3"
};

/// Whether the tool was measured: a length of 0 is one that the table does not state.
[[nodiscard]] inline bool is_measured(const TableTool& tool) noexcept {
    return tool.length_mm >= 0.001;
}

struct ToolTable {
    double unit_mm = 1;               // in which the file was read
    std::vector<TableTool> tools;     // each number once
    std::vector<std::string> faults;  // with file and line; these lines are left out
};

/// @param name     of the file, for messages
/// @param unit_mm  of the control ([TRAJ] LINEAR_UNITS)
[[nodiscard]] ToolTable read_tool_table(std::string_view text, const std::string& name,
                                        double unit_mm);

/// One line for each difference: a tool in one of them only, another length, another diameter. A
/// diameter is compared with the cutting sections of a tool; other surfaces do not state theirs.
/// A length that was read in another unit than mm is stated in both.
/// @param name  of the table
[[nodiscard]] std::vector<std::string> tool_differences(const ToolTable& table,
                                                        const std::string& name,
                                                        const Machine& machine);

}  // namespace axg
