// SPDX-License-Identifier: Apache-2.0
// What axguard init takes from an INI file, a tool table, a URDF, a tree of parts and the travel.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/compiled/compiled_machine.hpp"
#include "config/machine/effective_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/check/check_report.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_commands.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Commands, InitTakesTheAxesOfAnIniFile) {
    write_meshes();
    std::ofstream(path("meshes/mill.ini"))
        << "[TRAJ]\nCOORDINATES = XYZACW\nLINEAR_UNITS = inch\n"
           "[AXIS_X]\nMIN_LIMIT = -12.5\nMAX_LIMIT = 12\nMAX_VELOCITY = 10\n"
           "MAX_ACCELERATION = 20\n[AXIS_A]\nMIN_LIMIT = -100\nMAX_LIMIT = 95\n"
           "MAX_VELOCITY = 360\n[AXIS_C]\nWRAPPED_ROTARY = 1\n"
           "[EMCMOT]\nSERVO_PERIOD = 976562\n";
    const Outcome init =
        axguard({"init", path("meshes/mill.ini"), "-o", path("m.yaml"), "--unit", "mm"});
    EXPECT_EQ(init.exit_code, kExitClean) << init.err;
    Machine machine;
    const auto faults = load_machine(path("m.yaml"), machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    ASSERT_EQ(machine.axes.size(), 5U);
    EXPECT_DOUBLE_EQ(machine.axes[0].min, -317.5);
    EXPECT_DOUBLE_EQ(machine.axes[0].max, 304.8);
    EXPECT_DOUBLE_EQ(machine.axes[0].speed_max, 254);
    // LinuxCNC exceeds it in blends: twice that is declared. It brakes by MAX_ACCELERATION.
    EXPECT_DOUBLE_EQ(machine.axes[0].acceleration_max, 2 * 508);
    EXPECT_DOUBLE_EQ(machine.axes[0].stopping_min, 508);
    EXPECT_NEAR(machine.axes[3].max, 95 * kPi / 180, 1e-12);
    EXPECT_NEAR(machine.axes[3].speed_max, 2 * kPi, 1e-12);
    EXPECT_TRUE(machine.axes[4].unlimited);
    const std::string text = read(path("m.yaml"));
    EXPECT_TRUE(has(text, "so acceleration_... is twice\n# MAX_ACCELERATION")) << text;
    EXPECT_TRUE(
        has(text,
            "# GUESS: stopping as the control brakes (half of it: 63.5 mm more from full speed), "
            "position_error, following_error, acceleration\n"))
        << "X: the INI file says the rest\n"
        << text;
    EXPECT_TRUE(has(
        text, "# GUESS: stopping, position_error, following_error, travel, speed, acceleration\n"))
        << "Y\n"
        << text;
    EXPECT_EQ(machine.can.sample_us, 977U);
    EXPECT_TRUE(has(text,
                    "  sample_us: 977  # SERVO_PERIOD is 976562 ns; 0.045 % of the 1 % that "
                    "the period may be off\n"))
        << text;
    const std::string ini = path("meshes/mill.ini");
    EXPECT_TRUE(has(text, "program:\n  start_unit: inch  # " + ini +
                              ":3: [TRAJ] LINEAR_UNITS = inch\n  rotary: {C: wrapped}  # " + ini +
                              ":14: [AXIS_C] WRAPPED_ROTARY = 1\n"))
        << text;
    EXPECT_EQ(machine.axes[0].jerk_max, kNoJerkLimit) << "LinuxCNC limits no jerk";
    EXPECT_TRUE(has(text, "# W of the INI file: give it to the body that it moves\n")) << text;
    // Meshes elsewhere, and what is wrong with either.
    fs::rename(path("meshes/mill.ini"), path("mill.ini"));
    const Outcome beside =
        axguard({"init", path("mill.ini"), "-o", path("n.yaml"), "--unit", "mm"});
    EXPECT_EQ(beside.exit_code, kExitInput);
    EXPECT_TRUE(has(beside.err, "pass their folder with --meshes DIR")) << beside.err;
    EXPECT_EQ(axguard({"init", path("mill.ini"), "-o", path("n.yaml"), "--unit", "mm", "--meshes",
                       path("meshes")})
                  .exit_code,
              kExitClean);
    std::ofstream(path("bad.ini")) << "[TRAJ]\nLINEAR_UNITS = mm\n";
    const Outcome bad = axguard({"init", path("bad.ini"), "-o", path("b.yaml"), "--unit", "mm"});
    EXPECT_EQ(bad.exit_code, kExitInput);
    EXPECT_TRUE(has(bad.err,
                    "bad.ini: [TRAJ] COORDINATES: missing required key (expected the letters of "
                    "the axes, such as XYZAC)."))
        << bad.err;
}

