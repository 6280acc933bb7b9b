// SPDX-License-Identifier: Apache-2.0
// Tool offsets, tool centre point control and feed per revolution: what each word does, worked out
// by hand on a table machine, and what every wrong use says. The tip on its line: tests/property.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

GcodeResult read_on(const Machine& machine, std::string_view text, const std::string& part = "") {
    GcodeOptions options;
    options.part = part;
    return read_gcode(text, machine, options);
}

/// Where the axes are after the last move.
AxisPositions axes_at_end(const Program& program) {
    return axes_after(program, program.moves.back());
}

TEST(Jet, CarriesThreeDerivatives) {
    // sin(s^2) / (1 + s) at s = 0.5, derivatives by hand.
    const Jet s(0.5, 1, 0, 0);
    const Jet value = sin_cos_of(s * s).sin / (Jet(1) + s);
    const double sine = std::sin(0.25), cosine = std::cos(0.25);
    const double f0 = sine, f1 = 2 * 0.5 * cosine, f2 = 2 * cosine - 4 * 0.25 * sine;
    const double f3 = -12 * 0.5 * sine - 8 * 0.125 * cosine;
    const double g = 1 / 1.5;
    EXPECT_NEAR(value.d[0], f0 * g, 1e-15);
    EXPECT_NEAR(value.d[1], f1 * g - f0 * g * g, 1e-15);
    EXPECT_NEAR(value.d[2], f2 * g - 2 * f1 * g * g + 2 * f0 * g * g * g, 1e-14);
    EXPECT_NEAR(value.d[3], f3 * g - 3 * f2 * g * g + 6 * f1 * g * g * g - 6 * f0 * g * g * g * g,
                1e-14);
    const SinCosOf<Jet> of_square = sin_cos_of(s * s);
    EXPECT_NEAR(of_square.cos.d[3], -12 * 0.5 * cosine + 8 * 0.125 * sine, 1e-14);
}

// What LinuxCNC's own demonstration of switched kinematics expects (configs/sim/axis/vismach/5axis,
// xyzac_switchkins_test_3.ngc): its table turns with C, where the usual one turns against it.
TEST(GcodeTip, SwitchingRenamesThePlaceAndMovesNothing) {
    Machine machine = motion_test_machine();
    for (Body& body : machine.bodies) {
        if (body.name == "plate") {
            body.joint.direction = {0, 0, 1};
        }
    }
    const GcodeResult result =
        read_on(machine,
                "M429\nG0 C90 X10 Y0 Z2\nM428\nG1 F1000 Z0\nM429\nG0 X#5420 Y[#5421 + 1] Z#5422\n");
    ASSERT_EQ(faults_of(result), "");
    const std::vector<Move>& moves = result.program.moves;
    ASSERT_EQ(moves.size(), 5U);
    EXPECT_EQ(moves[1].kind, MoveKind::coordinates);
    EXPECT_NEAR(moves[1].target[kX], 0, 1e-12);
    EXPECT_NEAR(moves[1].target[kY], -10, 1e-12);
    EXPECT_NEAR(moves[1].target[kZ], 2, 1e-12);
    EXPECT_NEAR(moves[2].target[kY], -10, 1e-12);
    EXPECT_EQ(moves[2].target[kZ], 0);
    EXPECT_EQ(moves[3].control, kNoIndex);
    EXPECT_NEAR(moves[3].target[kX], 10, 1e-12);
    EXPECT_NEAR(moves[3].target[kY], 0, 1e-12);
    EXPECT_NEAR(moves[4].target[kY], 1, 1e-12) << "#5421 is of the axes again";
}

// The plate lies 200 mm below the nose; a tip 30 mm beside its centre on the plate stays on it.
TEST(GcodeTip, ATurnKeepsTheTipOnThePart) {
    const Program program = program_of("G43 M428\nG0 X30 Y0 Z-150\nG1 C90 F100\n");
    const AxisPositions end = axes_at_end(program);
    EXPECT_NEAR(end[kX], 0, 1e-12);
    EXPECT_NEAR(end[kY], -30, 1e-12) << "the plate turns against C, from above with the clock";
    EXPECT_NEAR(end[kZ], -100, 1e-12) << "tool 1 is 50 mm long";
    const AxisPositions tilted = axes_at_end(program_of("G43 M428\nG0 X0 Y0 Z-200\nA-90\n"));
    EXPECT_NEAR(tilted[kY], 0, 1e-12) << "the tip is on the axis A";
    EXPECT_NEAR(tilted[kZ], -150, 1e-12);
}

