// SPDX-License-Identifier: Apache-2.0
// Parameters, expressions and O-words: what each wrong one says, and where a program ends that runs
// in circles. What the right ones do, LinuxCNC's interpreter judges (oracle/rs274_test.py).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

void expect_fault(std::string_view text, const char* what, GcodeOptions options = {}) {
    const std::string fault = fault_of(text, std::move(options));
    EXPECT_NE(fault.find(what), std::string::npos) << fault;
}

TEST(GcodeValues, AreNumbersParametersAndExpressions) {
    const AxisPositions end = end_of("#1=2 #<deep pit>=-3\nG0 X[#1 ** 3 + 1] Y-#1 Z#<DeepPit>\n");
    EXPECT_EQ(end[kX], 9);
    EXPECT_EQ(end[kY], -2);
    EXPECT_EQ(end[kZ], -3);
    EXPECT_EQ(end_of("#1=5\n#1=6 G0 X#1\n")[kX], 5) << "set after the whole line was read";
    EXPECT_EQ(end_of("G0 X7\nG91 X[#5420 + #<_x>]\n")[kX], 21) << "where the axis is";
    EXPECT_EQ(end_of("G20 G0 X1\nX[#5420 + 1]\n")[kX], 50.8) << "in the program's unit";
}

TEST(GcodeValues, WrongOnesSayWhat) {
    expect_fault("G0 X[1+2\n", "X[: the expression is not closed");
    expect_fault("G0 X[1 FOO 2]\n",
                 "X[: the expression is not closed; add ']', or correct a misspelt operator");
    expect_fault("G0 X[1/0]\n", "X[: the expression has no value");
    expect_fault("G0 X[0-1]\nX SQRT[-1]\n", "2: X: SQRT: undefined for this argument");
    expect_fault("G0 X ATAN[1]\n", "ATAN: expected ATAN[y]/[x]");
    expect_fault("G0 X#0\n", "expected a parameter from 1 to 5601");
    expect_fault("G0 X#1.5\n", "expected a parameter from 1 to 5601");
    expect_fault("G0 X#5602\n", "expected a parameter from 1 to 5601");
    expect_fault("G0 X#5161\n", "#5161: not available");
    expect_fault("#5420=1\n", "#5420: only the control writes this parameter");
    expect_fault("G0 X#<_vmajor>\n", "names that LinuxCNC sets are not available");
    expect_fault("#1\n", "#: expected '=' and a value");
    expect_fault("#<a\n", "expected a name and '>'");
    expect_fault("G0 X" + std::string(60, '[') + "1" + std::string(60, ']') + "\n",
                 "more than 50 nested brackets");
}

TEST(GcodeFlow, Fanuc98CallsTheLinesUpTo99) {
    EXPECT_EQ(end_of("#1=1\nG91\nM98 P0007 L3\nG90 Y#1\nM2\nO7\nG0 X2\n#1=[#1 + 1]\nM99\n")[kX], 6);
    EXPECT_EQ(end_of("#1=1\nM98 P7 L2\nG0 X#1\nM2\nO0007\n#1=[#1 + 1]\nM99\n")[kX], 3)
        << "#1 is the caller's";
    EXPECT_EQ(end_of("G0 X1\nM98 P7 L0\nM2\nO7\nG0 X2\nM99\n")[kX], 1);
    EXPECT_EQ(end_of("M98 P7\nG0 Y1\nM2\nO7\nM98 P8\nM99\nO8\nG0 X2\nM99\n")[kY], 1);
    EXPECT_EQ(end_of("M98 P7\nG0 Y1\nM2\nO7\no1 while [1]\nM99\no1 endwhile\n")[kY], 1);
    expect_fault("#<a>=1\nM98 P7\nM2\nO7\nG0 X#<a>\nM99\n", "5: X#: #<A>: no line has set it");
    expect_fault("M98\n", "M98: expected P");
    expect_fault("M98 P1.5\n", "M98: expected P");
    expect_fault("M98 P7 X1\n", "M98: expected only P and L");
    expect_fault("M98 P7\n", "M98: there is no line O7 in this file");
    expect_fault("M98 P7\no7 sub\no7 endsub\n", "M98: there is no line O7 in this file");
    expect_fault("M99\n", "M99: repeats the program endlessly; write M2");
    expect_fault("M99 P1\n", "M99: no other word may be in its line");
    expect_fault("o7 sub\nM99\no7 endsub\no7 call\n", "M99: ends no O sub; write endsub");
    expect_fault("M98 P7\nM2\nO7\no7 endsub\n", "no call of O7");
    expect_fault("M98 P7\nM2\nO7\nG0 X1\n", "the file ends inside a subroutine");
    expect_fault("G0 X1 M99\n", "M99: has to begin its line");
    expect_fault("o1 sub\no2 sub\no2 endsub\no1 endsub\n", "a subroutine begins inside O1");
}

