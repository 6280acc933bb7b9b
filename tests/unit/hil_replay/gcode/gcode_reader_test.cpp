// SPDX-License-Identifier: Apache-2.0
// What every word does, and what every wrong one says. The programs are a line or two; the oracle
// is the dialect's description, worked out by hand.
#include "hil_replay/gcode/gcode_reader.hpp"

#include <gtest/gtest.h>

#include "hil_replay/gcode/gcode_words.hpp"
#include "tests/support/gcode_text.hpp"

namespace axg::test {
namespace {

TEST(GcodeLexer, BlanksCaseAndCommentsDoNotMatter) {
    const AxisPositions end = end_of("%\nn10 g0(rapid) x 1 2 . 5 Y-.5z+3 (over) ; X99 \r\nM2\n%\n");
    EXPECT_EQ(end[kX], 12.5);
    EXPECT_EQ(end[kY], -0.5);
    EXPECT_EQ(end[kZ], 3.0);
}

TEST(GcodeLexer, LinesEndWithEitherCharacterOrBoth) {
    for (const char* const text :
         {"G0 X1 ; to\rY2 (there)\rM2\r", "G0 X1 ; to\r\nY2 (there)\r\nM2\r\n",
          "G0 X1 ; to\nY2 (there)\rM2\r\n", "\r\r\n\nG0 X1\rY2\r\nM2"}) {
        const AxisPositions end = end_of(text);
        EXPECT_EQ(end[kX], 1) << text;
        EXPECT_EQ(end[kY], 2) << text;
    }
    EXPECT_NE(fault_of("M3\rM5\r\nG0 X1 !\n").find("3: !"), std::string::npos);
    EXPECT_EQ(read("M3\r\nM5\rM2\r").notes,
              std::vector<std::string>{"2: a carriage return alone ends the line; LinuxCNC reads "
                                       "it as a blank: convert the line ends"});
    EXPECT_EQ(read("M3\r\nM5\rM2\r").read_as, std::vector<std::string>{"CR alone ends a line"});
    EXPECT_TRUE(read("M3\r\nM5\r\nM2\r\n").notes.empty());
    EXPECT_TRUE(read("M3\r\nM5\r\nM2\r\n").read_as.empty());
}

TEST(GcodeLexer, WhatIsNoWordSaysSo) {
    EXPECT_NE(fault_of("G0 X#<a>\n").find("1: X#: #<A>: no line has set it"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 (open\n").find("comment not closed"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 (a (b))\n").find("comment inside a comment"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1.2.3\n").find("X1.2.3: expected a number"), std::string::npos);
    EXPECT_NE(fault_of("G0 X\n").find("X: expected a number"), std::string::npos);
    EXPECT_NE(fault_of("G0 X+-3\n").find("X+-3: expected a number"), std::string::npos);
    EXPECT_NE(fault_of("G0 @10\n").find("@: not supported (polar"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 !\n").find("!: unexpected character"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 \x80\n").find("byte 0x80"), std::string::npos);
    EXPECT_NE(fault_of("G0 N5 X1\n").find("N5: a line number is only allowed at the start"),
              std::string::npos);
    EXPECT_NE(fault_of(std::string(254, ' ') + "\n").find("longer than 253"), std::string::npos);
    EXPECT_EQ(faults_of(read(std::string(253, ' ') + "\n")), "");
}

TEST(GcodeUnits, InchScalesLinearAxesAndFeedButNotDegrees) {
    const Program program = program_of("G20\nG1 X1 A-10 F10\nG21 G1 X1 F10\nC5\n");
    EXPECT_DOUBLE_EQ(program.moves[0].target[kX], 25.4);
    EXPECT_DOUBLE_EQ(program.moves[0].target[kA], -10 * kTestRadPerDegree);
    EXPECT_DOUBLE_EQ(program.moves[0].feed, 254.0);
    EXPECT_DOUBLE_EQ(program.moves[1].target[kX], 1.0);
    // F is read before the unit of its own block, as the dialect's order of execution says.
    EXPECT_DOUBLE_EQ(program.moves[1].feed, 254.0);
    EXPECT_DOUBLE_EQ(program.moves[2].feed, 10.0) << "degrees a minute know no inch";
}

TEST(GcodeDistance, IncrementalAddsToWhereTheAxisIs) {
    const AxisPositions end = end_of("G0 X10 C90\nG91 X5 C-30\nX5 G90 Y1\n");
    EXPECT_EQ(end[kX], 5.0) << "the block itself is absolute again";
    EXPECT_EQ(end_of("G0 X10 C90\nG91 X5 C-30\n")[kX], 15.0);
    EXPECT_DOUBLE_EQ(end_of("G0 C90\nG91 C300\n")[kC], 390 * kTestRadPerDegree)
        << "an endless axis goes the programmed way";
}

TEST(GcodeOffsets, EachWorkOffsetMovesItsOwnAxes) {
    GcodeOptions options;
    const char* const names[] = {"G54", "G55",   "G56",   "G57",  "G58",
                                 "G59", "G59.1", "G59.2", "G59.3"};
    for (std::size_t i = 0; i < kWorkOffsets; ++i) {
        options.work_offsets[i][kX] = 10.0 * static_cast<double>(i + 1);
        options.work_offsets[i][kZ] = -5;
    }
    for (std::size_t i = 0; i < kWorkOffsets; ++i) {
        const AxisPositions end = end_of(std::string(names[i]) + " G0 X1 Z2\n", options);
        EXPECT_EQ(end[kX], 10.0 * static_cast<double>(i + 1) + 1) << names[i];
        EXPECT_EQ(end[kZ], -3.0) << names[i];
    }
    EXPECT_EQ(end_of("G55 G53 G0 X1 Z2\n", options)[kX], 1.0) << "G53 knows no offset";
    EXPECT_NE(fault_of("G53 G1 G91 X1 F10\n").find("G53: expected G0 or G1"), std::string::npos);
    EXPECT_NE(fault_of("G53 G2 X1 Y1 R9 F10\n").find("G53: expected G0 or G1"), std::string::npos);
}

TEST(GcodeTools, LengthComesFromTheMachineFile) {
    EXPECT_EQ(end_of("G43 H2 G0 Z10\n")[kZ], 90.0);
    EXPECT_EQ(end_of("T2 M6\nG43 G0 Z10\n")[kZ], 90.0) << "the tool in the spindle";
    EXPECT_EQ(end_of("G43 G0 Z10\n")[kZ], 60.0) << "the machine's first tool";
    EXPECT_EQ(end_of("G43 H2\nG49 G0 Z10\n")[kZ], 10.0);
    EXPECT_EQ(end_of("G43 H0 G0 Z10\n")[kZ], 60.0) << "H0: the tool in the spindle";
    EXPECT_EQ(end_of("T2 M6\nG43 H0 G0 Z10\n")[kZ], 90.0);
    EXPECT_EQ(end_of("G43 H2 G0 X1\n")[kZ], 0.0) << "the offset itself moves nothing";
    EXPECT_NE(fault_of("G43 H7\n").find("H7: the machine file has no tool 7"), std::string::npos);
    EXPECT_NE(fault_of("T7\n").find("T7: the machine file has no tool 7"), std::string::npos);
    EXPECT_NE(fault_of("M6\n").find("M6: no tool was selected"), std::string::npos);
    EXPECT_NE(fault_of("T1.5\n").find("T: found 1.5, expected a tool number"), std::string::npos);
    GcodeOptions options;
    options.tools = {{150, 2}};
    EXPECT_EQ(end_of("T150 M6\nG43 H150 G0 Z10\n", options)[kZ], 90.0);
    const Program program = program_of("T2\nT2 M6\n");
    ASSERT_EQ(program.moves.size(), 1U);
    EXPECT_EQ(program.moves[0].kind, MoveKind::tool_change);
    EXPECT_EQ(program.moves[0].tool, 2);
}

// rs274 2.9 takes the first branch for each of these.
TEST(GcodeParameters, NamesOfTheControlExist) {
    for (const char* const name : {"_metric", "_task", "_feed", "_x", "_value"}) {
        EXPECT_EQ(end_of("o1 if [EXISTS[#<" + std::string(name) + ">]]\nG0 X4\no1 endif\n")[kX],
                  4.0)
            << name;
    }
    EXPECT_TRUE(read("o1 if [EXISTS[#<_mine>]]\nG0 X4\no1 endif\n").program.moves.empty());
    EXPECT_NE(fault_of("o1 if [EXISTS[#<_ini[A]B>]]\nG0 X4\no1 endif\n").find("EXISTS: pins and"),
              std::string::npos);
}

TEST(GcodeFeed, MissingOrWrongIsAnError) {
    EXPECT_NE(fault_of("G1 X1\n").find("F: no feed is set"), std::string::npos);
    EXPECT_NE(fault_of("G1 X1 F-3\n").find("F: found -3"), std::string::npos);
    EXPECT_NE(fault_of("G93 G1 X1 F10\nX2\n").find("2: F: G93 is on"), std::string::npos);
    const Program program = program_of("G1 X1 F30\nG93 X2 F10\nG94 X3 F30\n");
    EXPECT_EQ(program.moves[1].feed_kind, FeedKind::inverse);
    EXPECT_EQ(program.moves[1].feed, 10.0);
    EXPECT_EQ(program.moves[2].feed_kind, FeedKind::per_minute);
    EXPECT_EQ(program.moves[2].feed, 30.0);
    EXPECT_EQ(program_of("G0 X1\n").moves[0].feed_kind, FeedKind::rapid);
}

TEST(GcodeDwell, TakesSecondsBeforeTheMoveOfItsBlock) {
    const Program program = program_of("G4 P1.5\n");
    EXPECT_EQ(program.moves[0].kind, MoveKind::dwell);
    EXPECT_EQ(program.moves[0].dwell_s, 1.5);
    EXPECT_NE(fault_of("G4\n").find("G4: expected P"), std::string::npos);
    EXPECT_NE(fault_of("G4 P-1\n").find("P: found -1"), std::string::npos);
    const Program moving = program_of("G0 X1\nG4 P1 X2\n");
    ASSERT_EQ(moving.moves.size(), 3U);
    EXPECT_EQ(moving.moves[1].dwell_s, 1);
    EXPECT_EQ(moving.moves[2].target[kX], 2);
    EXPECT_NE(fault_of("G0 X1\nF9 G2 I2\nG4 P1 X2 I1\n").find("G4: conflicts with an arc"),
              std::string::npos);
}

TEST(GcodeHome, GoesByTheWayPointAndMovesNamedAxesOnly) {
    EXPECT_EQ(end_of("G0 X5 Y6 C90\nG28\n"), AxisPositions{});
    const Program program = program_of("G0 X5 Y6 C90\nG28 X7\n");
    ASSERT_EQ(program.moves.size(), 3U);
    EXPECT_EQ(program.moves[1].target[kX], 7.0);
    EXPECT_EQ(program.moves[2].target[kX], 0.0);
    EXPECT_EQ(program.moves[2].target[kY], 6.0);
    EXPECT_NE(fault_of("G28 G1 X1 F5\n").find("G28: conflicts"), std::string::npos);
}

TEST(GcodeHome, GoesToTheStoredPositions) {
    GcodeOptions options;
    options.program.g28[kZ] = 50;
    options.program.g30 = {};
    options.program.g30[kX] = -12.5;
    options.program.g30[kA] = -90 * kTestRadPerDegree;
    EXPECT_EQ(end_of("G0 Z-9\nG91 G28 Z0\n", options)[kZ], 50);
    EXPECT_EQ(end_of("G0 X3\nG30 X4\n", options)[kX], -12.5);
    EXPECT_DOUBLE_EQ(end_of("G20 G30 A-1\n", options)[kA], -90 * kTestRadPerDegree);
    EXPECT_EQ(read("G21 G28 Z0\nG30 X4\n", options).read_as,
              (std::vector<std::string>{"G28 Z50", "G30 X-12.5"}));
    EXPECT_NE(fault_of("G0 X1\nG30 Y4\n", options)
                  .find("2: G30: its stored position is unknown; state program.g30.Y in the "
                        "machine file, or write G53 G0"),
              std::string::npos);
    EXPECT_NE(fault_of("G30\n", options).find("program.g30.Y"), std::string::npos);
}

// What the file of the machine leaves open is an error where it decides, and only there.
TEST(GcodeSettings, TheUnitOfTheStartIsStatedOrNotNeeded) {
    GcodeOptions options;
    options.program = {};
    const char* const kLacks = "no G20 or G21 before this length";
    EXPECT_NE(fault_of("G90\nG0 X2\nY3\n", options).find("2: X: no G20 or G21 before"),
              std::string::npos);
    EXPECT_NE(fault_of("G1 F200\nG21 X2\n", options).find("2: F: written before any G20 or G21"),
              std::string::npos);
    EXPECT_NE(fault_of("G64 P0.1\nG21\n", options).find(kLacks), std::string::npos);
    EXPECT_NE(fault_of("G10 L2 P1 Z4\nG21\n", options).find(kLacks), std::string::npos);
    EXPECT_EQ(faults_of(read("G0 X0 A-9\nG93 G1 A-3 F2\nG21\nG94 G1 X2 F9\n", options)), "");
    EXPECT_NE(fault_of("G20 F9\nG1 X1\n", options).find("2: F: written before any G20 or G21"),
              std::string::npos)
        << "F counts in the unit before its block";
    EXPECT_EQ(faults_of(read("G20 F9\nG0 X1\nF5 G1 X2\n", options)), "") << "never used";
    EXPECT_EQ(faults_of(read("F9\nG1 A-3\n", options)), "") << "degrees";
    options.program.starts_in_inch = true;
    EXPECT_DOUBLE_EQ(end_of("G0 X2\n", options)[kX], 50.8);
    EXPECT_EQ(read("G0 X2\nX3\n", options).read_as, std::vector<std::string>{"starts in inch"});
    EXPECT_TRUE(read("G21 G0 X2\n", options).read_as.empty());
}

TEST(GcodeSettings, AnEndlessAxisNeedsARuleWhereRulesDiffer) {
    GcodeOptions options;
    options.program.rotary = {};
    EXPECT_EQ(end_of("G0 C20\nC170\nG91 C900\n", options)[kC], 1070 * kTestRadPerDegree);
    const GcodeResult far = read("G0 C170\nC-20\nC170\n", options);
    EXPECT_NE(faults_of(far).find("2: C: the machine file has no program.rotary.C, which decides "
                                  "how far this endless axis turns"),
              std::string::npos);
    EXPECT_EQ(far.faults.size(), 1U) << "once";
    options.program.rotary.fill(RotaryRule::programmed);
    EXPECT_EQ(read("G0 C170\nC-20\n", options).read_as, std::vector<std::string>{"C programmed"});
}

TEST(GcodeSettings, StartUpCodeTolerancesAndNumbersFollowTheControl) {
    GcodeOptions options;
    options.program.starts_in_inch.reset();
    options.program.startup_code = "g20 g64 p.01";
    const GcodeResult inch = read("G0 X2\nX3\n", options);
    EXPECT_EQ(faults_of(inch), "") << "P counts in the unit of its own block";
    options.program.startup_code = "G20 G91";
    const Program program = program_of("G0 X1\nX1\n", options);
    EXPECT_DOUBLE_EQ(program.moves[1].target[kX], 50.8);
    EXPECT_EQ(read("M2\n", options).read_as, std::vector<std::string>{"start-up code G20 G91"});
    options.program.startup_code = "G90 M52 P1";
    EXPECT_EQ(read("M2\n", options).read_as,
              std::vector<std::string>{"start-up code G90 M52 P1 (without M52 P1)"});
    options.program.startup_code = "G87";
    EXPECT_NE(fault_of("M2\n", options).find("(program.startup_code of the machine file)"),
              std::string::npos);
    options = {};
    options.program.arc_tolerance_mm = 0.001;
    EXPECT_EQ(faults_of(read("G0 X10\nG3 X0 Y10.009 I-10 F9\n", options)), "");
    EXPECT_NE(fault_of("G0 X10\nG3 X0 Y10.011 I-10 F9\n", options).find("does not close"),
              std::string::npos);
    options.program.takes_program_numbers = false;
    EXPECT_NE(fault_of("O12\nM2\n", options).find("program.program_numbers: false"),
              std::string::npos);
}

TEST(GcodeArcs, CentreAndRadiusFormsGiveTheCircle) {
    // A quarter, counter-clockwise, about (0, 0).
    const Arc quarter = program_of("G0 X10\nG3 X0 Y10 I-10 F100\n").moves[1].arc;
    EXPECT_DOUBLE_EQ(quarter.center_first_mm, 0.0);
    EXPECT_DOUBLE_EQ(quarter.sweep_rad, kPi / 2);
    const Arc by_radius = program_of("G0 X10\nG3 X0 Y10 R10 F100\n").moves[1].arc;
    EXPECT_NEAR(by_radius.center_first_mm, 0.0, 1e-12);
    EXPECT_NEAR(by_radius.center_second_mm, 0.0, 1e-12);
    EXPECT_NEAR(by_radius.sweep_rad, kPi / 2, 1e-12);
    const Arc longer = program_of("G0 X10\nG3 X0 Y10 R-10 F100\n").moves[1].arc;
    EXPECT_NEAR(longer.center_first_mm, 10.0, 1e-12);
    EXPECT_NEAR(longer.sweep_rad, 3 * kPi / 2, 1e-12);
    const Arc clockwise = program_of("G0 X10\nG2 X0 Y10 I-10 F100\n").moves[1].arc;
    EXPECT_DOUBLE_EQ(clockwise.sweep_rad, -3 * kPi / 2);
    const Arc circle = program_of("G2 I5 P3 Z-3 F100\n").moves[0].arc;
    EXPECT_DOUBLE_EQ(circle.sweep_rad, -6 * kPi);
    const Arc absolute = program_of("G90.1\nG0 X10\nG3 X0 Y10 I0 J0 F100\n").moves[1].arc;
    EXPECT_DOUBLE_EQ(absolute.sweep_rad, kPi / 2);
    EXPECT_DOUBLE_EQ(program_of("G91.1 G0 X10\nG3 X0 Y10 I-10 J0 F9\n").moves[1].arc.sweep_rad,
                     kPi / 2);
}

TEST(GcodeArcs, PlanesTurnTheRightHandedWay) {
    const Arc zx = program_of("G18 G0 Z10\nG3 Z0 X10 K-10 F100\n").moves[1].arc;
    EXPECT_EQ(zx.first, kZ);
    EXPECT_EQ(zx.second, kX);
    EXPECT_DOUBLE_EQ(zx.sweep_rad, kPi / 2);
    const Arc yz = program_of("G19 G0 Y10\nG3 Y0 Z10 J-10 F100\n").moves[1].arc;
    EXPECT_EQ(yz.first, kY);
    EXPECT_EQ(yz.second, kZ);
    EXPECT_DOUBLE_EQ(yz.sweep_rad, kPi / 2);
}

TEST(GcodeArcs, TheDialectsToleranceHasTwoSides) {
    // 0.02828 mm or 0.002828 in, or 0.1 % of the radius from 28.3 mm on.
    EXPECT_EQ(faults_of(read("G0 X10\nG3 X0 Y10.0282 I-10 F9\n")), "");
    EXPECT_NE(fault_of("G0 X10\nG3 X0 Y10.0284 I-10 F9\n")
                  .find("G3: does not close: the radius at the end differs by 0.0284 mm, the "
                        "tolerance is 0.02828 mm; check I J K and the end"),
              std::string::npos);
    EXPECT_EQ(faults_of(read("G0 X40\nG3 X0 Y40.04 I-40 F9\n")), "") << "0.1 % of the radius";
    EXPECT_NE(fault_of("G0 X40\nG3 X0 Y40.0402 I-40 F9\n").find("tolerance is 0.04004 mm"),
              std::string::npos);
    EXPECT_EQ(faults_of(read("G20 G0 X1\nG3 X0 Y1.00282 I-1 F9\n")), "");
    EXPECT_NE(fault_of("G20 G0 X1\nG3 X0 Y1.00284 I-1 F9\n").find("does not close"),
              std::string::npos);
    // Three decimals of an inch, as CAM systems write: every end is off by 0.0007 in at most.
    EXPECT_EQ(faults_of(read("G20 G0 X.5 Y0 F9\nG3 X.354 Y.354 I-.5 J0\nX-.483 Y.129 I-.354 "
                             "J-.354\nX.5 Y0 I.483 J-.129\n")),
              "");
    EXPECT_EQ(faults_of(read("G3 I.0013 F9\n")), "");
    EXPECT_NE(fault_of("G3 I.00126 F9\n").find("not a circle"), std::string::npos);
    EXPECT_NE(fault_of("G3 X20 R9.9986 F9\n").find("too small to reach"), std::string::npos);
    EXPECT_EQ(faults_of(read("G3 X20 R9.9988 F9\n")), "");
    EXPECT_NE(fault_of("G2 R5 F9\n").find("a full circle has no R form"), std::string::npos);
    EXPECT_NE(fault_of("G2 X1 F9\n").find("G2: expected R, or the centre"), std::string::npos);
    EXPECT_NE(fault_of("G2 X1 R5 I1 F9\n").find("G2: found both R and a centre"),
              std::string::npos);
    EXPECT_NE(fault_of("G2 X1 I1 K1 F9\n").find("K is not in the plane"), std::string::npos);
    EXPECT_NE(fault_of("G2 X1 I.5 P1.5 F9\n")
                  .find("G2: P: found 1.5, expected an integer number of turns from 1"),
              std::string::npos);
    EXPECT_NE(fault_of("G2 I0 F9\n").find("not a circle"), std::string::npos);
}

// Two ways to one place give sums that differ by rounding: a full turn still, on either side of it.
TEST(GcodeArcs, EndsAtOnePlaceAreATurnHoweverTheyWereReached) {
    for (const char* const step : {"0.1", "-0.1", "0.3", "-0.7"}) {
        for (const char* const word : {"G2", "G3"}) {
            const std::string end = std::to_string(300 * std::stod(step));
            const Program program =
                program_of("G0 X0 Y0\nG91\no1 repeat [300]\nX" + std::string(step) +
                           "\no1 endrepeat\nG90\n" + word + " X" + end + " Y0 I0 J4 F100\n");
            EXPECT_NEAR(std::abs(program.moves.back().arc.sweep_rad), 2 * kPi, 1e-9)
                << step << " " << word;
        }
    }
    const Program by_machine = program_of(
        "G10 L2 P1 X-183.424 Y270.963\nG53 G0 X-107.067 Y233.22\n"
        "G3 X76.357 Y-37.743 I.092 J.039 F9\n");
    EXPECT_NEAR(by_machine.moves.back().arc.sweep_rad, 2 * kPi, 1e-9);
    // LinuxCNC's 1e-8 is of a mm or of an inch: between them, and on one ray, nothing is certain.
    EXPECT_NEAR(program_of("G3 X.000000009 I5 F9\n").moves[0].arc.sweep_rad, 2 * kPi, 1e-9);
    EXPECT_NE(fault_of("G3 Y-.000000011 I5 F9\n").find("rounding would decide"), std::string::npos);
    EXPECT_NE(fault_of("G3 Y.0000009 I5 F9\n").find("rounding would decide"), std::string::npos);
    EXPECT_LT(program_of("G3 Y-.0000011 I5 F9\n").moves[0].arc.sweep_rad, 1e-6);
    EXPECT_GT(program_of("G3 Y.0000011 I5 F9\n").moves[0].arc.sweep_rad, 6.28);
    EXPECT_NEAR(program_of("G3 X.003 I5 F9\n").moves[0].arc.sweep_rad, 2 * kPi, 1e-9)
        << "a spiral of one turn";
    EXPECT_NE(fault_of("G3 X.003 Y.0000005 I5 F9\n").find("rounding would decide"),
              std::string::npos);
}

TEST(GcodeFeed, AnAxisThatMovesByRoundingOnlyDoesNotMove) {
    const Program program =
        program_of("G20 G94 G10 L2 P1 X-3.424\nG53 G0 X-7.067\nG1 X-3.643 C90 F100\nX-3.643\n");
    ASSERT_EQ(program.moves.size(), 2U) << "the last line goes nowhere";
    EXPECT_EQ(program.moves[1].target[kX], program.moves[0].target[kX]);
    EXPECT_DOUBLE_EQ(program.moves[1].feed, 100) << "degrees: only C moves";
}

TEST(GcodeTravel, LeavingItNamesLineAxisValueAndLimit) {
    EXPECT_NE(fault_of("G0 X300\nX300.001\n")
                  .find("2: X: out of travel: goes to 300.001 mm, the upper end is 300 mm"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 A-110.01\n").find("goes to -110.01 deg, the lower end is -110 deg"),
              std::string::npos);
    EXPECT_EQ(faults_of(read("G0 X300 A-110 Z-400\nC36000\n")), "");
    // The end is inside, the arc's outermost point is not.
    EXPECT_NE(fault_of("G0 X295 Y-10\nG3 X295 Y10 R10 F9\n").find("X: out of travel: goes to 305"),
              std::string::npos);
    EXPECT_EQ(faults_of(read("G0 X290 Y-10\nG3 X290 Y10 R10 F9\n")), "");
}

// A zero that lies elsewhere takes every block out of travel: one cause, one line, and how far.
TEST(GcodeTravel, EachEndIsNamedOnceWithTheFarthest) {
    const GcodeResult high = read("G0 X301\nX303\nY1\nX302\nX0\nX-300.5\n");
    ASSERT_EQ(high.faults.size(), 2U) << "each end once; the move that keeps X says nothing";
    EXPECT_EQ(high.faults[0].line, 1U);
    EXPECT_NE(high.faults[0].message.find("goes to 301 mm, the upper end is 300 mm"),
              std::string::npos);
    EXPECT_NE(high.faults[0].message.find("; 2 more moves, the farthest in line 2 to 303 mm"),
              std::string::npos);
    EXPECT_EQ(high.faults[1].line, 6U);
    EXPECT_EQ(high.faults[1].message.find("more move"), std::string::npos);
    const GcodeResult low = read("G0 X-301\nX-302\nX-301.5\n");
    ASSERT_EQ(low.faults.size(), 1U);
    EXPECT_NE(low.faults[0].message.find("; 2 more moves, the farthest in line 2 to -302 mm"),
              std::string::npos);
}

TEST(GcodeModes, ConflictsInOneBlockAreErrors) {
    EXPECT_NE(fault_of("G0 G1 X1 F1\n").find("G1: conflicts with G0"), std::string::npos);
    EXPECT_NE(fault_of("G17 G18\n").find("G18: conflicts with G17"), std::string::npos);
    EXPECT_NE(fault_of("M3 M5\n").find("M5: conflicts with M3"), std::string::npos);
    EXPECT_NE(fault_of("M8 M9\n").find("M9: conflicts with M8"), std::string::npos);
    EXPECT_EQ(faults_of(read("M7 M8\n")), "") << "mist and flood may come together";
    EXPECT_NE(fault_of("G0 X1 X2\n").find("X2: a second X"), std::string::npos);
    EXPECT_NE(fault_of("X1\n").find("G80: axis words without a motion mode"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1\nG80 X2\n").find("G80: axis words"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 I3\n").find("I: no word of this block"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1\nX2 I3\n").find("only G2 and G3 use these"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1 H1\n").find("H: no word of this block takes it (G43"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 X1 L1\n").find("L: no word"), std::string::npos);
    EXPECT_NE(fault_of("G0 X1\nX2 L3\n").find("L: only canned cycles use it here"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 X1\nX2 P3\n").find("P: only arcs and canned cycles use it here"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 X1 D1\n").find("D: no word of this block takes it (G41"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 B1\n").find("B: the machine has no axis"), std::string::npos);
}

TEST(GcodePath, ExactModesAndToleranceReachTheMoves) {
    const Program program = program_of("G0 X1\nG61 X2\nG61.1 X3\nG64 X4\nG64 P0.05 Q0.01 X5\n");
    EXPECT_FALSE(program.moves[0].is_exact);
    EXPECT_TRUE(program.moves[1].is_exact);
    EXPECT_TRUE(program.moves[2].is_exact);
    EXPECT_FALSE(program.moves[3].is_exact);
    EXPECT_LT(program.moves[3].blend_mm, 0);
    EXPECT_EQ(program.moves[4].blend_mm, 0.05);
    EXPECT_DOUBLE_EQ(program_of("G20 G64 P0.1 G0 X1\n").moves[0].blend_mm, 2.54);
    EXPECT_NE(fault_of("G64 P-1\n").find("G64: P: found -1"), std::string::npos);
}

TEST(GcodeProgram, EndsAtM2M30OrTheSecondPercent) {
    EXPECT_EQ(program_of("G0 X1\nM2\nG0 X2\n").moves.size(), 1U);
    EXPECT_EQ(program_of("G0 X1\nM30\nG87\n").moves.size(), 1U);
    EXPECT_EQ(program_of("%\nG0 X1\n%\nG87\n").moves.size(), 1U);
    EXPECT_TRUE(read("G0 X1\nM2\n").notes.empty());
    EXPECT_EQ(read("G0 X1\n").notes.size(), 1U);
    EXPECT_EQ(read("").notes.size(), 1U);
}

TEST(GcodeProgram, AcceptedWordsMoveNothing) {
    EXPECT_TRUE(
        program_of("M3 S1000\nM4\nM5\nM7\nM8\nM9\nM48\nM49\nG40 G80 G97 G8\nG17\n").moves.empty());
    EXPECT_EQ(program_of("M0\nM1\n").moves.size(), 2U) << "both come to rest";
    EXPECT_NE(fault_of("S-1\n").find("S: found -1"), std::string::npos);
}

TEST(GcodeProgram, EveryRefusedWordSaysWhy) {
    std::size_t refused = 0;
    for (const GcodeWordRule& rule : gcode_word_rules()) {
        std::string word(1, rule.letter);
        word += std::to_string(rule.code / 10);
        word += rule.code % 10 == 0 ? "" : "." + std::to_string(rule.code % 10);
        if (rule.support != WordSupport::refused) {
            continue;
        }
        ++refused;
        const std::string wanted =
            "1: " + word + ": not supported (" + std::string(rule.reason) + ")\n";
        EXPECT_EQ(fault_of(word + "\n"), wanted);
    }
    EXPECT_GT(refused, 20U);
    EXPECT_EQ(fault_of("G77\n"), "1: G77: not supported (not a word of this dialect)\n");
    EXPECT_EQ(fault_of("G1.55\n"), "1: G1.55: not supported (not a word of this dialect)\n");
    EXPECT_EQ(fault_of("M-3\n"), "1: M-3: not supported (not a word of this dialect)\n");
}

TEST(GcodeProgram, FaultsAreCollectedUpToTheLimit) {
    std::string text;
    for (int i = 0; i < 25; ++i) {
        text += "G87\n";
    }
    EXPECT_EQ(read(text).faults.size(), 20U);
    EXPECT_TRUE(read(text).has_more_faults);
    EXPECT_EQ(read(text).faults.back().line, 20U);
    GcodeOptions options;
    options.faults_max = 100;
    EXPECT_EQ(read(text, options).faults.size(), 25U);
    EXPECT_FALSE(read(text, options).has_more_faults);
    EXPECT_EQ(faults_of(read("G1 F#<a> X1\nX2\n")).find("no feed"), std::string::npos)
        << "the refused block may have set it";
}

TEST(GcodeProgram, IgnoredWordsAreEchoedWithTheirLine) {
    GcodeOptions options;
    options.ignored = {"M428"};
    const GcodeResult result = read("M428 (on)\nG0 X1\n", options);
    EXPECT_TRUE(result.faults.empty());
    ASSERT_EQ(result.ignored.size(), 1U);
    EXPECT_EQ(result.ignored[0].line, 1U);
    EXPECT_EQ(result.ignored[0].text, "M428 (on)");
    EXPECT_EQ(read("M427\n", options).faults.size(), 1U) << "only what was named";
    options.ignored = {"M101", "M428"};
    EXPECT_EQ(program_of("M101 P1 Q2\nG0 X1\nM101 X2 P3\n", options).moves.size(), 2U);
    EXPECT_EQ(end_of("G0 M101 P1 X2\n", options)[kX], 2) << "P and Q are M101's";
    EXPECT_NE(fault_of("G0 M101 L1 X2\n", options).find("L: no word of this block"),
              std::string::npos);
    options.ignored = {"G0"};
    EXPECT_EQ(end_of("G0 X1\n", options)[kX], 1.0) << "a word of the dialect is never left out";
}

// Whatever the moves are: pauses, tool changes and switched kinematics fill the memory as well.
TEST(GcodeProgram, IsNotLongerThanItsLimit) {
    GcodeOptions options;
    options.moves_max = 4;
    for (const char* const body :
         {"G91 G0 X1", "G4 P1", "T1 M6", "M1", "M428\nM429", "G0\nG28 X1"}) {
        const std::string text =
            std::string("o1 repeat [3]\n").append(body).append("\n").append(body) +
            "\no1 endrepeat\n";
        const GcodeResult result = read(text, options);
        EXPECT_EQ(result.program.moves.size(), 4U) << body;
        EXPECT_NE(
            faults_of(result).find(
                "program: longer than 4 moves; split it, or raise the limit with --max-moves N"),
            std::string::npos)
            << body;
    }
    options.moves_max = 6;
    EXPECT_EQ(faults_of(read("o1 repeat [3]\nG4 P1\nG4 P1\no1 endrepeat\n", options)), "");
}

TEST(GcodeRotary, EndlessAxesGoTheProgrammedWayOrTheShortOne) {
    const auto turns_to = [](const char* text, bool is_short) {
        GcodeOptions options;
        options.program.rotary.fill(is_short ? RotaryRule::shortest : RotaryRule::programmed);
        return end_of(text, options)[kC] / kTestRadPerDegree;
    };
    EXPECT_NEAR(turns_to("G0 C350\nC10\n", false), 10, 1e-9);
    EXPECT_NEAR(turns_to("G0 C100\nC200\nC350\nC10\n", true), 370, 1e-9);
    EXPECT_NEAR(turns_to("G0 C350\n", true), -10, 1e-9);
    EXPECT_NEAR(turns_to("G0 C10\nG91 C350\n", true), 360, 1e-9) << "steps are as they are";
    GcodeOptions options;
    options.program.rotary.fill(RotaryRule::shortest);
    EXPECT_EQ(program_of("G0 C10\nC370\nC-350\n", options).moves.size(), 1U) << "it is there";
    EXPECT_NEAR(end_of("G0 A-100\n", options)[kA] / kTestRadPerDegree, -100, 1e-9)
        << "an axis with ends goes between them";
    EXPECT_NE(fault_of("G0 C90\nC-90\n", options).find("C: half a turn: "), std::string::npos);
    options.work_offsets[0][kC] = 90 * kTestRadPerDegree;
    EXPECT_NEAR(end_of("G0 C180\n", options)[kC] / kTestRadPerDegree, -90, 1e-9);
}

// As rs274 has them with [AXIS_C] WRAPPED_ROTARY = 1: the oracle compares random ones.
TEST(GcodeRotary, WrappedAxesTurnUpwardsOrWithAMinusDownwards) {
    GcodeOptions options;
    options.program.rotary.fill(RotaryRule::wrapped);
    const auto turns = [&](const char* text) {
        return end_of(text, options)[kC] / kTestRadPerDegree;
    };
    EXPECT_NEAR(turns("G0 C20\n"), 20, 1e-9);
    EXPECT_NEAR(turns("G0 C20\nC340\nC20\n"), 380, 1e-9);
    EXPECT_NEAR(turns("G0 C20\nC340\nC20\nC-340\n"), 340, 1e-9);
    EXPECT_NEAR(turns("G0 C-120\n"), -240, 1e-9);
    EXPECT_NEAR(turns("G0 C20\nG91 C-50\nG90 C20\n"), 20, 1e-9) << "steps are as they are";
    EXPECT_NEAR(turns("G0 C-90\nG10 L2 P1 C30\nG0 C10\n"), 40, 1e-9);
    EXPECT_NEAR(turns("G10 L2 P1 C30\nG0 C10\nG53 G0 C-20\n"), -280, 1e-9);
    EXPECT_NEAR(turns("G0 C100\nG28 C110\n"), 360, 1e-9);
    EXPECT_EQ(program_of("G0 C10.1\nC10.1\nC-10.1\n", options).moves.size(), 1U);
    EXPECT_NE(fault_of("G0 C360\n", options).find("C: found 360, expected an angle between"),
              std::string::npos);
    EXPECT_NE(fault_of("G0 C10\nG91 C.1\nG90 C10.1\n", options).find("rounding would decide"),
              std::string::npos);
    EXPECT_NEAR(end_of("G0 A-90\n", options)[kA] / kTestRadPerDegree, -90, 1e-9)
        << "an axis with ends";
    EXPECT_EQ(read("G0 C5\n", options).read_as, std::vector<std::string>{"C wrapped"});
}

TEST(GcodeProgram, BlockDeleteIsTheUsersChoice) {
    GcodeOptions options;
    EXPECT_NE(fault_of("G0 X1\n/X2\n").find("2: /: block delete"), std::string::npos);
    options.block_delete = BlockDelete::skip;
    EXPECT_EQ(end_of("G0 X1\n/X2\n", options)[kX], 1.0);
    options.block_delete = BlockDelete::run;
    EXPECT_EQ(end_of("G0 X1\n/X2\n", options)[kX], 2.0);
}

TEST(GcodeStart, IsZeroInsideTravel) {
    Machine machine = motion_test_machine();
    machine.axes[kZ].min = -400;
    machine.axes[kZ].max = -20;
    const AxisPositions start = default_start(machine);
    EXPECT_EQ(start[kX], 0.0);
    EXPECT_EQ(start[kZ], -20.0);
    AxisPositions stated = start;
    EXPECT_EQ(read_axis_words("x10 C 90", machine, stated), "");
    EXPECT_EQ(stated[kX], 10.0);
    EXPECT_DOUBLE_EQ(stated[kC], 90 * kTestRadPerDegree);
    EXPECT_EQ(stated[kZ], -20.0);
    EXPECT_NE(read_axis_words("Q1", machine, stated), "");
    EXPECT_NE(read_axis_words("R90", machine, stated), "");
    GcodeOptions options;
    EXPECT_EQ(
        read_axis_words("X9 R90", machine, options.work_offsets[0], &options.rotations_rad[0]), "");
    EXPECT_DOUBLE_EQ(end_of("G0 X1\n", options)[kY], 1) << "R turns X and Y";
    EXPECT_NE(read_axis_words("X", machine, stated), "");
}

}  // namespace
}  // namespace axg::test