TEST(GcodeTip, LengthAndControlComeTogetherWithG434) {
    const char* const apart = "G43 H2\nM428\nG0 X10 Y5 Z-100 A-30 C40\n";
    const AxisPositions one = axes_at_end(program_of("G43.4 H2\nG0 X10 Y5 Z-100 A-30 C40\n"));
    const AxisPositions other = axes_at_end(program_of(apart));
    EXPECT_EQ(one, other);
    EXPECT_NE(one, axes_at_end(program_of("G43 H2\nG0 X10 Y5 Z-100 A-30 C40\n")));
    // Another word of the group ends it; M428 goes on until M429.
    EXPECT_EQ(program_of("G43.4\nG49\nG0 X1\n").moves.back().control, kNoIndex);
    EXPECT_EQ(program_of("G43.4\nG43\nG0 X1\n").moves.back().control, kNoIndex);
    EXPECT_NE(program_of("G43.4 M428\nG49\nG0 X1\n").moves.back().control, kNoIndex);
    EXPECT_EQ(program_of("G43 M428\nM429\nG0 X1\n").moves.back().control, kNoIndex);
    EXPECT_TRUE(program_of("M429\n").moves.empty()) << "it was not on";
}

TEST(GcodeTip, AnotherToolOffsetRenamesThePlaceToo) {
    const Program program = program_of("G43 H1 M428\nG0 X10 A-30\nG43 H2\nG49\n");
    ASSERT_EQ(program.moves.size(), 4U);
    const AxisPositions before = axes_after(program, program.moves[1]);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(axes_after(program, program.moves[2])[i], before[i], 1e-11);
        EXPECT_NEAR(axes_after(program, program.moves[3])[i], before[i], 1e-11);
    }
    EXPECT_NEAR(program.moves[3].target[kZ] - program.moves[1].target[kZ],
                50 * std::cos(kPi / 6) - 50, 1e-11)
        << "what is commanded is now the nose, 50 mm along the tilted spindle";
    EXPECT_EQ(program.controls.size(), 3U);
    EXPECT_EQ(program_of("G43 H1 M428\nG43 H2\nG43 H1\nG43 H2\n").controls.size(), 2U);
}

// As LinuxCNC's interpreter has it, which knows no kinematics: oracle.rs274 compares both.
TEST(GcodeTip, WordsLeftOutAfterAnotherToolOffsetMeanWhatTheyMeantBefore) {
    const Program program = program_of("M428\nG0 X0 Y0 Z-60 A-30\nG43 H1 Z-50\n");
    ASSERT_EQ(program.moves.size(), 4U);
    const Move &standing = program.moves[2], &next = program.moves[3];
    EXPECT_EQ(standing.kind, MoveKind::coordinates);
    EXPECT_NEAR(std::abs(standing.target[kY]), 50 * std::sin(kPi / 6), 1e-9)
        << "the tip is a tilted tool's length from where the nose was";
    EXPECT_EQ(next.target[kX], 0);
    EXPECT_EQ(next.target[kY], 0) << "and goes to the place that the program still means";
    EXPECT_EQ(next.target[kZ], 0) << "-50, and the length of tool 1";
    // Back to the place by its own words is a move, though no word changes.
    EXPECT_EQ(program_of("M428\nG0 Z-60 A-30\nG43 H1\nG0 Z[-60 - 50]\n").moves.size(), 4U);
    EXPECT_EQ(end_of("M428\nG0 X0 Z-60 A-30\nG43 H1\nG91 G0 X2\n")[kX], 2);
    EXPECT_EQ(end_of("M428\nG0 X3 Z-60 A-30\nG43 H1\nG92 X0\nG0 X0\n")[kX], 3);
}