TEST(GcodeFlow, SubroutinesAreReadFromTheirFolders) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / "axguard-gcode-subs";
    std::filesystem::create_directories(folder / "second");
    const auto write = [&folder](const char* name, const char* text) {
        std::ofstream(folder / name) << text;
    };
    write("side.ngc",
          "%\no<side> sub\no10 if [#1 gt 3]\nG0 X#1\no10 endif\no<deep> call\n"
          "o<side> endsub [7]\n%\n");
    write("second/deep.ngc", "o<deep> sub\nG0 Z-2\no<deep> endsub\nG0 Z-99\n");
    write("bad.ngc", "o<bad> sub\n\nG77\no<bad> endsub\n");
    write("open.ngc", "o<open> sub\nG0 X1\n");
    GcodeOptions options;
    options.sub_folders = {folder.string(), (folder / "second").string()};
    const AxisPositions end =
        end_of("o10 if [1]\nO<Side> call [4]\no10 endif\nG0 Y#<_value>\n", options);
    EXPECT_EQ(end[kX], 4);
    EXPECT_EQ(end[kY], 7);
    EXPECT_EQ(end[kZ], -2);
    const GcodeResult result = read("G0 Y1\no<side> call [4]\nM2\n", options);
    EXPECT_EQ(result.program.moves.back().line, 2U) << "the line that calls";
    EXPECT_EQ(result.line_count, 3U);
    EXPECT_EQ(result.read_as[0], "subroutine " + folder.string() + "/side.ngc");
    expect_fault("M3\no<bad> call\n", "2: G77: bad.ngc:3: not supported", options);
    expect_fault("o<open> call\n", "the file ends inside a subroutine", options);
    expect_fault("o<none> call\n", "pass the folder that has a file of this name with --sub",
                 options);
    expect_fault("o<second/deep> call\n", "there is no O<SECOND/DEEP> sub in this file", options);
    std::filesystem::remove_all(folder);
}

TEST(GcodeValues, NamesOfTheControlAreItsOwn) {
    EXPECT_EQ(end_of("G0 X[1 + #<_value> + #<_value_returned>]\n")[kX], 1);
    EXPECT_EQ(end_of("o1 sub\no1 endsub [3]\no2 sub\nG0 X[1 + #<_value>]\no2 endsub\n"
                     "o1 call\no2 call\n")[kX],
              1)
        << "a call begins with none";
    EXPECT_EQ(end_of("G0 X[exists[#1] + exists[#5601] + exists[#<_value>]]\n")[kX], 3);
    expect_fault("G0 X[exists[#5602]]\n", "expected a parameter from 1 to 5601");
    expect_fault("G0 X[exists[#1 + 1]]\n", "expected EXISTS[#number]");
    expect_fault("#<_line>=1\n", "#<_LINE>: only the control writes this parameter");
    expect_fault("#<_ini[a]b>=1\n", "#<_INI[A]B>: only the control writes this parameter");
    EXPECT_EQ(end_of("#5599=0\nG0 X1\n")[kX], 1);
}

