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
    0,   10,  20,  30,  40,  50,  51,  52,  53,  62,  70,  80,  100, 170, 171, 180, 181, 190,
    191, 200, 210, 280, 281, 300, 301, 330, 331, 382, 383, 384, 385, 400, 410, 411, 420, 421,
    430, 431, 432, 490, 520, 530, 540, 550, 560, 570, 580, 590, 591, 592, 593, 610, 611, 640,
    700, 710, 711, 712, 720, 721, 722, 730, 740, 760, 800, 810, 820, 830, 840, 850, 860, 870,
    880, 890, 900, 901, 910, 911, 920, 921, 922, 923, 930, 940, 950, 960, 970, 980, 990,
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

TEST(GcodeWords, SettingsOfSpindleAndOutputsTakeTheirOwnLetters) {
    EXPECT_TRUE(program_of("M19 R90 P1 Q2\nM67 E0 Q5\nM68 E1 Q0\nG96 D2500 S90\n").moves.empty());
    EXPECT_NE(fault_of("M3 R90\n").find("R"), std::string::npos);
    EXPECT_NE(fault_of("M62 P1 E1\n").find("E: no word of this block takes it (M66"),
              std::string::npos);
    EXPECT_EQ(fault_of("M67 Q5\n"), "1: M67: expected E, the number of the output\n");
    EXPECT_EQ(program_of("M66 P0 L3 Q2\nM66 E1 L0\n").moves.size(), 2U) << "the axes stand";
    EXPECT_EQ(fault_of("M66 L3 Q2\n"),
              "1: M66: expected P, a digital input, or E, an analog one\n");
    EXPECT_NE(fault_of("G96 S90 G95 F1 G1 X1\n").find("G95: under G96 the speed"),
              std::string::npos);
    EXPECT_EQ(program_of("G96 S90\nG97 S5 G95 F2 G1 X1\n").moves[0].feed, 10);
    EXPECT_EQ(fault_of("G6.2 X1\n"), "1: G6.2: not supported (NURBS; post it as lines or arcs)\n");
}

TEST(GcodeWords, CancellingAMotionYieldsToOneOfTheSameBlock) {
    EXPECT_EQ(program_of("G80 G0 X1\nG0 G80 X2\n").moves.size(), 2U);
    EXPECT_NE(fault_of("G80 G0 G1 X1\n").find("G1: conflicts with G0"), std::string::npos);
}

TEST(GcodeModes, AreSavedAndRestored) {
    EXPECT_EQ(end_of("G91\nM70\nG90 G20\nM72\nG0 X1\nX1\n")[kX], 2) << "G91 and mm again";
    EXPECT_EQ(end_of("G0 X1 F9\nM70\nG1 X2\nM72\nX3\n")[kX], 3);
    EXPECT_EQ(program_of("F9 G1 X1\nM70\nF20 X2\nM72\nX3\n").moves.back().feed, 9);
    EXPECT_EQ(end_of("G10 L2 P2 X5\nM70\nG55\nM72\nG0 X1\n")[kX], 1) << "the work offset";
    const char* const sub = "o1 sub\nM73\nG91\no1 if [#1]\nM71\no1 endif\no1 endsub\n";
    EXPECT_EQ(end_of(std::string(sub) + "G0 X4\no1 call [0]\nX1\n")[kX], 1) << "on return";
    EXPECT_EQ(end_of(std::string(sub) + "G0 X4\no1 call [1]\nX1\n")[kX], 5) << "M71 forgets";
    EXPECT_EQ(fault_of("M72\n"),
              "1: M72: no modes are saved here; write M70 before it, in the same subroutine\n");
    EXPECT_NE(fault_of("M70\no1 sub\nM72\no1 endsub\no1 call\n").find("3: M72: no modes"),
              std::string::npos);
    EXPECT_NE(fault_of("M70\nG52 X1\nM72\n").find("M72: the tool offset, G52 or G92 changed"),
              std::string::npos);
}