TEST_F(Commands, ToolsOfTheTableAreWrittenAndCompared) {
    for (const char* name : {"table.stl", "head.stl"}) {
        write_mesh(name);
    }
    std::ofstream(path("meshes/mill.ini")) << "[TRAJ]\nCOORDINATES = XZ\nLINEAR_UNITS = inch\n"
                                              "[EMCIO]\nTOOL_TABLE = mill.tbl\n";
    std::ofstream(path("meshes/mill.tbl")) << "T3 Z2 D.5 ; mill\nT4 Z0\n";
    const Outcome init =
        axguard({"init", path("meshes/mill.ini"), "-o", path("m.yaml"), "--unit", "inch"});
    EXPECT_EQ(init.exit_code, kExitClean) << init.err;
    const auto check = [this](const std::string& table) {
        std::ofstream(path("t.tbl")) << table;
        return axguard({"check", path("m.yaml"), "--tool-table", path("t.tbl")});
    };
    EXPECT_EQ(check("T3 Z2 D.5").exit_code, kExitClean);
    EXPECT_FALSE(has(check("T3 Z2 D.5").out, "t.tbl:1: ")) << "start_unit of the INI is inch";
    const Outcome differs = check("T3 Z2.1\n");
    EXPECT_EQ(differs.exit_code, kExitClean) << "listed, not judged";
    EXPECT_TRUE(has(differs.out, "t.tbl:1: tool 3: length 2.1 inch (53.34 mm), and 50.8 mm in "))
        << differs.out;
    fs::remove(path("t.tbl"));
    EXPECT_EQ(axguard({"check", path("m.yaml"), "--tool-table", path("t.tbl")}).exit_code,
              kExitInput);
}

// LinuxCNC's lathes number their tools so; a classical frame has one byte for the number.
TEST_F(Commands, AToolBeyondOneByteTakesTheFormatThatHasRoom) {
    write_meshes();
    std::ofstream(path("meshes/mill.ini")) << "[TRAJ]\nCOORDINATES = XZ\nLINEAR_UNITS = mm\n"
                                              "[EMCIO]\nTOOL_TABLE = mill.tbl\n";
    std::ofstream(path("meshes/mill.tbl")) << "T255 Z20\nT10001 Z30\n";
    const Outcome init =
        axguard({"init", path("meshes/mill.ini"), "-o", path("m.yaml"), "--unit", "mm"});
    EXPECT_EQ(init.exit_code, kExitClean) << init.err;
    EXPECT_TRUE(has(read(path("m.yaml")), "format: fd  # classical has no room for tool 10001\n"));
}