TEST(GcodeFlow, WrongOnesSayWhatAndEndTheReading) {
    expect_fault("o1 call\nG0 X1\n", "there is no O1 sub in this file");
    expect_fault("o1 sub\nG0 X1\n", "there is no O1 endsub");
    expect_fault("o1 endsub\n", "no call of O1 is under way");
    expect_fault("o1 if [0]\nG0 X1\n", "there is no O1 endif");
    expect_fault("o1 if\no1 endif\n", "expected one [condition]");
    expect_fault("o1 if 1\no1 endif\n", "expected [ and an expression");
    expect_fault("o1 while [1]\n", "there is no O1 endwhile");
    expect_fault("o1 endwhile\n", "no loop O1 is under way");
    expect_fault("o1 repeat [2]\n", "there is no O1 endrepeat");
    expect_fault("o1 break\n", "no loop O1 is under way");
    expect_fault("o1 spin\n", "expected sub, call, return");
    expect_fault("o1 return\n", "no call of O1 is under way");
    EXPECT_EQ(end_of("o1 sub\no2 if [1]\no2 return [3]\no2 endif\no1 endsub\no1 call\n"
                     "G0 X#<_value>\n")[kX],
              3)
        << "LinuxCNC takes any name";
    EXPECT_EQ(end_of("o7 sub\nG0 X#1\no7 endsub\n#2 = 3\no[#2 + 4] call [5]\n")[kX], 5);
    expect_fault("o[1.5] call\n", "expected the number of a subroutine");
    expect_fault("o[8] call\n", "there is no O8 sub");
    expect_fault("o[1] sub\n", "expected a number or <name> after O");
    expect_fault("o<a call\n", "expected a name and '>'");
    expect_fault("G0 X1 o1 call\n", "O: an O-word is only allowed at the start of a line");
    expect_fault("o1 sub\no1 call\no1 endsub\no1 call\n", "more than 100 nested calls and loops");
}

// As posts for Fanuc and Haas write it; tests/oracle/rs274_test.py compares with LinuxCNC.
TEST(GcodeFlow, AProgramNumberDoesNothing) {
    EXPECT_EQ(end_of("%\nO0042 (BRACKET)\nG21 G90\nG0 X8\nM30\n%\n")[kX], 8);
    EXPECT_EQ(end_of("N1 o<bracket>\nG0 X8\no7\nX9\n")[kX], 9);
    EXPECT_EQ(end_of("o1 if [1]\nO7\nG0 X1\no1 endif\n")[kX], 1);
    expect_fault("o1 sub\nO7\no1 endsub\no1 call\n",
                 "O: a program number inside a subroutine; delete the line");
    expect_fault("O7 G0 X1\n", "expected sub, call, return");
}

TEST(GcodeFlow, FaultsAfterAWrongOWordAreListedToo) {
    EXPECT_EQ(
        faults_of(read("%\no5 spin\nG0 X1\nG68.2 X0 Y0\n#<a> = #<b>\no6 wobble\nG69 M2\nG87\n")),
        "2: O: expected sub, call, return, if, while, do, repeat, break, continue, or the end "
        "of one, or nothing after the number of a program\n"
        "4: G68.2: not supported (not a word of this dialect)\n"
        "6: O: expected sub, call, return, if, while, do, repeat, break, continue, or the end "
        "of one, or nothing after the number of a program\n"
        "7: G69: not supported (not a word of this dialect)\n");
    EXPECT_EQ(read("O12\nG68.2\nG53.1\nG0 X1\nG69\nM30\n").faults.size(), 3U);
    GcodeOptions options;
    options.faults_max = 2;
    EXPECT_TRUE(read("o5 spin\nG87\nG87\n", options).has_more_faults);
    EXPECT_EQ(read("o1 repeat [9]\nG87 X1\no1 endrepeat\nG88\n").faults.size(), 2U)
        << "a line of a loop is named once";
}

TEST(GcodeFlow, ALoopWithoutAnEndIsFoundByItsLines) {
    GcodeOptions options;
    options.steps_max = 1000;
    expect_fault("o1 while [1]\nM3\no1 endwhile\n",
                 "program: more than 1000 lines were run; check for an endless loop, or raise the "
                 "limit with --max-lines N",
                 options);
}

TEST(GcodeFlow, ASubroutineOfTwoPlacesIsRefused) {
    expect_fault("o1 sub\no1 endsub\nG0 X1\no01 sub\no1 endsub\n",
                 "1: O: O1 sub comes again in line 4");
}

TEST(GcodeFlow, WhatABranchLeavesOutIsNotJudged) {
    EXPECT_EQ(end_of("o1 if [0]\nG0 X1 G87 X2\no1 endif\nG0 X3\n")[kX], 3);
    EXPECT_EQ(end_of("N10 o01 if [1]\nG0 X1\nN20 o1 endif\n")[kX], 1) << "O01 is O1";
}

}  // namespace
}  // namespace axg::test
