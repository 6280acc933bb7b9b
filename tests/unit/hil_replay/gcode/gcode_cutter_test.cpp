// SPDX-License-Identifier: Apache-2.0
// Cutter compensation: where the tool's centre runs, and every refusal. LinuxCNC's interpreter
// judges random contours in tests/oracle/cutter_test.py.
#include "hil_replay/gcode/gcode_cutter.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

const std::string kBegin = "G41.1 D6 F100\nG1 X10\n";  // left of the contour, 3 mm

TEST(GcodeCutter, OuterCornersGetAnArcAndInnerOnesMeet) {
    const Program out = program_of(kBegin + "X20\nY-20\nG40 G0 X0\n");
    ASSERT_EQ(out.moves.size(), 5U);
    EXPECT_DOUBLE_EQ(out.moves[0].target[kX], 10);
    EXPECT_DOUBLE_EQ(out.moves[0].target[kY], 3);
    EXPECT_DOUBLE_EQ(out.moves[1].target[kX], 20);
    EXPECT_EQ(out.moves[2].kind, MoveKind::arc);
    EXPECT_NEAR(out.moves[2].arc.sweep_rad, -kPi / 2, 1e-12);
    EXPECT_DOUBLE_EQ(out.moves[2].arc.radius_end_mm, 3);
    EXPECT_DOUBLE_EQ(out.moves[2].target[kX], 23);
    EXPECT_DOUBLE_EQ(out.moves[3].target[kX], 23);
    EXPECT_DOUBLE_EQ(out.moves[3].target[kY], -20);
    EXPECT_DOUBLE_EQ(out.moves[4].target[kX], 0);
    EXPECT_DOUBLE_EQ(out.moves[4].target[kY], -20) << "off the contour's side";
    const Program in = program_of(kBegin + "X20\nY20\nG40\n");
    ASSERT_EQ(in.moves.size(), 3U);
    EXPECT_DOUBLE_EQ(in.moves[1].target[kX], 17);
    EXPECT_DOUBLE_EQ(in.moves[1].target[kY], 3);
    const Program arc = program_of(kBegin + "X20\nG3 Y10 J5\nG1 X10\nM2\n");
    EXPECT_NEAR(arc.moves[2].arc.radius_start_mm, 2, 1e-12);
    EXPECT_NEAR(arc.moves[2].arc.sweep_rad, kPi, 1e-12);
    EXPECT_NEAR(arc.moves.back().target[kY], 7, 1e-12);
    const Program right = program_of("G42.1 D-6 F9\nG1 X10\nM2\n");
    EXPECT_DOUBLE_EQ(right.moves[0].target[kY], 3) << "a negative diameter changes the side";
    EXPECT_EQ(program_of("G41.1 D0 F9\nG1 X1\nX5 Y5\nG40\n").moves[1].target[kY], 5);
    EXPECT_EQ(program_of(kBegin + "Z-1\nG4 P1\nX20\nM2\n").moves[1].kind, MoveKind::line);
}

TEST(GcodeCutter, TheDiameterIsTheMachineFiles) {
    Machine machine = motion_test_machine();
    const char* const program = "T2 M6\nG41 D1 F9\nG1 X10\nG40\nG0 X20\nG42\nG1 X30\nG40\n";
    EXPECT_NE(faults_of(read_gcode(program, machine, {}))
                  .find("2: G41: the machine file states no tools.1.diameter_mm, that of the "
                        "control's tool table\n"),
              std::string::npos);
    machine.tools[0].diameter_mm = 4;
    machine.tools[1].diameter_mm = 10;
    const GcodeResult result = read_gcode(program, machine, {});
    EXPECT_EQ(faults_of(result), "");
    EXPECT_EQ(result.program.moves[1].target[kY], 2);
    EXPECT_EQ(result.program.moves[3].target[kY], -5);
    EXPECT_EQ(result.read_as, (std::vector<std::string>{"tool 1 diameter 4 mm", "starts in mm",
                                                        "tool 2 diameter 10 mm"}));
}

TEST(GcodeCutter, EveryRefusalNamesItsReason) {
    const auto refused = [](const std::string& text) { return fault_of(text); };
    EXPECT_NE(refused("G41.1 D6 F9\nG1 X3\n")
                  .find("2: G41: cutter compensation: the move that "
                        "begins compensation is not longer"),
              std::string::npos);
    EXPECT_NE(refused("G41.1 D6 F9\nG3 X2 I1\nM2\n").find("ends nearer than the tool's radius"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "X11\nX12 Y9\nX10\nM2\n").find("without gouging"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "X20\nG3 Y4 J2\nM2\n").find("radius is not smaller"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "X20\nM0\nY20\nM2\n").find("an inner corner after a pause"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "X20\n%\n%\n").find("ends under cutter compensation"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "G91 X.1\nX.2\nG90 X10.3\nM2\n").find("rounding would decide"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "G40\nG2 X0 R9\n").find("4: G2: after G40"), std::string::npos);
    EXPECT_NE(refused(kBegin + "G42.1 D1\nM2\n").find("G42.1: cutter compensation is on"),
              std::string::npos);
    EXPECT_NE(refused("G41.1\n").find("G41.1: expected D, the diameter"), std::string::npos);
    EXPECT_NE(refused("G19 G41.1 D1\n").find("expected linear axes X and Y"), std::string::npos);
    EXPECT_NE(refused("G18 G41 D1\n").find("orientation in the control's tool table; write G41.1"),
              std::string::npos);
    EXPECT_NE(refused("G93 F9\nG41.1 D1\n").find("conflicts with G93"), std::string::npos);
    EXPECT_NE(refused("M428\nG41.1 D1\n").find("tool centre point control"), std::string::npos);
    EXPECT_NE(refused("G38.2 X9 F9\nG41.1 D1 G1 Y9\n").find("where a probe stopped"),
              std::string::npos);
    EXPECT_NE(refused("G38.2 X9 F9\nG2 I1\n").find("X: counts from where a probe stopped"),
              std::string::npos);
    EXPECT_NE(refused(kBegin + "#1 = #5420\nM2\n").find("#5420"), std::string::npos);
    EXPECT_NE(refused(kBegin + "G81 X1 Z-1 R2\nM2\n").find("G0 to G3 only"), std::string::npos);
    for (const char* const word : {"G18", "G20", "G93", "G43", "G54", "G64", "G98", "G53", "G28",
                                   "G92 X1", "T1 M6", "M48", "M62 P1", "M70", "M428"}) {
        EXPECT_NE(refused(kBegin + word + "\nM2\n")
                      .find("does not go with cutter compensation; write G40 before it"),
                  std::string::npos)
            << word;
    }
}

}  // namespace
}  // namespace axg::test