TEST_F(Commands, InitReadsAUrdfFile) {
    write_mesh("base.stl");
    std::ofstream(path("m.urdf"))
        << "<robot><link name='base'><visual><geometry>\n"
           "<mesh filename='package://m/base.stl' scale='.0254 .0254 "
           ".0254'/></geometry></visual></link>"
           "<link name='table'><visual><origin xyz='0 0 .5'/><geometry><box size='.1 .1 .02'/>"
           "</geometry></visual></link><joint name='x_joint' type='prismatic'>"
           "<parent link='base'/><child link='table'/><limit lower='-.1' upper='.1'/></joint>"
           "</robot>";
    const std::vector<std::string> words{"init", "--urdf", path("m.urdf"), "-o", path("m.yaml")};
    const Outcome elsewhere = axguard(words);
    EXPECT_EQ(elsewhere.exit_code, kExitInput);
    EXPECT_TRUE(has(elsewhere.err, "m.urdf:2: link base.mesh.filename: ")) << elsewhere.err;
    EXPECT_TRUE(has(elsewhere.err, "Pass it with --meshes DIR.")) << elsewhere.err;
    auto with = [&words](std::vector<std::string> more) {
        more.insert(more.begin(), words.begin(), words.end());
        return axguard(more);
    };
    const Outcome init = with({"--meshes", path("meshes")});
    EXPECT_EQ(init.exit_code, kExitClean) << init.err;
    Machine machine;
    const auto faults = load_machine(path("m.yaml"), machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    ASSERT_EQ(machine.bodies.size(), 2U);
    EXPECT_EQ(machine.bodies[1].mesh.shapes.at(0).at.t[2], 490) << "a box begins at its bottom";
    EXPECT_EQ(machine.axes.at(0).max, 100);
    EXPECT_EQ(axguard({"check", path("m.yaml")}).exit_code, kExitClean);
    EXPECT_EQ(with({"--unit", "mm"}).exit_code, kExitUsage);
    EXPECT_EQ(axguard({"init", "--urdf", path("m.urdf"), "--meshes", path("meshes"), "--force",
                       "-o", path("meshes/base.stl")})
                  .exit_code,
              kExitUsage)
        << "a mesh is no output";
    EXPECT_EQ(with({path("meshes")}).exit_code, kExitUsage);
    EXPECT_EQ(axguard({"init", "-o", path("n.yaml")}).exit_code, kExitUsage);
}

// What a tree names under any key is a body; what it does not name is printed; a tree that makes no
// machine is refused by its own lines, not by those of a file that nobody can open.
TEST_F(Commands, InitWritesEachPartOfATree) {
    for (const char* name : {"bed.stl", "ram.stl", "lamp.stl"}) {
        write_mesh(name);
    }
    const std::string bed =
        "root:\n  id: bed\n  model: meshes/bed.stl\n  type: table\n"
        "  position: [0, 0, 0, 0, 0, 0]\n  axis: null\n";
    const std::string ram =
        "  ram:\n    id: ram\n    model: meshes/ram.stl\n    type: linear\n"
        "    position: [0, 0, 0, 0, 0, 0]\n    axis: \"-z\"\n";
    const std::vector<std::string> words{"init",   path("meshes"), "-o",     path("m.yaml"),
                                         "--unit", "mm",           "--tree", path("t.yml")};
    std::ofstream(path("t.yml")) << bed << ram;
    const Outcome run = axguard(words);
    EXPECT_EQ(run.exit_code, kExitClean) << run.err;
    EXPECT_EQ(run.err, "lamp.stl: left out: not in " + path("t.yml") + '\n');
    EXPECT_TRUE(has(read(path("m.yaml")), "    axis: Z\n    direction: [0, 0, -1]\n"));
    EXPECT_EQ(axguard({"check", path("m.yaml")}).exit_code, kExitClean);
    fs::remove(path("m.yaml"));
    std::ofstream(path("t.yml")) << bed;
    const Outcome one = axguard(words);
    EXPECT_EQ(one.exit_code, kExitInput);
    EXPECT_TRUE(has(one.err, path("t.yml") + ":1: root: invalid value (found 1 part")) << one.err;
    EXPECT_FALSE(has(one.err, "left out") || has(one.err, "m.yaml") || has(one.err, "Rename"))
        << one.err;
    EXPECT_FALSE(fs::exists(path("m.yaml")));
}

// Every pair is checked but those that overlap everywhere, whatever carries what.
TEST_F(Commands, InitWithAllPairsExcludesPermanentContactOnly) {
    write_mesh("base.stl", box({-400, -400, -20}, {400, 400, 0}));
    write_mesh("x.stl", box({-30, -30, 0}, {30, 30, 20}));         // on the base
    write_mesh("z.stl", box({-30, -30, 420}, {30, 30, 500}));      // above both
    write_mesh("y.stl", box({100, -300, 230}, {120, -280, 250}));  // on nothing
    const std::vector<std::string> words{"init",   path("meshes"), "-o",     path("m.yaml"),
                                         "--unit", "mm",           "--force"};
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--pairs", "all"});
    ASSERT_EQ(axguard(words).exit_code, kExitClean);
    Machine likely, whole;
    ASSERT_TRUE(load_machine(path("m.yaml"), likely).empty());
    const Outcome init = axguard(all);
    ASSERT_EQ(init.exit_code, kExitClean) << init.err;
    ASSERT_TRUE(load_machine(path("m.yaml"), whole).empty());
    EXPECT_GT(likely.exclusions.size(), 1U);
    ASSERT_EQ(whole.exclusions.size(), 1U) << read(path("m.yaml"));
    EXPECT_EQ(whole.bodies[whole.exclusions[0].a].name, "base");
    EXPECT_EQ(whole.bodies[whole.exclusions[0].b].name, "x");
    EXPECT_EQ(whole.exclusions[0].reason, "REVIEW: in contact at every place of this travel");
    EXPECT_EQ(whole.pairs.size(), 5U);
}

}  // namespace
}  // namespace axg::test
