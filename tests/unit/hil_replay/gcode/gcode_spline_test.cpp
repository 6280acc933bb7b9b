// SPDX-License-Identifier: Apache-2.0
// G5, G5.1, G5.2 and G5.3 move along LinuxCNC's pairs of arcs: through the points that Bernstein's
// formula and a circle give, in every unit and offset, and what it refuses or moves otherwise than
// written is refused. tests/linuxcnc/spline_test.py compares with a LinuxCNC that runs.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

using Place = std::array<double, 2>;

/// A Bezier curve of two or three degrees.
Place bernstein(std::initializer_list<Place> points, double t) {
    Place at{};
    const std::size_t degree = points.size() - 1;
    double factor = std::pow(1 - t, static_cast<double>(degree));
    std::size_t i = 0;
    for (const Place& point : points) {
        at[0] += factor * point[0];
        at[1] += factor * point[1];
        factor *= t / (1 - t) * static_cast<double>(degree - i) / static_cast<double>(i + 1);
        ++i;
    }
    return at;
}

Place target(const Move& move) {
    return {move.target[kX], move.target[kY]};
}

double apart(Place a, Place b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]);
}

TEST(GcodeSpline, CubicIsArcPairsThroughSixteenPointsOfItsCurve) {
    const Program program = program_of("F60\nG5 I0 J3 P0 Q-3 X1 Y1\nM2\n");
    ASSERT_EQ(program.moves.size(), 32U);
    for (std::size_t i = 1; i < 16; ++i) {
        const Place exact =
            bernstein({{0, 0}, {0, 3}, {1, -2}, {1, 1}}, static_cast<double>(i) / 16);
        EXPECT_LT(apart(target(program.moves[2 * i - 1]), exact), 1e-12) << i;
    }
    EXPECT_EQ(target(program.moves.back()), (Place{1, 1}));
    // The first pair by hand: from 0 0 straight up to B(1/16), where the curve goes along B'(1/16);
    // x(t) = 3 t^2 - 2 t^3, y(t) = 9 t - 24 t^2 + 16 t^3.
    const double x = 46.0 / 4096, y = 1936.0 / 4096, t = 1.0 / 16;
    const Place along{6 * t - 6 * t * t, 9 - 48 * t + 48 * t * t};
    const double size = std::hypot(along[0], along[1]);
    const Place tangent{along[0] / size, along[1] / size};
    const double a = 2 * (tangent[1] - 1), b = -2 * (x * tangent[0] + y * (1 + tangent[1]));
    const double c = x * x + y * y, length = (-b - std::sqrt(b * b - 4 * a * c)) / (2 * a);
    const Place middle{(x - length * tangent[0]) / 2, (length + y - length * tangent[1]) / 2};
    const Move& first = program.moves[0];
    EXPECT_LT(apart(target(first), middle), 1e-6);
    ASSERT_EQ(first.kind, MoveKind::arc);
    EXPECT_LT(first.arc.sweep_rad, 0) << "to the right";
    EXPECT_NEAR(first.arc.radius_start_mm,
                apart(middle, {0, 0}) * apart(middle, {0, 0}) / 2 / middle[0], 1e-2);
    EXPECT_NEAR(first.arc.start_rad, kPi, 1e-4) << "begins straight up";
}

TEST(GcodeSpline, QuadraticIsArcPairsThroughTwelvePointsOfItsCurve) {
    const Program program = program_of("F60 G0 X5 Y-2\nG5.1 I10 J20 X25 Y8\nM2\n");
    ASSERT_EQ(program.moves.size(), 25U);
    for (std::size_t i = 1; i < 12; ++i) {
        const Place exact = bernstein({{5, -2}, {15, 18}, {25, 8}}, static_cast<double>(i) / 12);
        EXPECT_LT(apart(target(program.moves[2 * i]), exact), 1e-12) << i;
        EXPECT_EQ(program.moves[2 * i].feed, 60);
        EXPECT_EQ(program.moves[2 * i].line, 2U);
    }
}

