// SPDX-License-Identifier: Apache-2.0
// Every word of LinuxCNC is read, accepted or refused with a reason, and docs/reference/gcode.md
// says which: its table is made from the rules, and held to them here. Programs of other controls
// say so.
#include "hil_replay/gcode/gcode_words.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "hil_replay/gcode/gcode_dialect.hpp"
#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

/// LinuxCNC 2.9, "G-code Quick Reference", "M-codes"; ten times the number.
constexpr std::int32_t kLinuxcncG[] = {
    0,   10,  20,  30,  40,  50,  51,  52,  53,  70,  80,  100, 170, 171, 180, 181, 190, 191,
    200, 210, 280, 281, 300, 301, 330, 331, 382, 383, 384, 385, 400, 410, 411, 420, 421, 430,
    431, 432, 490, 520, 530, 540, 550, 560, 570, 580, 590, 591, 592, 593, 610, 611, 640, 700,
    710, 711, 712, 720, 721, 722, 730, 740, 760, 800, 810, 820, 830, 840, 850, 860, 870, 880,
    890, 900, 901, 910, 911, 920, 921, 922, 923, 930, 940, 950, 960, 970, 980, 990,
};
constexpr std::int32_t kLinuxcncM[] = {
    0,   10,  20,  30,  40,  50,  60,  70,  80,  90,  190, 300, 480, 490, 500, 510, 520,
    530, 600, 610, 620, 630, 640, 650, 660, 670, 680, 700, 710, 720, 730, 980, 990,
};

std::string name_of(char letter, std::int32_t code) {
    std::string name(1, letter);
    name += std::to_string(code / 10);
    return code % 10 == 0 ? name : name.append(".").append(std::to_string(code % 10));
}

std::string table() {
    std::ostringstream out;
    for (const GcodeWordRule& rule : gcode_word_rules()) {
        const char* const kinds[] = {"read", "accepted", "refused"};
        out << "| " << name_of(rule.letter, rule.code) << " | "
            << kinds[static_cast<std::size_t>(rule.support)] << " | " << rule.reason << " |\n";
    }
    return out.str();
}

TEST(GcodeWords, NoWordOfLinuxcncIsForgotten) {
    for (const std::int32_t code : kLinuxcncG) {
        EXPECT_NE(find_gcode_word('G', code), nullptr) << name_of('G', code);
    }
    for (const std::int32_t code : kLinuxcncM) {
        EXPECT_NE(find_gcode_word('M', code), nullptr) << name_of('M', code);
    }
    EXPECT_EQ(fault_of("M101 P1\n"),
              "1: M101: not supported (a program of the control's own; --ignore M101 leaves it "
              "out)\n");
}

TEST(GcodeWords, ThePageHoldsTheTableOfTheRules) {
    std::ifstream file(std::string(AXG_SOURCE_DIR) + "/docs/reference/gcode.md");
    const std::string page(std::istreambuf_iterator<char>(file), {});
    EXPECT_NE(page.find("|---|---|---|\n" + table()), std::string::npos)
        << "docs/reference/gcode.md, \"Every word\", wanted:\n"
        << table();
}

TEST(GcodeWords, WhatMovesNothingMayHaveItsLetters) {
    EXPECT_TRUE(
        program_of("M50 P0\nM51 P1\nM53 P0\nM62 P3\nM63 P3\nM64 P0\nM65 P0\n").moves.empty());
    EXPECT_EQ(program_of("G1 F9 M64 P1 X1\n").moves.size(), 1U);
    EXPECT_NE(fault_of("G1 F9 M8 P1 X1\n").find("P: no word of this block takes it"),
              std::string::npos);
    EXPECT_NE(fault_of("M62 M63 P1\n").find("M63: conflicts with M62"), std::string::npos);
}

TEST(GcodeWords, ProgramsOfOtherControlsSayWhichOnce) {
    for (const char* const text :
         {"N10 TRAORI\nN20 G1 X1 F9\n", "G54\nN5 CYCLE832(0.01,1,1)\nTRAFOOF\n",
          "G0 SUPA Z0 D0\nG0 SUPA X0\n", "G0 X0 C=DC(90)\nA=DC(1)\n", "DEF REAL _A\nGOTOF END\n"}) {
        EXPECT_NE(fault_of(text).find("program: written for a Siemens control; only LinuxCNC's"),
                  std::string::npos)
            << text;
    }
    for (const char* const text :
         {"0 BEGIN PGM PART MM\n1 BLK FORM 0.1 Z X-1 Y-1 Z-1\n", "12 L X+10 Y-3 R0 FMAX M3\n",
          "G0 X0\nL Z+50 R0 F900\nTOOL CALL 3 Z S900\n", "7 CYCL DEF 200\n", "PLANE SPATIAL\n"}) {
        EXPECT_NE(fault_of(text).find("program: written for a Heidenhain control; only"),
                  std::string::npos)
            << text;
    }
    // RS-274 with a mistake, and with those words in a comment.
    EXPECT_NE(fault_of("G0 X1 Y (TRAORI, CYCLE)\n").find("Y: expected a number"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 X! ; L X+1 TRAORI\n").find("X"), std::string::npos);
    EXPECT_EQ(foreign_control("N10 G0 X10 (L )"), "");
    EXPECT_EQ(foreign_control(""), "");
}

}  // namespace
}  // namespace axg::test
