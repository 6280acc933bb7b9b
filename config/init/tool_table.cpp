// SPDX-License-Identifier: Apache-2.0
#include "config/init/tool_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr double kSameMm = 0.001;  // a table states three or four decimals
constexpr double kInchMm = 25.4;
constexpr double kLikeInch = 0.02;  // of a length: tools are measured again, and ground
constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kOffsets = "XYABCUVW";

/// The number behind the letter of a word; empty if it is none.
std::optional<double> value_of(std::string_view word) {
    word.remove_prefix(1);
    if (word.starts_with('+')) {
        word.remove_prefix(1);
    }
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = error == std::errc{} && rest == word.data() + word.size();
    return is_whole && std::fabs(value) < 1e6 ? std::optional(value) : std::nullopt;
}

/// The words of one line; false after a fault.
bool read_line(std::string_view line, double unit_mm, TableTool& out, std::string& fault) {
    bool has_number = false;
    for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;
         at = line.find_first_not_of(kBlank, at)) {
        const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
        const std::string_view word = line.substr(at, end - at);
        at = end;
        const char letter =
            word[0] >= 'a' && word[0] <= 'z' ? static_cast<char>(word[0] - 'a' + 'A') : word[0];
        const bool is_known =
            std::string_view("TPDZXYABCUVWIJQ").find(letter) != std::string_view::npos;
        const std::optional<double> value = is_known ? value_of(word) : std::nullopt;
        if (!value) {
            fault = fault_text("invalid word", quoted(word, 64),
                               "T, P, D, Z or another letter of the table with a number");
            return false;
        }
        if (letter == 'T') {
            has_number = *value >= 0 && *value < 1e6 && *value == std::floor(*value);
            out.number = has_number ? static_cast<std::uint32_t>(*value) : 0;
        } else if (letter == 'D') {
            out.diameter_mm = unit_mm * *value;  // below 0 G41 runs on the other side
        } else if (letter == 'Z') {
            out.length_mm = unit_mm * *value;
        } else if (kOffsets.find(letter) != std::string_view::npos) {
            out.has_other_offset |= *value != 0;
        }
    }
    if (!has_number) {
        fault = fault_text("missing tool number", "", "T and a whole number");
    }
    return has_number;
}

/// The largest radius of the cutting sections, if all are round about the axis.
std::optional<double> cutting_radius(const Tool& tool) {
    std::optional<double> radius;
    for (const Shape& shape : tool.mesh.shapes) {
        if (!shape.is_cutting) {
            continue;
        }
        if (shape.profile.empty() || shape.at.t[0] != 0 || shape.at.t[1] != 0 ||
            shape.at.r[2][2] != 1) {
            return std::nullopt;
        }
        for (const Vec3d& point : shape.profile) {
            radius = std::max(radius.value_or(0), point.x);
        }
    }
    return radius;
}

/// "118.5 mm", "4.5 inch (114.3 mm)".
std::string table_length(double length_mm, double unit_mm) {
    return unit_mm == kInchMm
               ? fmt::format("{:.6g} inch ({:.6g} mm)", length_mm / unit_mm, length_mm)
               : fmt::format("{:.6g} mm", length_mm);
}

void compare(const TableTool& row, const Tool& tool, double unit_mm,
             std::vector<std::string>& out) {
    const std::string where = fmt::format("{}: tool {}: ", row.source, row.number);
    const std::string& other = tool.mesh.where;
    if (std::fabs(row.length_mm - tool.length_mm) > kSameMm) {
        const bool is_like_inch =
            unit_mm == 1 &&
            std::fabs(row.length_mm * kInchMm - tool.length_mm) < kLikeInch * tool.length_mm;
        out.push_back(fmt::format("{}length {}, and {:.6g} mm in {}. Correct one of them.{}", where,
                                  table_length(row.length_mm, unit_mm), tool.length_mm, other,
                                  is_like_inch ? " Is the table in inch? Then state program: "
                                                 "{start_unit: inch}."
                                               : ""));
    }
    const std::optional<double> radius = cutting_radius(tool);
    if (radius && row.diameter_mm &&
        std::fabs(std::fabs(*row.diameter_mm) - 2 * *radius) > kSameMm) {
        out.push_back(fmt::format("{}diameter {}, and {:.6g} mm in {}. Correct one of them.", where,
                                  table_length(*row.diameter_mm, unit_mm), 2 * *radius, other));
    }
    if (row.has_other_offset) {
        out.push_back(where +
                      "an offset along another axis than Z, which length_mm does not have. "
                      "Turn the tool's surface by at_mm.");
    }
}

}  // namespace

ToolTable read_tool_table(std::string_view text, const std::string& name, double unit_mm) {
    ToolTable table;
    table.unit_mm = unit_mm;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        TableTool tool;
        tool.source = fmt::format("{}:{}", name, number);
        if (const std::size_t mark = line.find(';'); mark != std::string_view::npos) {
            std::string_view comment = line.substr(mark + 1);
            comment.remove_prefix(std::min(comment.find_first_not_of(kBlank), comment.size()));
            tool.comment = comment.substr(0, comment.find_last_not_of(kBlank) + 1);
            line = line.substr(0, mark);
        }
        if (line.find_first_not_of(kBlank) == std::string_view::npos) {
            continue;
        }
        std::string fault;
        if (!read_line(line, unit_mm, tool, fault)) {
            table.faults.push_back(tool.source + ": " + fault);
            continue;
        }
        const auto same =
            std::find_if(table.tools.begin(), table.tools.end(),
                         [&tool](const TableTool& one) { return one.number == tool.number; });
        if (same != table.tools.end()) {
            table.faults.push_back(
                tool.source + ": " +
                fault_text("invalid tool number",
                           fmt::format("{}, the number of {}", tool.number, same->source),
                           "a number that no other tool has"));
        } else if (tool.number != 0) {  // T0 is an empty spindle
            table.tools.push_back(std::move(tool));
        }
    }
    return table;
}

std::vector<std::string> tool_differences(const ToolTable& table, const std::string& name,
                                          const Machine& machine) {
    std::vector<std::string> out = table.faults;
    for (const TableTool& row : table.tools) {
        const auto tool =
            std::find_if(machine.tools.begin(), machine.tools.end(),
                         [&row](const Tool& one) { return one.number == row.number; });
        if (tool == machine.tools.end()) {
            out.push_back(
                fmt::format("{}: tool {} is not in the machine file: it never yields a "
                            "permit. Add it to tools.",
                            row.source, row.number));
        } else {
            compare(row, *tool, table.unit_mm, out);
        }
    }
    for (const Tool& tool : machine.tools) {
        if (std::none_of(table.tools.begin(), table.tools.end(),
                         [&tool](const TableTool& row) { return row.number == tool.number; })) {
            out.push_back(fmt::format("{}: tool {} is not in {}. Correct one of them.",
                                      tool.mesh.where, tool.number, name));
        }
    }
    return out;
}

}  // namespace axg