// With the weight of half the square root of 2 a quarter of a circle, exactly.
TEST(GcodeSpline, NurbsOfACircleIsThatCircle) {
    const Program program =
        program_of("F60 G0 X10\nG5.2 P1 L3\nX10 Y10 P0.707106781186547524\nX0 Y10 P1\nG5.3\nM2\n");
    ASSERT_EQ(program.moves.size(), 25U);
    double sweep_rad = 0;
    for (std::size_t i = 1; i < program.moves.size(); ++i) {
        const Move& move = program.moves[i];
        // Of the ends' tangents, from differences to one side, 7e-6 rad are missing.
        EXPECT_NEAR(apart(target(move), {0, 0}), 10, 2e-6) << i;
        EXPECT_NEAR(apart({move.arc.center_first_mm, move.arc.center_second_mm}, {0, 0}), 0, 2e-3);
        EXPECT_EQ(move.line, 5U);
        sweep_rad += move.arc.sweep_rad;
    }
    EXPECT_NEAR(sweep_rad, kPi / 2, 1e-4);
    EXPECT_EQ(target(program.moves.back()), (Place{0, 10}));
}

TEST(GcodeSpline, NurbsPointsMayStandInManyWays) {
    const char* const plain = "F60\nG5.2 X0 Y9 P1 L4\nX9 Y9 P2\nX9 Y0 P1\nX20 Y5 P3\nG5.3\nM2\n";
    const char* const wordy =
        "F60\nG5.2 P1\nG5.2 P1 X0 Y9\nX9 Y9 P2 L4 S90 M3\nF60 (aside)\nM8\n"
        "G5.2 X9 Y0 P1 L4\nX20 Y5 P3\nG5.3\nM2\n";
    const Program one = program_of(plain), other = program_of(wordy);
    ASSERT_EQ(one.moves.size(), 40U);
    ASSERT_EQ(other.moves.size(), 40U);
    for (std::size_t i = 0; i < one.moves.size(); ++i) {
        EXPECT_EQ(one.moves[i].target, other.moves[i].target) << i;
    }
    // Order 4 of five points: two spans; at their middle (1/6, 4/6, 1/6 of a uniform spline become
    // 1/4, 1/2, 1/4 between such ends).
    const Place middle = target(one.moves[19]);
    const double w = 1 / 4.0 * 1 + 1 / 2.0 * 2 + 1 / 4.0 * 1;
    EXPECT_NEAR(middle[0], (0 * 0.25 + 9 * 2 * 0.5 + 9 * 0.25) / w, 1e-12);
    EXPECT_NEAR(middle[1], (9 * 0.25 + 9 * 2 * 0.5 + 0 * 0.25) / w, 1e-12);
}

TEST(GcodeSpline, CubicGoesOnInTheDirectionOfTheOneBefore) {
    const char* const both[] = {"F60\nG5 I0 J3 P0 Q-3 X1 Y1\nM3 (aside)\nG5 P1 Q-3 X2 Y2\nM2\n",
                                "F60\nG5 I0 J3 P0 Q-3 X1 Y1\nG5 I0 J3 P1 Q-3 X2 Y2\nM2\n"};
    const Program one = program_of(both[0]), other = program_of(both[1]);
    ASSERT_EQ(one.moves.size(), 64U);
    for (std::size_t i = 0; i < one.moves.size(); ++i) {
        EXPECT_EQ(one.moves[i].target, other.moves[i].target) << i;
    }
    for (const char* const between : {"G0 X5\n", "G20\n", "G55\n", "G5.1 I1 J1 X5\n", "G92 X0\n"}) {
        EXPECT_NE(fault_of(std::string("G21 F60\nG5 I0 J3 P0 Q-3 X1 Y1\n") + between +
                           "G5 P0 Q-3 X2 Y2\n")
                      .find("4: G5: expected I and J"),
                  std::string::npos)
            << between;
    }
}