TEST(GcodeTip, NothingButAMoveGoesToThePlaceThatIsMeant) {
    const Program program = program_of("M428\nG0 X0 Y0 Z-60 A-30\nG43 H1\nG4 P1\nM429\nG4 P1\n");
    ASSERT_EQ(program.moves.size(), 6U);
    const AxisPositions before = axes_after(program, program.moves[1]);
    for (std::size_t move = 2; move < 6; ++move) {
        for (std::size_t i = 0; i < 5; ++i) {
            EXPECT_NEAR(axes_after(program, program.moves[move])[i], before[i], 1e-9)
                << move << ' ' << i;
        }
    }
    EXPECT_NE(fault_of("M428\nG0 X0 Y0 Z-60 A-30\nG43 H1\nG2 I5 F100\n").find("write G0 or G1"),
              std::string::npos);
    EXPECT_EQ(program_of("M428\nG0 Z-60\nG43 H1\nG2 I5 F100\n").moves.size(), 4U)
        << "not tilted, the tip is at the place";
}

TEST(GcodeTip, OffsetsByWordsReplaceTheNamedAxes) {
    EXPECT_EQ(end_of("G43.1 X1 Z50\nG0 X0 Y0 Z0\n")[kX], 1.0);
    const AxisPositions end = end_of("G43.1 X1 Z50\nG20 G43.1 Z1\nG21 G0 X0 Y2 Z0\n");
    EXPECT_EQ(end[kX], 1.0) << "not named again";
    EXPECT_EQ(end[kY], 2.0);
    EXPECT_EQ(end[kZ], 25.4);
    EXPECT_EQ(end_of("G43.1 X1 Z50\nG49\nG0 X3 Z4\n")[kX], 3.0);
    EXPECT_TRUE(program_of("G0\nG43.1 X1\n").moves.empty()) << "it moves nothing";
    EXPECT_EQ(fault_of("G43.1 X1 G0\n"),
              "1: G43.1: takes the axis words of its block; write other words in another block\n");
    EXPECT_NE(fault_of("G43.1 B1\n").find("B: the machine has no axis"), std::string::npos);
    EXPECT_NE(fault_of("G43.1 X1 H2\n").find("H: no word of this block takes it (G43 and G43.4"),
              std::string::npos);
}

TEST(GcodeTip, AMachineWithoutATipSaysSo) {
    Machine machine = motion_test_machine();
    machine.bodies.back().is_tool = false;
    EXPECT_EQ(
        faults_of(read_on(machine, "G0 X1\nM428\n")),
        "2: M428: tool centre point control: no body of the machine file has tool: true, so that "
        "the tip is unknown; correct the machine file, or ignore M428 with --ignore M428,M429\n");
    machine = motion_test_machine();
    machine.axes[kY].name = "V";
    EXPECT_NE(faults_of(read_on(machine, "G43.4\n"))
                  .find("1: G43.4: tool centre point control: the "
                        "machine has no linear axis Y"),
              std::string::npos);
    machine = motion_test_machine();
    machine.bodies[4].joint.direction = {1, 0, 0};  // Z along X
    EXPECT_NE(faults_of(read_on(machine, "M428\n")).find("do not move the tip in all directions"),
              std::string::npos);
}

TEST(GcodeTip, ThePartIsOnTheBodyThatMostAxesMoveOrTheNamedOne) {
    Machine machine = motion_test_machine();
    const char* const text = "M428\nG0 X30 Y0 C90\n";
    const AxisPositions on_plate = axes_at_end(read_on(machine, text).program);
    EXPECT_EQ(axes_at_end(read_on(machine, text, "plate").program), on_plate);
    const AxisPositions on_table = axes_at_end(read_on(machine, text, "table").program);
    EXPECT_NEAR(on_table[kX], 30, 1e-12) << "C does not turn the table";
    EXPECT_NE(faults_of(read_on(machine, text, "plat"))
                  .find("--part plat: the machine file has no "
                        "body of this name"),
              std::string::npos);
    // A second spindle of the table: as many axes, other ones.
    machine.axes.push_back(machine.axes[kC]);
    machine.axes.back().name = "B";
    machine.bodies.push_back(machine.bodies[3]);
    machine.bodies.back().name = "other";
    machine.bodies.back().joint.axis = 5;
    EXPECT_NE(faults_of(read_on(machine, text))
                  .find("ambiguous body of the part: plate or other. Select one with --part BODY"),
              std::string::npos);
    EXPECT_EQ(faults_of(read_on(machine, text, "plate")), "");
}

