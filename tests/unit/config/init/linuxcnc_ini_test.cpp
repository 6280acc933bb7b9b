// SPDX-License-Identifier: Apache-2.0
// What is read of a LinuxCNC INI file: units, which joint an axis is, the tighter of two limits,
// and what every wrong value says. The file written from it: machine_commands_test.cpp.
#include "config/init/linuxcnc_ini.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "config/init/write_machine.hpp"

namespace axg {
namespace {

IniAxes read_ini(std::string_view text, const std::string& name,
                 const std::map<std::string, std::string>& files = {}) {
    return read_linuxcnc_ini(text, name, [&files](const std::string& file, std::size_t) {
        const auto found = files.find(file);
        return found == files.end() ? NamedFile{"", "no such file", "a file beside the INI file"}
                                    : NamedFile{found->second, "", ""};
    });
}

constexpr const char* kMill = R"([EMC]
MACHINE = mill
# MAX_LIMIT = 7
[TRAJ]
COORDINATES = X Y Z A C
LINEAR_UNITS = inch
ANGULAR_UNITS = degree
PLANNER_TYPE = 1
[AXIS_X]
MIN_LIMIT = -12.5
MAX_LIMIT = +12.5
MAX_VELOCITY = 10
MAX_ACCELERATION = 30.0
[JOINT_0]
TYPE = LINEAR
MIN_LIMIT = -13
MAX_LIMIT = 12.0 # tighter
MAX_VELOCITY = 20
MAX_ACCELERATION = 20
[axis_z]
min_limit = -18
max_limit = .5
[JOINT_2]
MAX_VELOCITY = 5
MAX_JERK = 100
[AXIS_A]
MIN_LIMIT = -100
MAX_LIMIT = 100
MAX_VELOCITY = 360
MAX_VELOCITY = 1
[AXIS_C]
WRAPPED_ROTARY = 1
MIN_LIMIT = -1e99
MAX_LIMIT = 1e99
MAX_ACCELERATION = 1200
)";

std::string test_mill_without_wrapping() {
    std::string text = kMill;
    return text.erase(text.find("WRAPPED_ROTARY"), std::string("WRAPPED_ROTARY = 1\n").size());
}

TEST(LinuxcncIni, AxesHaveTheTighterLimitsInMmAndDegrees) {
    const IniAxes ini = read_ini(kMill, "mill.ini");
    ASSERT_TRUE(ini.faults.empty()) << ini.faults[0];
    ASSERT_EQ(ini.axes.size(), 5U);
    const IniAxis& x = ini.axes[0];
    EXPECT_EQ(x.name, "X");
    EXPECT_FALSE(x.is_rotary);
    EXPECT_DOUBLE_EQ(x.min.value(), -12.5 * 25.4);
    EXPECT_DOUBLE_EQ(x.max.value(), 12.0 * 25.4) << "the joint's is tighter";
    EXPECT_DOUBLE_EQ(x.speed.value(), 10 * 25.4);
    EXPECT_DOUBLE_EQ(x.acceleration.value(), 20 * 25.4);
    const IniAxis& y = ini.axes[1];
    EXPECT_FALSE(y.min || y.max || y.speed || y.acceleration) << "nothing is stated";
    EXPECT_FALSE(y.is_unlimited) << "a linear axis ends somewhere";
    EXPECT_DOUBLE_EQ(ini.axes[2].max.value(), 0.5 * 25.4);
    EXPECT_DOUBLE_EQ(ini.axes[2].speed.value(), 5 * 25.4);
    EXPECT_DOUBLE_EQ(ini.axes[3].speed.value(), 360) << "degrees in either unit; the first counts";
    EXPECT_FALSE(ini.axes[3].is_unlimited);
    EXPECT_TRUE(ini.axes[4].is_unlimited);
    EXPECT_FALSE(ini.axes[4].min || ini.axes[4].max) << "1e99 is LinuxCNC's word for none";
}

// Two joints of one axis: it may move as the faster one, and a stop is that of the slower one.
TEST(LinuxcncIni, AGantryTakesBothItsJoints) {
    const IniAxes ini = read_ini(
        "[TRAJ]\nCOORDINATES=XYYZ\nLINEAR_UNITS=mm\n[AXIS_Y]\nMAX_VELOCITY=8.5\n"
        "[JOINT_1]\nMAX_VELOCITY=9\nMAX_ACCELERATION=50\nMIN_LIMIT=-9\nMAX_LIMIT=100\n"
        "[JOINT_2]\nMAX_VELOCITY=8\nMAX_ACCELERATION=60\nMIN_LIMIT=-8\nMAX_LIMIT=101\n"
        "[JOINT_3]\nMAX_VELOCITY=7\nMAX_ACCELERATION=40\n",
        "g.ini");
    ASSERT_EQ(ini.axes.size(), 3U);
    const IniAxis &y = ini.axes[1], &z = ini.axes[2];
    EXPECT_TRUE(y.is_gantry);
    EXPECT_EQ(y.speed, 8.5) << "the axis has less than the faster joint";
    EXPECT_EQ(y.acceleration, 60.0);
    EXPECT_EQ(y.braking, 50.0);
    EXPECT_EQ(y.min, -8.0) << "it ends where its first joint does";
    EXPECT_EQ(y.max, 100.0);
    EXPECT_FALSE(z.is_gantry);
    EXPECT_EQ(z.speed, 7.0);
    EXPECT_EQ(z.braking, 40.0);
}

constexpr const char* kHead = "[TRAJ]\nCOORDINATES = XZ\nLINEAR_UNITS = mm\n";

// trivkins without coordinates= counts its joints through XYZABCUVW, whatever axes there are.
TEST(LinuxcncIni, TheKinematicsSayWhichJointIsWhichAxis) {
    const std::string joints = "[JOINT_1]\nMAX_VELOCITY=9\n[JOINT_2]\nMAX_VELOCITY=8\n";
    const auto speed_of_z = [&joints](const std::string& kinematics) {
        return read_ini(kHead + kinematics + joints, "l.ini").axes.at(1).speed;
    };
    EXPECT_EQ(speed_of_z(""), 9.0) << "nothing stated: the order of COORDINATES";
    EXPECT_EQ(speed_of_z("[KINS]\nKINEMATICS = trivkins\n"), 8.0);
    EXPECT_EQ(speed_of_z("[KINS]\nKINEMATICS = trivkins coordinates=xz kinstype=BOTH\n"), 9.0);
    EXPECT_EQ(speed_of_z("[KINS]\nKINEMATICS = xyzac-trt-kins sparm=identityfirst # x\n"), 8.0);
}

// With a tilted table the tool's place and the slide's are two things: [AXIS_Z] limits the first.
TEST(LinuxcncIni, OnlyTrivialKinematicsTakeTheLimitsOfTheTip) {
    const std::string limits = "[AXIS_Z]\nMAX_LIMIT=5\n[JOINT_2]\nMAX_LIMIT=7\n";
    const auto axis_z = [&limits](const std::string& kinematics) {
        return read_ini(kHead + ("[KINS]\nKINEMATICS=" + kinematics + "\n") + limits, "t.ini")
            .axes.at(1);
    };
    EXPECT_EQ(axis_z("trivkins").max, 5.0);
    EXPECT_FALSE(axis_z("trivkins").follows_tip);
    for (const char* const kinematics : {"xyzac-trt-kins", "xyzbc-trt-kins"}) {
        EXPECT_EQ(axis_z(kinematics).max, 7.0);
        EXPECT_TRUE(axis_z(kinematics).follows_tip);
    }
}

TEST(LinuxcncIni, AnUnknownLetterOfCoordinatesIsNamed) {
    const IniAxes ini = read_ini("[TRAJ]\nCOORDINATES = XYQ\nLINEAR_UNITS = mm\n", "q.ini");
    ASSERT_EQ(ini.faults.size(), 1U);
    EXPECT_EQ(ini.faults[0],
              "q.ini:2: [TRAJ] COORDINATES: invalid value (found \"XYQ\", expected letters of "
              "X Y Z A B C U V W only). Remove \"Q\".");
}

// Tilted heads: their joints are slides and turntables, by number through XYZABC or XYZABCUVW.
TEST(LinuxcncIni, HeadsThatTiltAreReadByTheirJoints) {
    const auto read = [](const std::string& kinematics) {
        return read_ini("[TRAJ]\nCOORDINATES = XYZABCW\nLINEAR_UNITS = mm\n[KINS]\nKINEMATICS = " +
                            kinematics + "\n[JOINT_4]\nMAX_LIMIT = 5\n[JOINT_8]\nMAX_LIMIT = 7\n",
                        "h.ini");
    };
    const IniAxes max = read("maxkins");
    ASSERT_EQ(max.axes.size(), 7U);
    EXPECT_EQ(max.axes[4].max, 5.0);
    EXPECT_EQ(max.axes[6].max, 7.0);
    EXPECT_TRUE(max.axes[0].follows_tip);
    EXPECT_TRUE(max.program_doubts.empty());
    const IniAxes nutating = read("xyzbca_trsrn");
    EXPECT_EQ(nutating.axes.at(4).max, 5.0);
    ASSERT_EQ(nutating.program_doubts.size(), 2U);
    EXPECT_EQ(nutating.program_doubts[0],
              "h.ini:5: [KINS] KINEMATICS = xyzbca_trsrn: A is tilted by the pin nut-angle; state "
              "its direction as three numbers");
    EXPECT_NE(nutating.program_doubts[1].find("M429 switches"), std::string::npos);
    EXPECT_EQ(read("xyzac-trt-kins sparm=identityfirst").program_doubts.size(), 1U);
}

TEST(LinuxcncIni, OtherKinematicsAreRefusedWithTheirReason) {
    const auto says = [](const std::string& kinematics, const char* reason) {
        const IniAxes ini =
            read_ini(std::string(kHead) + "[KINS]\nKINEMATICS = " + kinematics + "\n", "k.ini");
        return ini.faults.size() == 1 && ini.faults[0].find(reason) != std::string::npos;
    };
    EXPECT_TRUE(says("tripodkins", "). Its struts move one platform together"));
    EXPECT_TRUE(says("scarakins coordinates=xyzcab", "). Its joints are those of an arm"));
    EXPECT_TRUE(says("corexykins", "). Both motors move X as well as Y"));
    EXPECT_TRUE(says("millturn", "). M428 and M429 exchange the joints"));
    EXPECT_TRUE(says("mykins", "). What its joints are is not known here"));
}

TEST(LinuxcncIni, JointsThatAreNoSlidesAreRefused) {
    const IniAxes ini = read_ini(std::string(kHead) + "[KINS]\nKINEMATICS = pumakins\n", "p.ini");
    ASSERT_EQ(ini.faults.size(), 1U);
    EXPECT_TRUE(
        ini.faults[0].starts_with("p.ini:5: [KINS] KINEMATICS: invalid value (found "
                                  "\"pumakins\", expected trivkins,"))
        << ini.faults[0];
    EXPECT_TRUE(ini.axes.empty());
}

TEST(LinuxcncIni, ARotaryAxisOfManyTurnsDoesNotEnd) {
    const auto is_unlimited = [](const std::string& limits) {
        return read_ini("[TRAJ]\nCOORDINATES=C\nLINEAR_UNITS=mm\n[AXIS_C]\n" + limits, "c.ini")
            .axes.at(0)
            .is_unlimited;
    };
    EXPECT_TRUE(is_unlimited("MIN_LIMIT=-36000\nMAX_LIMIT=36000\n"));
    EXPECT_TRUE(is_unlimited("MIN_LIMIT=-99999\n"));
    EXPECT_FALSE(is_unlimited("MIN_LIMIT=-3599\nMAX_LIMIT=36000\n"));
    EXPECT_FALSE(is_unlimited("MIN_LIMIT=-100\nMAX_LIMIT=50\n"));
}

// Samples write 9999 for a linear axis that nobody measured: a guess then, and marked as one.
TEST(LinuxcncIni, ALinearLimitBeyondTheFramesIsNone) {
    const IniAxes ini = read_ini(
        "[TRAJ]\nCOORDINATES=XY\nLINEAR_UNITS=inch\n[AXIS_X]\n"
        "MAX_LIMIT=331\nMIN_LIMIT=-330\n",
        "w.ini");
    EXPECT_FALSE(ini.axes.at(0).max);
    EXPECT_DOUBLE_EQ(ini.axes.at(0).min.value(), -330 * 25.4);
}

TEST(LinuxcncIni, UnitsAreNamesOrNumbers) {
    const auto axis = [](const std::string& units) {
        return read_ini("[TRAJ]\nCOORDINATES=XA\n" + units +
                            "\n[AXIS_X]\nMAX_LIMIT=3\n[AXIS_A]\nMAX_LIMIT=100\n",
                        "u.ini")
            .axes;
    };
    EXPECT_DOUBLE_EQ(axis("LINEAR_UNITS = metric ; mm").at(0).max.value(), 3);
    EXPECT_DOUBLE_EQ(axis("LINEAR_UNITS = 1.0").at(0).max.value(), 3);
    EXPECT_DOUBLE_EQ(axis("LINEAR_UNITS = 0.5").at(0).max.value(), 6) << "units in a mm";
    EXPECT_DOUBLE_EQ(axis("LINEAR_UNITS = in").at(0).max.value(), 76.2);
    EXPECT_DOUBLE_EQ(axis("LINEAR_UNITS = mm\nANGULAR_UNITS = 1.0").at(1).max.value(), 100);
}

TEST(LinuxcncIni, AnAngleInAnotherUnitIsRefusedByItsKey) {
    for (const std::string unit : {"rad", "grad", "0.9"}) {
        const IniAxes machine =
            read_ini("[TRAJ]\nCOORDINATES=XA\nLINEAR_UNITS=mm\nANGULAR_UNITS=" + unit +
                         "\n[AXIS_A]\nMIN_LIMIT=-99999\nMAX_LIMIT=3\n",
                     "u.ini");
        ASSERT_EQ(machine.faults.size(), 1U) << unit << ": and no limit is blamed";
        EXPECT_EQ(machine.faults[0],
                  "u.ini:4: [TRAJ] ANGULAR_UNITS: invalid value (found \"" + unit +
                      "\", expected degree: axguard_stop takes no other unit. Convert speeds and "
                      "limits of the rotary axes, too).");
    }
}

TEST(LinuxcncIni, IncludedFilesAreReadWhereTheyStand) {
    const std::map<std::string, std::string> files{
        {"units.inc", "[TRAJ]\nLINEAR_UNITS = inch\n#INCLUDE axes.inc\n"},
        {"axes.inc", "COORDINATES = X\n[AXIS_X]\nMAX_LIMIT = two\n"},
        {"round.inc", "#INCLUDE round.inc\n"}};
    const IniAxes wrong = read_ini("#INCLUDE units.inc\n", "i.ini", files);
    ASSERT_EQ(wrong.faults.size(), 1U);
    EXPECT_TRUE(wrong.faults[0].starts_with("axes.inc:3: [AXIS_X] MAX_LIMIT:")) << wrong.faults[0];
    const IniAxes first = read_ini("[AXIS_X]\nMAX_LIMIT=2\n#INCLUDE units.inc\n", "i.ini", files);
    ASSERT_TRUE(first.faults.empty()) << first.faults[0];
    EXPECT_DOUBLE_EQ(first.axes.at(0).max.value(), 50.8) << "the first value of a name counts";
    const IniAxes missing = read_ini(std::string(kHead) + "#INCLUDE none.inc\n", "i.ini", files);
    ASSERT_EQ(missing.faults.size(), 1U);
    EXPECT_EQ(missing.faults[0],
              "i.ini:4: #INCLUDE \"none.inc\": invalid file (found no such file, expected a file "
              "beside the INI file).");
    const IniAxes endless = read_ini(std::string(kHead) + "#INCLUDE round.inc\n", "i.ini", files);
    ASSERT_EQ(endless.faults.size(), 1U);
    EXPECT_NE(endless.faults[0].find("too many files"), std::string::npos) << endless.faults[0];
}

// The thread in which samples are latched; to the nanosecond, as LinuxCNC takes it.
TEST(LinuxcncIni, TheServoPeriodIsThatOfTheBoard) {
    const std::string head = "[TRAJ]\nCOORDINATES = XZ\nLINEAR_UNITS = mm\n[EMCMOT]\n";
    EXPECT_EQ(read_ini(head, "m.ini").servo_period_ns, std::nullopt);
    EXPECT_EQ(read_ini(head + "SERVO_PERIOD = 976562 # 1024 Hz\n", "m.ini").servo_period_ns,
              976'562);
    for (const char* wrong : {"1 ms", "0", "49999", "100000001", "1000000.5"}) {
        const IniAxes ini = read_ini(head + "SERVO_PERIOD = " + wrong + "\n", "m.ini");
        ASSERT_EQ(ini.faults.size(), 1U) << wrong;
        EXPECT_EQ(ini.faults[0], std::string("m.ini:5: [EMCMOT] SERVO_PERIOD: invalid value (found "
                                             "\"") +
                                     wrong +
                                     "\", expected 50000 to 100000000, whole nanoseconds).");
    }
}

TEST(LinuxcncIni, WhatDecidesAProgramHasItsLine) {
    const std::string text = std::string(kMill) +
                             "[AXIS_C]\n[RS274NGC]\nPARAMETER_FILE = mill.var\n"
                             "RS274NGC_STARTUP_CODE = G20 G64 P0.001\n"
                             "CENTER_ARC_RADIUS_TOLERANCE_INCH = 0.0002\n"
                             "DISABLE_FANUC_STYLE_SUB = 1\n";
    const IniAxes ini = read_ini(text, "mill.ini",
                                 {{"mill.var", "5161\t1.000000\n5163\t0.5\n5166\t90\n5183\t-2\n"}});
    ASSERT_TRUE(ini.faults.empty()) << ini.faults[0];
    std::string all;
    for (const IniSetting& one : ini.program) {
        all += one.key + (one.letter == 0 ? "" : std::string(".") + one.letter) + ' ' + one.value +
               ' ' + one.source + '\n';
    }
    EXPECT_EQ(all,
              "start_unit inch mill.ini:6: [TRAJ] LINEAR_UNITS = inch\n"
              "rotary.C wrapped mill.ini:32: [AXIS_C] WRAPPED_ROTARY = 1\n"
              "startup_code \"G20 G64 P0.001\" mill.ini:39: [RS274NGC] RS274NGC_STARTUP_CODE = "
              "G20 G64 P0.001\n"
              "arc_tolerance_inch 0.0002 mill.ini:40: [RS274NGC] "
              "CENTER_ARC_RADIUS_TOLERANCE_INCH = 0.0002\n"
              "program_numbers false mill.ini:41: [RS274NGC] DISABLE_FANUC_STYLE_SUB = 1\n"
              "g28.X 25.4 mill.ini:38: [RS274NGC] PARAMETER_FILE = mill.var, parameters 5161 on\n"
              "g28.Z 12.7 mill.ini:38: [RS274NGC] PARAMETER_FILE = mill.var, parameters 5161 on\n"
              "g28.C 90 mill.ini:38: [RS274NGC] PARAMETER_FILE = mill.var, parameters 5161 on\n"
              "g30.Z -50.8 mill.ini:38: [RS274NGC] PARAMETER_FILE = mill.var, parameters 5181 "
              "on\n");
    // Without the file there are no stored positions, and without a word of it no wrapped axis.
    const IniAxes none = read_ini(test_mill_without_wrapping(), "mill.ini");
    ASSERT_EQ(none.program.size(), 2U);
    EXPECT_EQ(none.program[1].key, "rotary");
    EXPECT_EQ(none.program[1].letter, 'C');
    EXPECT_EQ(none.program[1].value, "programmed");
}

/// The value of a key that the mill's INI makes with more lines, or "none".
std::string program_value(const std::string& more, const std::string& key) {
    const IniAxes ini = read_ini(std::string(kMill) + more, "mill.ini", {});
    for (const IniSetting& one : ini.program) {
        if (one.key == key) {
            return one.value;
        }
    }
    return "none";
}

// As the interpreter reads them: rs274 2.9 refuses a tolerance above its own, and says so.
TEST(LinuxcncIni, SwitchesAndTolerancesAreThoseOfTheInterpreter) {
    for (const char* const on : {"1", "2", "-1", "01"}) {
        std::string text = kMill;
        text.replace(text.find("ROTARY = 1"), 10, std::string("ROTARY = ") + on);
        EXPECT_EQ(read_ini(text, "m.ini", {}).program[1].value, "wrapped") << on;
    }
    for (const char* const off : {"0", "TRUE", "1.0", "0x1"}) {
        std::string text = kMill;
        text.replace(text.find("ROTARY = 1"), 10, std::string("ROTARY = ") + off);
        EXPECT_EQ(read_ini(text, "m.ini", {}).program[1].value, "programmed") << off;
    }
    const std::string key = "[RS274NGC]\nCENTER_ARC_RADIUS_TOLERANCE_MM = ";
    EXPECT_EQ(program_value(key + "0.02\n", "arc_tolerance_mm"), "0.02");
    for (const char* const wrong : {"0.0283", "0.5", "0", "abc"}) {
        EXPECT_EQ(program_value(key + wrong + "\n", "arc_tolerance_mm"), "none") << wrong;
    }
    EXPECT_EQ(program_value("[RS274NGC]\nRS274NGC_STARTUP_CODE =\n", "startup_code"), "none");
}

TEST(LinuxcncIni, WhatNoKeyCanStateIsADoubt) {
    const auto doubts = [](const std::string& more,
                           const std::map<std::string, std::string>& files) {
        std::string out;
        for (const std::string& doubt :
             read_ini(std::string(kMill) + more, "mill.ini", files).program_doubts) {
            out += doubt + '\n';
        }
        return out;
    };
    const std::string file = "[RS274NGC]\nPARAMETER_FILE = mill.var\n";
    EXPECT_EQ(doubts(file, {{"mill.var", "5210\t0\n5220\t1\n"}}), "");
    EXPECT_NE(doubts(file, {{"mill.var", "5210\t1\n5220\t2\n"}}).find("5220: programs start in"),
              std::string::npos);
    EXPECT_NE(doubts(file, {{"mill.var", "5210\t1\n5220\t2\n"}}).find("5210: G92 is on"),
              std::string::npos);
    EXPECT_NE(doubts(file, {}).find("mill.var: cannot be read"), std::string::npos);
    EXPECT_NE(doubts("[RS274NGC]\nREMAP = M6 ngc=change\n", {}).find("the word itself"),
              std::string::npos);
    EXPECT_NE(doubts("[RS274NGC]\nCENTER_ARC_RADIUS_TOLERANCE_MM = 0.5\n", {}).find("its own"),
              std::string::npos);
}

TEST(LinuxcncIni, WhatIsWrongSaysWhere) {
    const auto faults = [](const std::string& text) {
        std::string out;
        for (const std::string& fault : read_ini(text, "m.ini").faults) {
            out += fault + "\n";
        }
        return out;
    };
    EXPECT_EQ(faults(""),
              "m.ini: [TRAJ] LINEAR_UNITS: missing required key (expected mm or "
              "inch).\nm.ini: [TRAJ] COORDINATES: missing required key (expected the "
              "letters of the axes, such as XYZAC).\n");
    const std::string head = "[TRAJ]\nCOORDINATES = XZ\nLINEAR_UNITS = mm\n[AXIS_X]\n";
    EXPECT_EQ(faults(head), "");
    EXPECT_EQ(faults(head + "MAX_LIMIT = ten\n"),
              "m.ini:5: [AXIS_X] MAX_LIMIT: invalid value (found \"ten\", expected a number).\n");
    EXPECT_EQ(
        faults(head + "MAX_LIMIT = nan\nMAX_VELOCITY = 0\nMAX_ACCELERATION = -1\n"),
        "m.ini:5: [AXIS_X] MAX_LIMIT: invalid value (found \"nan\", expected a number).\nm.ini:6: "
        "[AXIS_X] MAX_VELOCITY: invalid value (found \"0\", expected a number above 0).\nm.ini:7: "
        "[AXIS_X] MAX_ACCELERATION: invalid value (found \"-1\", expected a number above 0).\n");
    EXPECT_EQ(faults(head + "MIN_LIMIT = 5\nMAX_LIMIT = 5\n"),
              "m.ini:6: [AXIS_X] MAX_LIMIT: invalid value (found \"5\", expected more than "
              "MIN_LIMIT).\n");
    EXPECT_EQ(faults(head + "MAX_LIMIT = 5\n[JOINT_0]\nMIN_LIMIT = 6\n"),
              "m.ini:7: [JOINT_0] MIN_LIMIT: invalid value (found \"6\", expected less than "
              "MAX_LIMIT).\n");
    EXPECT_EQ(
        faults("[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = furlong\n"),
        "m.ini:3: [TRAJ] LINEAR_UNITS: invalid value (found \"furlong\", expected mm or inch).\n");
    EXPECT_EQ(
        faults("[TRAJ]\nCOORDINATES = XA\nLINEAR_UNITS = mm\n[JOINT_1]\nTYPE = LINEAR\n"),
        "m.ini:5: [JOINT_1] TYPE: invalid value (found \"LINEAR\", expected ANGULAR: programs "
        "count A in degrees. Give a slide the letter U, V or W, and a second motor the letter "
        "of its axis, as in coordinates=XYYZ).\n");
    EXPECT_EQ(faults("[TRAJ]\nCOORDINATES = XA\nLINEAR_UNITS = mm\n[AXIS_A]\nMIN_LIMIT = -5\n"
                     "MAX_LIMIT = 99999\n"),
              "m.ini:6: [AXIS_A] MAX_LIMIT: invalid value (found \"99999\", expected an end within "
              "838 degrees, or none on either side within ten turns: an endless axis).\n");
    EXPECT_EQ(faults("[TRAJ]\nCOORDINATES = XA\nLINEAR_UNITS = mm\n[JOINT_1]\nTYPE = ANGULAR\n"
                     "MIN_LIMIT = -99999\nMAX_LIMIT = 99999\n"),
              "");
    EXPECT_EQ(faults("[TRAJ\nCOORDINATES = X\n[\n]\n= 3\n").empty(), false) << "and no crash";
}

// Four classical frames have two slots each, and one of them is the status.
TEST(LinuxcncIni, MoreThanSevenAxesTakeTheFormatWithOneFrame) {
    std::vector<RoleGuess> roles;
    for (const char* const axis : {"X", "Y", "Z", "A", "B", "C", "U"}) {
        roles.push_back({});
        roles.back().name = roles.back().axis = axis;
        roles.back().file = kNoFile;
    }
    EXPECT_EQ(machine_file_text("m", {}, roles).find("format: fd"), std::string::npos);
    roles.push_back(roles.back());
    EXPECT_EQ(machine_file_text("m", {}, roles).find("format: fd"), std::string::npos)
        << "two bodies on one axis";
    roles.back().axis = "V";
    EXPECT_NE(
        machine_file_text("m", {}, roles).find("  format: fd  # one frame has room for 8 axes\n"),
        std::string::npos);
}

// axguard_stop takes the second joint with coordinates=.
TEST(LinuxcncIni, AGantryIsWrittenWithItsSkew) {
    const IniAxes ini = read_ini(
        "[TRAJ]\nCOORDINATES=XYY\nLINEAR_UNITS=mm\n[JOINT_1]\nMAX_ACCELERATION=50\n"
        "[JOINT_2]\nMAX_ACCELERATION=60\n",
        "g.ini");
    std::vector<RoleGuess> roles(2);
    roles[0].name = roles[0].axis = "X";
    roles[1].name = roles[1].axis = "Y";
    roles[0].file = roles[1].file = kNoFile;
    const std::string text = machine_file_text("m", {}, roles, ini);
    const std::size_t y = text.find("  Y: {");
    ASSERT_NE(y, std::string::npos);
    const std::string line = text.substr(y, text.find('\n', y) - y);
    EXPECT_NE(line.find("acceleration_mm_s2: 120, "), std::string::npos) << line;
    EXPECT_NE(line.find("stopping_mm_s2: 50, skew_mm: 0.1, "), std::string::npos) << line;
    EXPECT_NE(line.find(", skew"), std::string::npos) << line;
    EXPECT_NE(text.find("# skew_mm: "), std::string::npos);
    EXPECT_EQ(text.substr(text.find("  X: {"), 200).find("skew"), std::string::npos);
}

}  // namespace
}  // namespace axg