/// Every target, turned and moved, of the curve without unit and offset.
TEST(GcodeSpline, UnitsStepsOffsetsAndRotationMoveTheWholeCurve) {
    const Program plain = program_of("F60 G0 X20 Y-5\nG5 I5 J30 P-6 Q-20 X30 Y10\nM2\n");
    struct Case {
        const char* text;
        double turn_deg;
    };
    const Case cases[] = {
        {"G21 F60 G0 X20 Y-5\nG91 G5 I5 J30 P-6 Q-20 X10 Y15\nM2\n", 0},
        {"G20 F60 G0 X[20/25.4] Y[-5/25.4]\nG5 I[5/25.4] J[30/25.4] P[-6/25.4] Q[-20/25.4] "
         "X[30/25.4] Y[10/25.4]\nM2\n",
         0},
        {"G10 L2 P1 X7 Y-9\nG92 X-20 Y0\nF60 G0 X0 Y-5\nG5 I5 J30 P-6 Q-20 X10 Y10\nM2\n", 0},
        {"G10 L2 P1 X7 Y-9 R30\nF60 G0 X20 Y-5\nG5 I5 J30 P-6 Q-20 X30 Y10\nM2\n", 30},
        {"G10 L2 P1 X7 Y-9 R30\nF60 G0 X20 Y-5\nG91 G5 I5 J30 P-6 Q-20 X10 Y15\nM2\n", 30},
        {"G90.1 F60 G0 X20 Y-5\nG5 I5 J30 P-6 Q-20 X30 Y10\nM2\n", 0},
    };
    for (const Case& one : cases) {
        const Program program = program_of(one.text);
        ASSERT_EQ(program.moves.size(), plain.moves.size()) << one.text;
        const double c = std::cos(one.turn_deg * kTestRadPerDegree);
        const double s = std::sin(one.turn_deg * kTestRadPerDegree);
        const Place start = target(program.moves[0]), from = target(plain.moves[0]);
        for (std::size_t i = 1; i < plain.moves.size(); ++i) {
            const Place way{plain.moves[i].target[kX] - from[0],
                            plain.moves[i].target[kY] - from[1]};
            const Place at{start[0] + way[0] * c - way[1] * s, start[1] + way[0] * s + way[1] * c};
            EXPECT_LT(apart(target(program.moves[i]), at), 1e-8) << one.text << i;
            EXPECT_NEAR(program.moves[i].arc.sweep_rad, plain.moves[i].arc.sweep_rad, 1e-8);
        }
    }
    EXPECT_DOUBLE_EQ(program_of("G20\nF2\nG5.1 I1 J1 X2\nM2\n").moves[5].feed, 50.8);
    EXPECT_DOUBLE_EQ(program_of("S90 G95 F2\nG5.1 I1 J1 X2\nM2\n").moves[5].feed, 180);
}

TEST(GcodeSpline, FlatCurveOfLargeRadiusIsLines) {
    const Program program = program_of("F60 G0 X-290 Y10\nG5.1 I290 J0.077 X290 Y10\nM2\n");
    EXPECT_GT(program.moves.size(), 25U) << "one line would be 6e-5 mm off its arc";
    for (const Move& move : program.moves) {
        ASSERT_EQ(move.kind, MoveKind::line);
        const double share = (move.target[kX] + 290) / 580;
        EXPECT_NEAR(move.target[kY], 10 + 2 * 0.077 * share * (1 - share), 1e-5);
    }
}

TEST(GcodeSpline, RestOfTheProgramGoesOn) {
    EXPECT_EQ(end_of("F60\nG5.1 I1 J1 X2\nG1 Y3\nX4\nM2\n")[kX], 4);
    EXPECT_NE(fault_of("G1 F60 X1\nG5.1 I1 J1 X3\nX4\n")
                  .find("3: G5.1: counts for its own block: LinuxCNC would move on in the mode"),
              std::string::npos);
    EXPECT_NE(fault_of("F60\nG5.2 X1 Y1 P1\nX2 Y0 P1\nG5.3\nX4\n")
                  .find("5: G80: axis words without a motion mode"),
              std::string::npos);
    const Program tip = program_of("G0 A-20\nG43.4 H1\nF60 G0 X0 Y0\nG5.1 I1 J1 X2\nM2\n");
    EXPECT_EQ(tip.moves.back().kind, MoveKind::arc);
    EXPECT_EQ(tip.moves.back().control, 0U) << "a curve of the tip";
    EXPECT_NE(fault_of("F60\nG5.1 I0 J700 X2\n").find("Y: out of travel"), std::string::npos);
    EXPECT_NE(fault_of("F60\nG5.1 I0 J700 X2\n").find("the farthest in line 2 to 35"),
              std::string::npos);
    EXPECT_EQ(end_of("F60 G0 Z50\nG99 G81 X1 Z-5 R9\nG5.1 I1 J1 X3\nG98 G81 X9 Z-5 R5\nM2\n")[kZ],
              9)
        << "the height before the second row of holes";
    GcodeOptions options;
    options.moves_max = 7;
    EXPECT_NE(fault_of("F60\nG5.1 I1 J1 X2\nM2\n", options).find("longer than 7 moves"),
              std::string::npos);
}

