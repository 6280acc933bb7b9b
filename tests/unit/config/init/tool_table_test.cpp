// SPDX-License-Identifier: Apache-2.0
// The tool table of LinuxCNC, as its manual and its own reader have it, and each difference from
// the tools of a machine file.
#include "config/init/tool_table.hpp"

#include <gtest/gtest.h>

#include <string>

#include "config/init/write_machine.hpp"

namespace axg {
namespace {

const std::string kTable =
    "; numbers, then a comment\n"
    "T1 P1 D0.250 Z+2.5 ;1/4 end mill \r\n"
    "\n"
    "p7 z1 t4\n"
    "T5 Z0 D0.5\n"
    "T6 Z1 X0.1 Q3\n";

TEST(ToolTable, WordsAreReadInAnyOrderAndUnit) {
    const ToolTable table = read_tool_table(kTable, "tool.tbl", 25.4);
    ASSERT_EQ(table.tools.size(), 4U);
    EXPECT_TRUE(table.faults.empty());
    const TableTool& first = table.tools[0];
    EXPECT_EQ(first.number, 1U);
    EXPECT_DOUBLE_EQ(first.length_mm, 63.5);
    EXPECT_DOUBLE_EQ(first.diameter_mm.value(), 6.35);
    EXPECT_EQ(first.comment, "1/4 end mill");
    EXPECT_EQ(first.source, "tool.tbl:2");
    EXPECT_EQ(table.tools[1].number, 4U);
    EXPECT_FALSE(table.tools[1].diameter_mm);
    EXPECT_DOUBLE_EQ(read_tool_table("T2 Z4 D-6", "t.tbl", 1).tools.at(0).diameter_mm.value(), -6);
    EXPECT_FALSE(is_measured(table.tools[2]));
    EXPECT_TRUE(table.tools[3].has_other_offset);
}

TEST(ToolTable, ALineThatIsNotReadIsNamed) {
    const ToolTable table = read_tool_table("T1 Z1x\nZ5\nT2.5\nT1\nT1\nG1 T3", "tool.tbl", 1);
    ASSERT_EQ(table.faults.size(), 5U);
    EXPECT_EQ(table.faults[0],
              "tool.tbl:1: invalid word (found \"Z1x\", expected T, P, D, Z or another letter of "
              "the table with a number).");
    EXPECT_EQ(table.faults[1], "tool.tbl:2: missing tool number (expected T and a whole number).");
    EXPECT_EQ(table.faults[3],
              "tool.tbl:5: invalid tool number (found 1, the number of tool.tbl:4, expected a "
              "number that no other tool has).");
    EXPECT_EQ(table.tools.size(), 1U);
}

/// A machine with tool 1: a cutting cylinder of 6 mm, and a shank.
Machine machine_with_tool(double length_mm) {
    Machine machine;
    Tool& tool = machine.tools.emplace_back();
    tool.number = 1;
    tool.length_mm = length_mm;
    tool.mesh.where = "m.yaml:40";
    Shape& cutter = tool.mesh.shapes.emplace_back();
    cutter.profile = cone_profile(3, 3, 20);
    cutter.is_cutting = true;
    tool.mesh.shapes.emplace_back().profile = cone_profile(10, 10, 20);
    return machine;
}

TEST(ToolTable, EveryDifferenceIsOneLine) {
    const auto lines = [](const std::string& text, double length_mm) {
        std::string out;
        for (const std::string& line : tool_differences(read_tool_table(text, "t.tbl", 1), "t.tbl",
                                                        machine_with_tool(length_mm))) {
            out += line + '\n';
        }
        return out;
    };
    EXPECT_EQ(lines("T1 Z50 D6", 50), "");
    EXPECT_EQ(lines("T1 Z50 D-6", 50), "") << "as wide; G41 runs on the other side";
    EXPECT_EQ(lines("T1 Z50 D6", 50.001), "") << "the last that is the same";
    EXPECT_EQ(lines("T1 Z50 D6", 50.0011),
              "t.tbl:1: tool 1: length 50 mm, and 50.0011 mm in m.yaml:40. Correct one of them.\n");
    EXPECT_EQ(lines("T1 Z50", 50), "") << "no diameter in the table";
    EXPECT_EQ(lines("T1 Z50 D20", 50),
              "t.tbl:1: tool 1: diameter 20 mm, and 6 mm in m.yaml:40. Correct one of them.\n")
        << "the shank is as wide, and does not cut";
    EXPECT_EQ(
        lines("T1 Z50 Y1", 50),
        "t.tbl:1: tool 1: an offset along another axis than Z, which length_mm does not have. "
        "Turn the tool's surface by at_mm.\n");
    EXPECT_EQ(lines("T2 Z50", 50),
              "t.tbl:1: tool 2 is not in the machine file: it never yields a permit. Add it to "
              "tools.\nm.yaml:40: tool 1 is not in t.tbl. Correct one of them.\n");
}

// The file's own figure is what a person searches for in it.
TEST(ToolTable, ADifferenceInInchHasBothUnits) {
    const std::vector<std::string> lines = tool_differences(
        read_tool_table("T1 Z2.5 D0.25", "t.tbl", 25.4), "t.tbl", machine_with_tool(63));
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0],
              "t.tbl:1: tool 1: length 2.5 inch (63.5 mm), and 63 mm in m.yaml:40. Correct one of "
              "them.");
    EXPECT_EQ(lines[1],
              "t.tbl:1: tool 1: diameter 0.25 inch (6.35 mm), and 6 mm in m.yaml:40. Correct one "
              "of them.");
}

