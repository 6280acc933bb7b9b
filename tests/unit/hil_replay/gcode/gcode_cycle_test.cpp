// SPDX-License-Identifier: Apache-2.0
// Canned cycles and written offsets: each move of a hole, what is kept from one to the next, and
// what every wrong one says. LinuxCNC's interpreter is the judge of the rest
// (oracle/rs274_test.py).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

constexpr const char* kStart = "G0 X0 Y0 Z20 F100\n";

struct Step {
    char kind;  // r rapid, f feed, d dwell
    double x_or_seconds, z;

    friend bool operator==(const Step&, const Step&) = default;
};

void PrintTo(const Step& step, std::ostream* out) {
    *out << step.kind << ' ' << step.x_or_seconds << ' ' << step.z;
}

/// The moves after kStart.
std::vector<Step> steps_of(const std::string& text) {
    std::vector<Step> steps;
    const Program program = program_of(kStart + text);
    for (std::size_t i = 1; i < program.moves.size(); ++i) {
        const Move& move = program.moves[i];
        if (move.kind == MoveKind::dwell) {
            steps.push_back({'d', move.dwell_s, 0});
            continue;
        }
        EXPECT_TRUE(move.is_exact || text.find("G0") != std::string::npos);
        steps.push_back(
            {move.feed_kind == FeedKind::rapid ? 'r' : 'f', move.target[kX], move.target[kZ]});
    }
    return steps;
}

TEST(GcodeCycle, EachDrillsItsHole) {
    const std::vector<Step> down{{'r', 1, 20}, {'r', 1, 3}, {'f', 1, -5}};
    const auto then = [&down](std::vector<Step> rest) {
        rest.insert(rest.begin(), down.begin(), down.end());
        return rest;
    };
    EXPECT_EQ(steps_of("G81 X1 Z-5 R3"), then({{'r', 1, 3}}));
    EXPECT_EQ(steps_of("G82 X1 Z-5 R3 P0.5"), then({{'d', 0.5, 0}, {'r', 1, 3}}));
    EXPECT_EQ(steps_of("G84 X1 Z-5 R3"), then({{'d', 0, 0}, {'f', 1, 3}}));
    EXPECT_NE(fault_of("F9 G18 G84 X1 Y-5 R3\n").find("G84: LinuxCNC"), std::string::npos);
    EXPECT_EQ(steps_of("G98 G85 X1 Z-5 R3"), then({{'f', 1, 3}, {'r', 1, 20}}));
    EXPECT_EQ(steps_of("G86 X1 Z-5 R3 P1"), then({{'d', 1, 0}, {'r', 1, 3}}));
    EXPECT_EQ(steps_of("G98 G89 X1 Z-5 R3 P1"), then({{'d', 1, 0}, {'f', 1, 20}}));
    const std::vector<Step> pecks{{'r', 1, 20},         {'r', 1, 3},  {'f', 1, -1}, {'r', 1, 3},
                                  {'r', 1, -1 + 0.254}, {'f', 1, -5}, {'r', 1, 3}};
    EXPECT_EQ(steps_of("G83 X1 Z-5 R3 Q4"), pecks);
    const std::vector<Step> breaks{{'r', 1, 20},         {'r', 1, 3},  {'f', 1, -1},
                                   {'r', 1, -1 + 0.254}, {'f', 1, -5}, {'r', 1, 3}};
    EXPECT_EQ(steps_of("G73 X1 Z-5 R3 Q4"), breaks);
}