struct Refusal {
    const char* text;
    const char* fault;
};

TEST(GcodeSpline, WrongWordsSaySo) {
    const Refusal refusals[] = {
        {"F60\nG5 P0 Q-3 X1 Y1\n", "2: G5: expected I and J, from the start"},
        {"F60\nG5 I1 P0 Q-3 X1 Y1\n", "2: G5: expected I and J"},
        {"F60\nG5 I0 J3 P0 X1 Y1\n", "2: G5: expected P and Q, from the end"},
        {"F60\nG5 I0 J3 Q1 X1 Y1\n", "2: G5: expected P and Q"},
        {"F60\nG5 I0 J3 P0 Q1\n", "2: G5: expected X and Y, the end"},
        {"F60\nG5.1 I1 X1 Y1\n", "2: G5.1: expected I and J, from the start"},
        {"F60\nG5 I0 J3 P0 Q-3 X1 Y1\nG5.1 X1 Y2\n", "3: G5.1: expected I and J"},
        {"F60\nG5.1 I1 J1 P1 X2\n", "2: P: no word of this block takes it (G4, G5, G5.2"},
        {"F60\nG5 I1 J1 P1 Q1 K1 X2\n", "2: K: no word of this block takes it"},
        {"F60\nG5 I1 J1 P1 Q1 X2 Z1\n", "2: G5: splines move X and Y only; write Z"},
        {"F60\nG5.1 I1 J1 X2 C1\n", "2: G5.1: splines move X and Y only; write C"},
        {"F60 G18\nG5.1 I1 J1 X2\n", "2: G5.1: splines are in the plane XY; write G17"},
        {"G93 F60\nG5.1 I1 J1 X2 F2\n", "2: G5.1: under G93 LinuxCNC has the feed of an earlier"},
        {"G5.1 I1 J1 X2\n", "1: F: no feed is set"},
        {"F60\nG4 P1 G5 I1 J1 Q1 X2\n", "2: G5: another word of the block takes its letters"},
        {"F60\nG64 P1 G5 I1 J1 Q1 X2\n", "2: G5: another word of the block takes its letters"},
        {"F60\nG53 G5.1 I1 J1 X2\n", "2: G5.1: conflicts with G53"},
        {"F60 G41.1 D1 G1 X5\nG5.1 I1 J1 X7\nG40\n", "2: G5.1: does not go with cutter"},
        {"F60\nG38.2 X9\nG5.1 I1 J1 X20\n", "3: X: counts from where a probe stopped"},
        {"F60\nG5.1 I99999999 J1 X2\n", "2: G5.1: a control point is farther away than any"},
    };
    for (const Refusal& one : refusals) {
        EXPECT_EQ(fault_of(one.text).find(one.fault), 0U) << fault_of(one.text);
    }
}