TEST(ToolTable, ALengthThatWouldFitInInchIsPointedOut) {
    const auto line = [](const char* text) {
        return tool_differences(read_tool_table(text, "t.tbl", 1), "t.tbl", machine_with_tool(100))
            .at(0);
    };
    const std::string said =
        " mm, and 100 mm in m.yaml:40. Correct one of them. Is the table in inch? Then state "
        "program: {start_unit: inch}.";
    EXPECT_EQ(line("T1 Z3.86"), "t.tbl:1: tool 1: length 3.86" + said) << "98.04 mm";
    EXPECT_EQ(line("T1 Z3.85"),
              "t.tbl:1: tool 1: length 3.85 mm, and 100 mm in m.yaml:40. Correct one of them.")
        << "97.79 mm";
}

// Lengths and diameters are of the table, holder and reference of a length are not.
TEST(ToolTable, InitWritesTheToolsOfTheTable) {
    std::vector<RoleGuess> roles = guess_roles({"table.stl", "head.stl"});
    add_tool_body(roles);
    add_tool_body(roles);
    ASSERT_EQ(roles.size(), 3U) << "once";
    IniAxes axes;
    axes.tools = read_tool_table(kTable, "tool.tbl", 25.4);
    const std::string text = machine_file_text("m", std::vector<SurveyedMesh>(2), roles, axes);
    EXPECT_NE(text.find("  - name: tool\n    parent: head  # GUESS: what carries it\n"
                        "    tool: true\n"),
              std::string::npos)
        << text;
    EXPECT_NE(
        text.find("tools:\n  - number: 1  # tool.tbl:2\n    name: \"1/4 end mill\"\n"
                  "    diameter_mm: 6.35\n"
                  "    length_mm: 63.5  # GUESS: if the table counts from the spindle nose\n"
                  "    profile_mm: [[0, -63.5], [3.175, -63.5], [3.175, 0], [0, 0]]  # GUESS: "
                  "add shank and holder\n"),
        std::string::npos)
        << text;
    EXPECT_NE(text.find("  # tool.tbl:5: tool 5 has no length above 0: measure it\n"),
              std::string::npos);
    EXPECT_NE(text.find("  - {a: table, b: tool, margin_mm: 0}\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace axg