TEST(GcodeCycle, ARowKeepsItsLetters) {
    const std::vector<Step> wanted{{'r', 1, 20}, {'r', 1, 3},  {'f', 1, -5}, {'r', 1, 3},
                                   {'r', 2, 3},  {'f', 2, -5}, {'r', 2, 3}};
    EXPECT_EQ(steps_of("G81 X1 Z-5 R3\nX2"), wanted);
    EXPECT_EQ(steps_of("G91 G81 X1 Z-8 R-17 L2"), wanted) << "G91: L steps, R and Z are relative";
    EXPECT_EQ(steps_of("G98 G81 X1 Z-5 R3\nG80\nG0 X5").back(), (Step{'r', 5, 20}));
    EXPECT_NE(fault_of("F9\nG81 X1 Z-5 R3\nG82 X2 P1\n").find("3: G82: expected R"),
              std::string::npos)
        << "another cycle starts anew";
}

TEST(GcodeCycle, WrongOnesSayWhat) {
    const auto says = [](const std::string& block, const char* what) {
        EXPECT_NE(fault_of("F9\n" + block + "\n").find(what), std::string::npos)
            << fault_of("F9\n" + block + "\n");
    };
    says("G81 Z-5 R3 A1", "G81: A: a cycle uses only X, Y and Z");
    says("G81 X1 R3", "G81: expected Z");
    says("G81 X1 Z-3", "G81: expected R");
    says("G82 X1 Z-3 R1", "G82: expected P");
    says("G83 X1 Z-3 R1", "G83: expected Q");
    says("G83 X1 Z-3 R1 Q0", "G83: Q: expected the depth");
    says("G83 X1 Z-3 R1 Q0.00001", "G83: Q: more than 100000 pecks");
    says("G82 X1 Z-3 R1 P-1", "G82: P: expected 0 to");
    says("G81 X1 Z-3 R-4", "G81: R is below the bottom");
    says("G81 X1 Z-3 R1 L0", "G81: L: expected the number of repetitions, an integer from 1");
    says("G81 R1", "G81: expected axis words");
    says("G53 G81 X1 Z-3 R1", "G81: conflicts with G53");
    says("G93 G81 X1 Z-3 R1", "G81: conflicts with G93");
    says("G81 B1 Z-3 R1", "G81: B: a cycle");
    EXPECT_NE(fault_of("G81 X1 Z-3 R1\n").find("F: no feed is set"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 R5\n").find("R: no word of this block"), std::string::npos);
}

TEST(GcodeOffsetWords, MoveTheZeroAndNotTheMachine) {
    EXPECT_EQ(end_of("G10 L2 P1 X5\nG0 X1\n")[kX], 6);
    EXPECT_EQ(end_of("G55\nG10 L2 P0 X5\nG0 X1\n")[kX], 6) << "P0: the one in use";
    EXPECT_EQ(end_of("G10 L2 P2 X5\nG0 X1\n")[kX], 1) << "another one";
    EXPECT_EQ(end_of("G0 X4\nG10 L20 P1 X1\nG0 X3\n")[kX], 6) << "here is 1";
    EXPECT_EQ(end_of("G0 X4\nG92 X1\nG0 X3\n")[kX], 6);
    EXPECT_EQ(end_of("G52 X2\nG0 X3\n")[kX], 5);
    EXPECT_EQ(end_of("G52 X2\nG92.2\nG0 X3\n")[kX], 3);
    EXPECT_EQ(end_of("G52 X2\nG92.2\nG92.3\nG0 X3\n")[kX], 5);
    EXPECT_EQ(end_of("G52 X2\nG92.1\nG92.3\nG0 X3\n")[kX], 3);
    EXPECT_DOUBLE_EQ(end_of("G20 G10 L2 P1 X1\nG21 G0 X1\n")[kX], 26.4);
    EXPECT_NE(fault_of("G10 L1 P1 X1\n").find("G10: L: only L2 and L20"), std::string::npos);
    EXPECT_NE(fault_of("G10 P1 X1\n").find("G10: expected L2 or L20"), std::string::npos);
    EXPECT_NE(fault_of("G10 L2 P10 X1\n").find("G10: expected P from 1"), std::string::npos);
    EXPECT_NE(fault_of("G10 L2 X1\n").find("G10: expected P from 1"), std::string::npos);
    EXPECT_NE(fault_of("G92\n").find("G92: expected axis words"), std::string::npos);
    EXPECT_NE(fault_of("G92 B1\n").find("B: the machine has no axis"), std::string::npos);
}

TEST(GcodeRotation, TurnsXAndYOfTheProgramAboutTheOffset) {
    const auto at = [](const char* text) {
        const AxisPositions end = end_of(std::string("G10 L2 P1 X10 R90\n") + text);
        return std::array<long, 2>{std::lround(end[kX] * 1000), std::lround(end[kY] * 1000)};
    };
    using To = std::array<long, 2>;
    EXPECT_EQ(at("G0 X5 Y1\n"), (To{9000, 5000}));
    EXPECT_EQ(at("G0 X5 Y1\nY2\n"), (To{8000, 5000})) << "X keeps its programmed position";
    EXPECT_EQ(at("G0 X5 Y1\nG91 X1\n"), (To{9000, 6000}));
    EXPECT_EQ(at("G0 X5 Y1\nG53 G0 X3\n"), (To{3000, 5000}));
    EXPECT_EQ(at("G0 X5 Y1\nX[#5420 + 1] Y#5421\n"), (To{9000, 6000}));
    EXPECT_EQ(at("G0 X5 Y1\nG92 X0\nG0 X1\n"), (To{9000, 6000})) << "G92 counts as programmed";
    EXPECT_EQ(at("G52 X1\nG10 L2 P1 R90\nG0 X4 Y1\n"), (To{9000, 5000})) << "the same angle";
    EXPECT_EQ(at("G43.1 X2\nG0 X5 Y1\n"), (To{11000, 5000})) << "a tool does not turn";
    EXPECT_EQ(at("G10 L2 P1 R0\nG0 X5 Y1\n"), (To{15000, 1000}));
    EXPECT_EQ(at("G55 G0 X5 Y1\n"), (To{5000, 1000}));
    EXPECT_EQ(at("F9 G81 X5 Y1 Z-5 R0\n"), (To{9000, 5000}));
    EXPECT_EQ(at("F9 G0 X5 Y1\nG91 G81 X1 Z-5 R0 L2\n"), (To{9000, 7000}));
}

TEST(GcodeRotation, TurnsTheCentresOfArcs) {
    for (const char* const words : {"I2", "G90.1 I2 J0", "X4 R2", "X4 I2"}) {
        const Program program =
            program_of(std::string("G10 L2 P1 R90\nG0 X0 Y0 F9\nG2 ") + words + "\n");
        EXPECT_NEAR(program.moves.back().arc.center_first_mm, 0, 1e-12) << words;
        EXPECT_NEAR(program.moves.back().arc.center_second_mm, 2, 1e-12) << words;
    }
}

TEST(GcodeRotation, WhatLinuxcncDoesOtherwiseIsRefused) {
    const auto expect = [](const char* text, const char* what) {
        const std::string fault = fault_of(std::string("F9 G10 L2 P1 R90\nG0 X1 Y2\n") + text);
        EXPECT_NE(fault.find(what), std::string::npos) << fault;
    };
    expect("G10 L20 P1 X0\n", "L20 with a rotated work offset");
    expect("G10 L20 P2 R5\n", "L20 with a rotated work offset");
    expect("G18 G2 I1\n", "G2: not supported in a rotated work offset");
    expect("G18 G81 X1 Y-1 R0\n", "G81: not supported in a rotated work offset");
    expect("G28 X0\n", "G28 of one of X and Y: not supported in a rotated work offset");
    expect("G43.4\n", "tool centre point control: not supported in a rotated work offset");
    expect("G52 X1\nG10 L2 P1 R80\n", "G10: the rotation of X and Y changes under G92");
    expect("G52 X1\nG55\n", "G54: the rotation of X and Y changes under G92");
}

}  // namespace
}  // namespace axg::test