TEST(GcodeSpline, WrongNurbsSaysSo) {
    const Refusal refusals[] = {
        {"F60\nG5.2 X1 Y1\nX2 Y2 P1\nG5.3\n", "2: G5.2: expected P above 0"},
        {"F60\nG5.2 P0\nX2 Y2 P1\nG5.3\n", "2: G5.2: expected P above 0"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y2 P-1\nG5.3\n", "3: G5.2: expected P above 0"},
        {"F60\nG5.2 X1 P1\nX2 Y2 P1\nG5.3\n", "2: G5.2: expected X, Y and P"},
        {"F60\nG5.2 X1 Y1 P1\nG5.2 P1\nG5.3\n", "3: G5.2: expected X, Y and P"},
        {"F60\nG5.2 X1 Y1 P1 L2\nX2 Y3 P1\nG5.3\n",
         "2: G5.2: L: found 2, expected an order from 3"},
        {"F60\nG5.2 X1 Y1 P1 L11\nX2 Y3 P1\nG5.3\n", "2: G5.2: L: found 11, expected"},
        {"F60\nG5.2 X1 Y1 P1 L4\nX2 Y3 P1 L3\nG5.3\n", "3: G5.2: L: found 3 after 4"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y3 P1 Z1\nG5.3\n", "3: G5.2: splines move X and Y only"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y3 P1 I1\nG5.3\n", "3: G5.2: takes X, Y, P and L only"},
        {"F60 G91\nG5.2 X1 Y1 P1\nX2 Y3 P1\nG5.3\n", "2: G5.2: under G91 LinuxCNC counts all"},
        {"F60 G19\nG5.2 X1 Y1 P1\nX2 Y3 P1\nG5.3\n", "2: G5.2: splines are in the plane XY"},
        {"G5.2 X1 Y1 P1\nF60 X2 Y3 P1\nG5.3\n", "1: F: no feed is set"},
        {"F60\nG5.2 X1 Y1 P1\nG5.3\n",
         "3: G5.3: found 2 control points with the start, expected 3"},
        {"F60\nG5.2 X1 Y1 P1 L4\nX2 Y3 P1\nG5.3\n", "4: G5.3: found 3 control points with the"},
        {"G5.3\n", "1: G5.3: expected G5.2 before it"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y3 P1\nG5.3 X9\n", "4: G5.3: LinuxCNC runs it before other words"},
        {"F60\nG5.2 X1 Y1 P1\nG5.2 G5.3 X2 Y3 P1\n",
         "3: G5.3: LinuxCNC runs it before other words"},
        {"F60\nG5.2 X1 Y1 P1\nG1 X2\nG5.3\n", "3: G5.2: only its points, F, S, and words of"},
        {"F60\nG5.2 X1 Y1 P1\nG20\nX2 Y3 P1\nG5.3\n", "3: G5.2: only its points, F, S"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y3 P1\nM2\n", "4: G5.2: only its points, F, S, and words of"},
        {"F60\nG5.2 X1 Y1 P1\nX2 Y3 P1\n", "3: G5.2: the program ends between G5.2 and G5.3"},
        {"F60\nG5.2 X1 Y1 P1 M2\n", "2: G5.2: the program ends between"},
        {"F60\nM70\nG5.2 X1 Y1 P1\nM72\nG5.3\n", "4: M72: modes are restored between G5.2"},
    };
    for (const Refusal& one : refusals) {
        EXPECT_EQ(fault_of(one.text).find(one.fault), 0U) << fault_of(one.text);
    }
}

// A LinuxCNC (2.9) that runs goes from the start of a straight curve to the end of the next move.
TEST(GcodeSpline, StraightOrStandingCurvesAreRefused) {
    for (const char* const text : {"G5 I1 J0 P-1 Q0 X3 Y0\n", "G5 I1 J1 P-1 Q-1 X3 Y3\n",
                                   "G5.1 I0 J0 X3 Y1\n", "G5.1 I10 J1 X20 Y2\n"}) {
        EXPECT_NE(fault_of(std::string("F60\n") + text).find("a part of the curve is straight"),
                  std::string::npos)
            << text;
    }
    // Three points in a row make a part of a quadratic NURBS straight; just out of it, no longer.
    EXPECT_NE(fault_of("F60\nG5.2 X1 Y0 P1\nX2 Y0 P1\nX3 Y5 P1\nG5.3\n").find("5: G5.3: a part of"),
              std::string::npos);
    EXPECT_EQ(program_of("F60\nG5.2 X1 Y0.01 P1\nX2 Y0 P1\nX3 Y5 P1\nG5.3\nM2\n").moves.size(),
              32U);
    EXPECT_NE(fault_of("F60\nG5.1 I0 J0 X0 Y0\n").find("the curve stands still"),
              std::string::npos);
    EXPECT_NE(fault_of("F60\nG5.2 X0 Y0 P1\nX0 Y0 P1\nG5.3\n").find("the curve stands still"),
              std::string::npos);
}

}  // namespace
}  // namespace axg::test