// Both ends are inside the travel of X; half-way the tip, 353.6 mm from the axis C, is on X.
TEST(GcodeTip, ACurveThatLeavesTheTravelIsRefused) {
    const std::string fault = fault_of("M428\nG0 X250 Y250\nG1 F100 C90\n");
    EXPECT_NE(fault.find("3: X: out of travel: goes to 353.553 mm, the upper end is 300 mm"),
              std::string::npos)
        << fault;
    EXPECT_EQ(faults_of(read("M428\nG0 X212 Y212\nG1 F100 C90\n")), "");
}

TEST(GcodeTip, ASingularPlaceIsRefusedWithItsLine) {
    // Z is a quill in the tilting cradle's place: at 90 degrees it goes along Y.
    Machine machine = motion_test_machine();
    machine.axes[kA].max = 95 * kTestRadPerDegree;
    machine.bodies.clear();
    const auto carried = [&machine](const char* name, std::uint32_t parent, std::uint32_t axis,
                                    Vec3d direction) {
        Body body;
        body.name = name;
        body.parent = parent;
        body.joint = {.axis = axis, .direction = direction, .pivot_mm = {}};
        machine.bodies.push_back(body);
    };
    carried("table", kNoIndex, kX, {-1, 0, 0});
    carried("ram", kNoIndex, kY, {0, 1, 0});
    carried("head", 1, kA, {1, 0, 0});
    carried("quill", 2, kZ, {0, 0, 1});
    carried("cutter", 3, kNoIndex, {0, 0, 1});
    machine.bodies.back().is_tool = true;
    EXPECT_EQ(faults_of(read_on(machine, "G43.4\nG0 Z-100\nA30\nA-60\n")), "");
    const std::string fault = faults_of(read_on(machine, "G43.4\nG0 Z-100\nA30\nA-90\nA-80\n"));
    EXPECT_NE(fault.find("4: tool centre point control: singular: "), std::string::npos) << fault;
    EXPECT_EQ(std::count(fault.begin(), fault.end(), '\n'), 1) << fault;
}

TEST(GcodeTip, MachineZeroAndControlDoNotGoTogether) {
    EXPECT_NE(fault_of("M428\nG28\n").find("2: G28: its position means axes"), std::string::npos);
    EXPECT_EQ(faults_of(read("M428\nM429\nG28\n")), "");
}

TEST(GcodeFeed, PerRevolutionCountsWithTheSpindle) {
    const Program program = program_of("G95 S600 F0.1 G1 X1\nS300 X2\nG20 F0.01 X0\nG94 F50 X1\n");
    EXPECT_DOUBLE_EQ(program.moves[0].feed, 60.0);
    EXPECT_DOUBLE_EQ(program.moves[1].feed, 30.0);
    EXPECT_DOUBLE_EQ(program.moves[2].feed, 0.01 * 300)
        << "F of the block with G20 still counts in mm";
    EXPECT_DOUBLE_EQ(program.moves[3].feed, 50 * 25.4);
    EXPECT_EQ(program.moves[0].feed_kind, FeedKind::per_minute);
    EXPECT_DOUBLE_EQ(program_of("G95 S100 F2 G1 C9\n").moves[0].feed, 200.0) << "degrees";
    EXPECT_DOUBLE_EQ(program_of("G95 S100 F2\nG81 X1 Z-1 R1\n").moves[2].feed, 200.0);
    EXPECT_EQ(fault_of("G95 F1\nG1 X1\n"),
              "2: G95: the spindle is off; write S above 0 before a move at feed\n");
    EXPECT_NE(fault_of("G95 F1 S5\nG1 X1\nS0\nX2\n").find("4: G95: the spindle is off"),
              std::string::npos);
}

// As LinuxCNC does it, even where the mode was on before.
TEST(GcodeFeed, TheWordOfAModeForgetsTheFeed) {
    for (const char* const text :
         {"G94 F100\nG94\nG1 X1\n", "S9 G95 F1\nG94\nG1 X1\n", "F100\nG95 S9\nG1 X1\n"}) {
        EXPECT_NE(fault_of(text).find("3: F: no feed is set"), std::string::npos) << text;
    }
    EXPECT_EQ(faults_of(read("F100\nG93 G1 X1 F2\nG94 F100 X2\n")), "");
}

}  // namespace
}  // namespace axg::test