TEST(GcodeThreads, KeepPaceWithTheSpindle) {
    const Program program = program_of("S100 G0 X3\nG33 Z-10 K1.5\nM8\nZ-20 K2\n");
    ASSERT_EQ(program.moves.size(), 3U);
    EXPECT_EQ(program.moves[1].feed, 150);
    EXPECT_EQ(program.moves[2].feed, 200);
    EXPECT_EQ(program.moves[2].target[kZ], -20);
    EXPECT_EQ(program_of("G20 S100\nG33 Z-1 K0.1\n").moves[0].feed, 254);
    EXPECT_NE(fault_of("S9 G33 Z-1\n").find("G33: expected K"), std::string::npos);
    EXPECT_NE(fault_of("G33 Z-1 K1\n").find("G33: the spindle is off"), std::string::npos);
    EXPECT_NE(fault_of("S9 G33 K1\n").find("G33: expected axis words"), std::string::npos);
    EXPECT_NE(fault_of("S9 G93 G33 Z-1 K1 F1\n").find("G33: conflicts with G93"),
              std::string::npos);
    EXPECT_NE(fault_of("S9 G33 Z-1 K1 I2\n").find("I: no word of this block takes it"),
              std::string::npos);
}

TEST(GcodeThreads, RigidTappingReturnsToItsStart) {
    const GcodeResult result = read("S100 G0 X3\nG33.1 Z-10 K1 I2\nG0 X4\nM2\n");
    ASSERT_EQ(result.program.moves.size(), 4U) << faults_of(result);
    EXPECT_EQ(result.program.moves[1].target[kZ], -10);
    EXPECT_TRUE(result.program.moves[1].is_exact);
    EXPECT_EQ(result.program.moves[2].target[kZ], 0);
    EXPECT_EQ(result.program.moves[2].feed, 100);
    EXPECT_EQ(result.program.moves[3].target[kX], 4);
    EXPECT_EQ(read_as_text(result.read_as), "read as: starts in mm; G33.1 turns round at its end");
}

TEST(GcodeProbe, IsReadToItsEndAndSaysSo) {
    const GcodeResult result = read("G21\nF100\nG38.2 Z-10\nG38.3 X5\nM2\n");
    ASSERT_EQ(result.program.moves.size(), 2U) << faults_of(result);
    EXPECT_EQ(result.program.moves[0].target[kZ], -10);
    EXPECT_EQ(result.program.moves[1].target[kX], 5);
    EXPECT_EQ(read_as_text(result.read_as),
              "read as: G38.2 touches nothing; G38.3 touches nothing");
    for (const char* const text : {"G91 G0 Z1\n", "G92 Z0\n", "G10 L20 P1 Z0\n"}) {
        EXPECT_NE(fault_of(std::string("F9 G38.2 Z-1\nG91 G0 X1\n") + text)
                      .find("Z: counts from where a probe stopped"),
                  std::string::npos)
            << text;
    }
    EXPECT_NE(fault_of("F9 G38.2 Z-1\nG0 X#5422\n").find("#5422: not available"),
              std::string::npos);
    EXPECT_EQ(end_of("F9 G38.2 Z-1\nG0 Z3\nG91 Z1\nG92 Z0\n")[kZ], 4);
    EXPECT_NE(fault_of("F9 G38.2\n").find("G38: expected axis words"), std::string::npos);
    EXPECT_NE(fault_of("F9 G38.2 Z-1 A5\n").find("G38.2: A: no rotary axis"), std::string::npos);
    EXPECT_NE(fault_of("F9 G38.2 Z-0.253\n").find("nearer than 0.254 mm"), std::string::npos);
    EXPECT_EQ(program_of("F9 G38.2 Z-0.255\n").moves.size(), 1U);
    EXPECT_NE(fault_of("G93 F9 G38.2 Z-1\n").find("conflicts with G93"), std::string::npos);
    EXPECT_NE(fault_of("F9 G38.2 Z-1\nG0 Z#5063\n").find("#5063: not available"),
              std::string::npos);
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

// As LinuxCNC 2.9 refuses them.
TEST(GcodeWords, AHalfCentreAndANegativeNumberOfALineAreFaults) {
    EXPECT_NE(fault_of("G90.1 G0 X10\nG3 X0 Y10 I0 F9\n").find("G3: G90.1 is on: expected both"),
              std::string::npos);
    EXPECT_NE(fault_of("N-1 G0 X1\n").find("N-1: a line number cannot be negative"),
              std::string::npos);
}

}  // namespace
}  // namespace axg::test
