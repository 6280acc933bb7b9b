// SPDX-License-Identifier: Apache-2.0
// The table of program lines: what is written is read again, an instant has the line that was begun
// last, and a table that is damaged or of another trace names no line.
#include "hil_replay/trace/program_lines.hpp"

#include <gtest/gtest.h>

#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

ProgramLines some_lines() {
    ProgramLines lines;
    lines.program = "part one.ngc";
    lines.trace_bytes = 5;
    lines.trace_crc = 0xCBF53A1C;  // of "12345"
    for (const std::int64_t k : {0, 1, 2, 3, 4, 5}) {
        add_program_step(lines, 1000 * k, k < 2 ? 0U : k < 4 ? 1U : 3U);
    }
    add_blocks(lines, "G0 Z50\n\n  G1 X1 (a b)\r\n");
    return lines;
}

TEST(ProgramLines, AStepBeginsWhereTheLineChanges) {
    const ProgramLines lines = some_lines();
    ASSERT_EQ(lines.steps.size(), 3U);
    EXPECT_EQ(step_at(lines, -1), nullptr);
    EXPECT_EQ(step_at(lines, 1999), nullptr) << "before the first move";
    ASSERT_NE(step_at(lines, 2000), nullptr);
    EXPECT_EQ(step_at(lines, 2000)->line, 1U);
    EXPECT_EQ(step_at(lines, 3999)->block, "G0 Z50");
    EXPECT_EQ(step_at(lines, 4000)->block, "G1 X1 (a b)");
    EXPECT_EQ(step_at(lines, 1'000'000)->line, 3U);
    EXPECT_EQ(step_at(ProgramLines{}, 0), nullptr);
}

TEST(ProgramLines, AreReadAsTheyWereWritten) {
    const std::string text = program_lines_text(some_lines());
    ProgramLines read;
    ASSERT_EQ(read_program_lines("t.lines", text, read), "");
    EXPECT_EQ(program_lines_text(read), text);
    EXPECT_EQ(read.program, "part one.ngc");
}

TEST(ProgramLines, ANameOfTwoLinesLeavesTheTableReadable) {
    ProgramLines lines = some_lines();
    lines.program = "part\ntwo.ngc";
    ProgramLines read;
    ASSERT_EQ(read_program_lines("t.lines", program_lines_text(lines), read), "");
    EXPECT_EQ(read.program.find('\n'), std::string::npos);
    EXPECT_EQ(read.steps.size(), lines.steps.size());
}

TEST(ProgramLines, NoLineIsReadFromADamagedTable) {
    const std::string text = program_lines_text(some_lines());
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::string damaged = text;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        ProgramLines read;
        EXPECT_NE(read_program_lines("t.lines", damaged, read), "") << "byte " << i;
        EXPECT_TRUE(read.is_empty());
        EXPECT_NE(read_program_lines("t.lines", text.substr(0, i), read), "") << "cut at " << i;
    }
}

TEST(ProgramLines, OfAnotherTraceAreNotUsed) {
    const test::Workshop shop;
    const std::string trace = shop.write("t.log", "12345");
    ProgramLines read;
    EXPECT_EQ(load_program_lines(trace, "", read), "") << "there is no table, and no complaint";
    EXPECT_TRUE(read.is_empty());
    EXPECT_NE(load_program_lines(trace, shop.file("none.lines"), read), "");
    (void)shop.write("t.log.lines", program_lines_text(some_lines()));
    EXPECT_EQ(load_program_lines(trace, "", read), "");
    EXPECT_FALSE(read.is_empty());
    for (const char* const other : {"123456", "12354"}) {  // longer, and of the same length
        (void)shop.write("t.log", other);
        EXPECT_NE(load_program_lines(trace, "", read).find("they belong to another trace, of 5"),
                  std::string::npos)
            << other;
        EXPECT_TRUE(read.is_empty());
    }
}

TEST(ProgramLines, AChangedProgramIsReportedAndItsOldBlocksAreKept) {
    const test::Workshop shop;
    const std::string trace = shop.write("t.log", "12345");
    ProgramLines lines = some_lines();
    lines.program = shop.write("part.ngc", "G0 Z60\n\nG1 X1\n");
    (void)shop.write("t.log.lines", program_lines_text(lines));
    ProgramLines read;
    EXPECT_NE(load_program_lines(trace, "", read).find("the program changed"), std::string::npos);
    ASSERT_NE(step_at(read, 2000), nullptr);
    EXPECT_EQ(step_at(read, 2000)->block, "G0 Z50");
}

// The program's name comes from the table: a device or a pipe of that name is not waited for.
TEST(ProgramLines, NothingButAFileIsRead) {
    const test::Workshop shop;
    const std::string trace = shop.write("t.log", "12345");
    ProgramLines lines = some_lines();
    lines.program = "/dev/zero";
    (void)shop.write("t.log.lines", program_lines_text(lines));
    ProgramLines read;
    EXPECT_EQ(load_program_lines(trace, "", read), "");
    EXPECT_EQ(read.steps.size(), 3U);
    EXPECT_NE(load_program_lines(trace, "/dev/zero", read).find("found a device"),
              std::string::npos);
    EXPECT_TRUE(read.is_empty());
}

}  // namespace
}  // namespace axg
