// SPDX-License-Identifier: Apache-2.0
// axguard check and axguard init, driven as a person would: a folder of meshes, a machine file, its
// check.
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

TEST_F(Commands, InitWritesAFileThatChecksAtOnce) {
    write_meshes();
    const Outcome init = axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "inch"});
    EXPECT_EQ(init.exit_code, kExitClean) << init.err;
    const Outcome check = axguard({"check", path("m.yaml"), "--json=" + path("m.json")});
    EXPECT_EQ(check.exit_code, kExitClean) << check.err;
    const auto document = Json::parse(read(path("m.json")));
    EXPECT_EQ(document["bodies"].size(), 8U);
    EXPECT_EQ(document["tools"].size(), 1U);
    EXPECT_EQ(document["pairs"].size() + document["exclusions"].size(), 8U * 7U / 2U);
    EXPECT_NEAR(document["bodies"][0]["mesh"]["size_mm"][0].get<double>(), 25.4, 1e-5);
    std::string chain;
    for (const auto& body : document["bodies"]) {
        const auto parent = body["parent"];
        const auto axis = body["axis"];
        chain += (parent.is_null() ? std::string{"-"} : parent.get<std::string>()) + '>' +
                 body["name"].get<std::string>() +
                 (axis.is_null() ? "" : ":" + axis.get<std::string>()) + ' ';
    }
    EXPECT_EQ(chain,
              "->base ->saddle:Y saddle>table:X table>a_axis:A a_axis>c:C ->headstock:Z "
              "headstock>cutter ->lamp__left_ ");
}

// A tool drawn standing on its tip would stick into the spindle.
TEST_F(Commands, InitPlacesAToolBelowTheSpindle) {
    for (const auto& [low_mm, high_mm, words] :
         {std::tuple{0.0F, 90.0F,
                     "length_mm: 90  # GUESS: spindle nose to tip\n    at_mm: [0, 0, -90]"},
          {-80.0F, 10.0F, "length_mm: 80  # GUESS: spindle nose to tip\n    at_mm: [0, 0, 0]"}}) {
        write_meshes();
        fs::remove(path("m.yaml"));  // init writes over nothing
        write_mesh("cutter.stl", box({-5, -5, low_mm}, {5, 5, high_mm}));
        ASSERT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
                  kExitClean);
        EXPECT_TRUE(has(read(path("m.yaml")), words)) << read(path("m.yaml"));
        EXPECT_EQ(axguard({"check", path("m.yaml")}).exit_code, kExitClean);
    }
}

// Without a tool the file loads; it shows what to add, and check lists that nothing is in the
// spindle.
TEST_F(Commands, AMachineWithoutAToolIsListed) {
    write_meshes();
    ASSERT_EQ(axguard({"init", path("meshes"), "-o", path("t.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    EXPECT_FALSE(has(read(path("t.yaml")), "# A tool needs its pairs here"));
    EXPECT_FALSE(has(axguard({"check", path("t.yaml")}).out, "  no tool: "));
    fs::remove(path("meshes/cutter.stl"));
    ASSERT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    const std::string text = read(path("m.yaml"));
    EXPECT_TRUE(has(text,
                    "#   - {a: cutter, b: [(every body but the spindle's)], margin_mm: 1}\n"
                    "# and below exclusions:\n"
                    "#   - {a: (the spindle's body), b: cutter, reason: the spindle holds the "
                    "tool}\npairs:\n"))
        << text;
    const Outcome check = axguard({"check", path("m.yaml")});
    EXPECT_EQ(check.exit_code, kExitClean) << check.err;
    EXPECT_TRUE(has(check.out, "\n  no tool: the spindle is checked empty. ")) << check.out;
}

TEST_F(Commands, AnEmptyListIsPrinted) {
    write_meshes();
    write_mesh("base.stl", box({500, 0, 0}, {600, 100, 100}));  // as large as the travel wants
    ASSERT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    std::string text = read(path("m.yaml"));
    for (const std::string mark : {"GUESS", "REVIEW: "}) {
        for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark)) {
            text.erase(at, mark.size());
        }
    }
    for (const char* names : {"{a: saddle, b: table,", "{a: saddle, b: lamp__left_,",
                              "{a: headstock, b: lamp__left_,"}) {  // these part
        text = with(text, names, std::string(names) + " because: small,");
    }
    std::ofstream(path("m.yaml")) << text;
    const Outcome check = axguard({"check", path("m.yaml")});
    EXPECT_EQ(check.exit_code, kExitClean) << check.err;
    EXPECT_TRUE(has(check.out, "\nto review: 0\n")) << check.out;
}

TEST_F(Commands, EveryGuessIsMarkedAndListed) {
    write_meshes();
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    const std::string text = read(path("m.yaml"));
    std::size_t marks = 0;
    for (std::size_t at = text.find("# GUESS"); at != std::string::npos;
         at = text.find("# GUESS", at + 1)) {
        ++marks;
    }
    std::size_t reviews = 0;
    for (std::size_t at = text.find("REVIEW:"); at != std::string::npos;
         at = text.find("REVIEW:", at + 1)) {
        ++reviews;
    }
    EXPECT_GT(marks, 20U);
    EXPECT_GT(reviews, 4U);
    const Outcome check = axguard({"check", path("m.yaml")});
    EXPECT_TRUE(has(check.out, "to review: " + std::to_string(marks + reviews + 1) + '\n'))
        << check.out;
    EXPECT_TRUE(has(check.out,
                    "  the largest body is 1 mm long, the longest travel 400 mm. Check the unit of "
                    "the meshes.\n"))
        << check.out;
}

// Errors of positions that the file does not state are guesses of the program; init writes them.
TEST_F(Commands, ErrorsThatAreNotStatedAreListedAsGuesses) {
    write_meshes();
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    std::string text = read(path("m.yaml"));
    EXPECT_TRUE(has(text, "position_error_mm: 0.001, following_error_mm: 0}  # GUESS")) << text;
    EXPECT_TRUE(has(text, "position_error_deg: 0.0005, following_error_deg: 0}  # GUESS")) << text;
    EXPECT_TRUE(has(text, "\nguard:\n  stop_reversal: jerk_limited  # GUESS")) << text;
    EXPECT_TRUE(has(text, "\ncan:\n  permit: 2  # ")) << text;
    EXPECT_TRUE(has(text, "\n  hashes: required  # ")) << text;
    const std::string whole = axguard({"check", path("m.yaml")}).out;
    EXPECT_FALSE(has(whole, "_error_... is not stated")) << whole;
    text = with(text, ", position_error_mm: 0.001, following_error_mm: 0}", "}");
    text = with(text, "jerk_mm_s3: 20000", "jerk_mm_s3: none");
    std::ofstream(path("m.yaml")) << text;
    const std::string out = axguard({"check", path("m.yaml")}).out;
    EXPECT_TRUE(has(out,
                    "axes: position_error_... is not stated for X: 0.001 mm or 0.0005 degrees is "
                    "assumed. State it"))
        << out;
    EXPECT_TRUE(has(out, "axes: following_error_... is not stated for X: 0 is assumed")) << out;
    EXPECT_TRUE(has(out, "axes: jerk_...: none for X: guard.board_reaction_ms has to include"))
        << out;
}

TEST_F(Commands, InitNeverGuessesTheUnitAndShowsWhatEachWouldGive) {
    write_meshes();
    const Outcome run = axguard({"init", path("meshes"), "-o", path("m.yaml")});
    EXPECT_EQ(run.exit_code, kExitUsage);
    EXPECT_TRUE(has(run.err, "--unit: missing required option")) << run.err;
    EXPECT_TRUE(has(run.err, "--unit inch  25.4 x 25.4 x 25.4")) << run.err;
    EXPECT_TRUE(has(run.err, "--unit m     1000 x 1000 x 1000")) << run.err;
    EXPECT_FALSE(fs::exists(path("m.yaml")));
}

TEST_F(Commands, InitOverwritesOnlyWhenToldTo) {
    write_meshes();
    std::ofstream(path("m.yaml")) << "mine";
    const std::vector<std::string> words{"init",         path("meshes"), "-o",
                                         path("m.yaml"), "--unit",       "mm"};
    const Outcome run = axguard(words);
    EXPECT_EQ(run.exit_code, kExitInput);
    EXPECT_TRUE(has(run.err, "--force")) << run.err;
    EXPECT_EQ(read(path("m.yaml")), "mine");
    std::vector<std::string> forced = words;
    forced.push_back("--force");
    EXPECT_EQ(axguard(forced).exit_code, kExitClean);
    EXPECT_TRUE(has(read(path("m.yaml")), "version: 1"));
}

// An open mesh is accepted by name; one turned inside out is not accepted at all.
TEST_F(Commands, InitAllowsOnlyWhatAMeshNeeds) {
    write_meshes();
    std::vector<Triangle> open = tetrahedron();
    open.pop_back();
    write_mesh("table.stl", open);
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    const std::string text = read(path("m.yaml"));
    EXPECT_EQ(text.find("allow_open"), text.rfind("allow_open"));
    EXPECT_TRUE(has(text, "\"meshes/table.stl\", unit: mm, size_mm: [1, 1, 1], allow_open: true"));
    EXPECT_FALSE(has(text, "allow_self_intersection"));
    EXPECT_EQ(axguard({"check", path("m.yaml")}).exit_code, kExitClean);

    std::vector<Triangle> inverted = tetrahedron();
    for (Triangle& triangle : inverted) {
        std::swap(triangle.b, triangle.c);
    }
    write_mesh("table.stl", inverted);
    const Outcome run = axguard({"init", path("meshes"), "-o", path("n.yaml"), "--unit", "mm"});
    EXPECT_EQ(run.exit_code, kExitInput);
    EXPECT_TRUE(has(run.err, "table.stl") && has(run.err, "inside out")) << run.err;
    EXPECT_FALSE(fs::exists(path("n.yaml")));
}

TEST_F(Commands, InitNamesTheMeshRootWhenTheMeshesLieElsewhere) {
    write_meshes();
    fs::create_directory(path("here"));
    const Outcome run =
        axguard({"init", path("meshes"), "-o", path("here/m.yaml"), "--unit", "mm"});
    EXPECT_EQ(run.exit_code, kExitClean);
    EXPECT_TRUE(has(run.out, "--mesh-root " + path("meshes"))) << run.out;
    EXPECT_EQ(axguard({"check", path("here/m.yaml")}).exit_code, kExitInput);
    EXPECT_EQ(axguard({"check", path("here/m.yaml"), "--mesh-root", path("meshes")}).exit_code,
              kExitClean);
}

// init shows every size; a body in inch among others in mm is listed by check, and printed by every
// other command that reads the machine.
TEST_F(Commands, ABodyInInchIsNamedUntilItIsAccepted) {
    for (const auto& [name, side] :
         {std::pair{"base.stl", 400.0F}, {"x.stl", 300.0F}, {"y.stl", 280.0F}, {"c.stl", 10.0F}}) {
        write_mesh(name, box({0, 0, 0}, {side, side, side / 2}));
    }
    const Outcome init = axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"});
    ASSERT_EQ(init.exit_code, kExitClean) << init.err;
    EXPECT_TRUE(has(init.out, "\n  x                    300 x 300 x 150 mm\n")) << init.out;
    const std::string doubt =
        "bodies.c.mesh: meshes/c.stl: 10 mm, 30 times smaller than the median body (300 mm); in "
        "inch 254 mm.";
    EXPECT_TRUE(has(init.out, "to review: " + doubt + " Correct unit and size_mm.\n")) << init.out;
    const Outcome check = axguard({"check", path("m.yaml")});
    EXPECT_EQ(check.exit_code, kExitClean) << check.err;
    EXPECT_TRUE(has(check.out, doubt + " Correct unit, or set size_is_right: true.\n"))
        << check.out;
    EXPECT_EQ(check.err, "");
    const auto printed = [this] {
        testing::internal::CaptureStderr();
        LoadedMachine loaded;
        EXPECT_EQ(load(MachineOptions{.file = path("m.yaml"), .mesh_root = ""}, loaded),
                  kExitClean);
        std::fflush(stderr);
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_TRUE(has(printed(), "to review: " + path("m.yaml"))) << printed();
    EXPECT_TRUE(has(printed(), doubt));
    const std::string accepted =
        with(read(path("m.yaml")), "  - name: c\n", "  - name: c\n    size_is_right: true\n");
    std::ofstream(path("m.yaml")) << accepted;
    EXPECT_EQ(printed(), "");
    EXPECT_FALSE(has(axguard({"check", path("m.yaml")}).out, "times smaller"));
}

TEST_F(Commands, InitRefusesAFolderItCannotUse) {
    EXPECT_EQ(axguard({"init", path("none"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitInput);
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitInput);
    write_mesh("one.stl");
    const Outcome one = axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"});
    EXPECT_EQ(one.exit_code, kExitInput);
    EXPECT_TRUE(has(one.err, "found 1 STL files, expected 2 to 32")) << one.err;
    for (int i = 0; i < 32; ++i) {
        write_mesh("more" + std::to_string(i) + ".stl");
    }
    EXPECT_TRUE(has(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).err,
                    "found 33 STL files"));
    fs::remove(path("meshes/more0.stl"));
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    EXPECT_EQ(axguard({"check", path("m.yaml")}).exit_code, kExitClean);
    EXPECT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "ft"}).exit_code,
              kExitUsage);
}

TEST_F(Commands, CheckPrintsAllFaultsAndExitsWithThree) {
    std::ofstream(path("m.yaml")) << with(with(kSmallMachine, "name: small", "nane: small"),
                                          "margin_mm: 0.5", "margin_mm: -1");
    const Outcome run = axguard({"check", path("m.yaml"), "--json"});
    EXPECT_EQ(run.exit_code, kExitInput);
    EXPECT_TRUE(has(run.out, "\"exit_code\": 3,\n  \"fault\": \"")) << run.out;
    EXPECT_TRUE(has(run.err, path("m.yaml") + ":2: nane: unknown key")) << run.err;
    EXPECT_TRUE(has(run.err, path("m.yaml") +
                                 ":23: pairs[0].margin_mm: invalid value (found \"-1\", expected "
                                 "a number from 0 to 1000)."))
        << run.err;
    EXPECT_TRUE(has(run.err, "2 faults. Correct the file and run axguard check ")) << run.err;
}

TEST_F(Commands, JsonHasStdoutForItself) {
    write_meshes();
    axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"});
    const Outcome run =
        axguard({"check", "--json", path("m.yaml")});  // the file is no value of --json
    EXPECT_EQ(run.exit_code, kExitClean);
    const auto document = Json::parse(run.out);
    EXPECT_EQ(document["file"], path("m.yaml"));
    EXPECT_EQ(document["configuration_sha256"].get<std::string>().size(), 64U);
    EXPECT_TRUE(has(run.err, "pairs checked"));
    const Outcome unwritable = axguard({"check", "--json=" + path("no/m.json"), path("m.yaml")});
    EXPECT_EQ(unwritable.exit_code, kExitUsage);
    EXPECT_TRUE(has(unwritable.err, "No such file or directory")) << unwritable.err;
}

// 200 mm/s against 50 mm/s2 is 400 mm, the whole travel; a little faster no longer fits into it.
TEST_F(Commands, CheckWarnsOfAnAxisThatCannotStopWithinItsTravel) {
    write_meshes();
    axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"});
    const std::string text =
        with(read(path("m.yaml")), "stopping_mm_s2: 800", "stopping_mm_s2: 50");
    std::ofstream(path("n.yaml")) << with(text, "speed_mm_min: 10000", "speed_mm_min: 12000");
    EXPECT_FALSE(has(axguard({"check", path("n.yaml")}).out, "stopping from full speed takes"));
    std::ofstream(path("n.yaml")) << with(text, "speed_mm_min: 10000", "speed_mm_min: 12001");
    EXPECT_TRUE(
        has(axguard({"check", path("n.yaml")}).out,
            "axis X: stopping from full speed takes 400.1 mm, more than its travel of 400 mm"));
}

TEST_F(Commands, HelpStartsWithAnExample) {
    for (const char* command : {"check", "init"}) {
        const Outcome run = axguard({command, "--help"});
        EXPECT_EQ(run.exit_code, kExitClean);
        EXPECT_TRUE(run.out.starts_with(std::string("Example:\n  axguard ") + command)) << run.out;
    }
}

TEST_F(Commands, TheHashChangesWithEachValueAndWithNothingElse) {
    write_meshes();
    axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"});
    const auto hash_of = [this](const std::string& text) {
        std::ofstream(path("n.yaml")) << text;
        LoadedMachine loaded;
        EXPECT_TRUE(load(path("n.yaml"), "", loaded, stderr)) << text;
        return configuration_hash(loaded.machine, loaded.meshes);
    };
    const std::string text = read(path("m.yaml"));
    const std::string hash = hash_of(text);
    EXPECT_EQ(hash_of("# a comment\n" + text), hash);
    EXPECT_EQ(hash_of(with_can(text, "  sample_us: 1000\n")), hash);  // the default, spelled out
    EXPECT_EQ(hash_of(with(text, "[-200, 200]", "[-2.0e2, 200.0]")), hash);
    EXPECT_NE(hash_of(with(text, "[-200, 200]", "[-200, 200.0000001]")), hash);
    EXPECT_NE(hash_of(with(text, "margin_mm: 0}", "margin_mm: 1.0e-9}")), hash);
    EXPECT_NE(hash_of(with_can(text, "  sample_us: 1001\n  stale_after_us: 3000\n")), hash);
    EXPECT_NE(hash_of(text + "deadline_us: 501\n"), hash);
    std::vector<Triangle> other = tetrahedron();
    for (Triangle& triangle : other) {
        for (Vec3f* vertex : {&triangle.a, &triangle.b, &triangle.c}) {
            vertex->x = vertex->x == 1 ? std::nextafterf(1, 2) : vertex->x;
        }
    }
    write_mesh("table.stl", other);
    EXPECT_NE(hash_of(text), hash);
}

// The page marks an axis whose direction or pivot is still a guess.
TEST_F(Commands, AGuessedAxisIsKnownUntilItsMarkGoes) {
    write_meshes();
    ASSERT_EQ(axguard({"init", path("meshes"), "-o", path("m.yaml"), "--unit", "mm"}).exit_code,
              kExitClean);
    const auto guessed = [&] {
        LoadedMachine loaded;
        EXPECT_TRUE(load(path("m.yaml"), "", loaded, stderr));
        std::string names;
        const std::vector<bool> found = guessed_joints(loaded);
        for (std::size_t i = 0; i < found.size(); ++i) {
            names += found[i] ? loaded.machine.bodies[i].name + ' ' : "";
        }
        return names;
    };
    EXPECT_EQ(guessed(), "saddle table a_axis c headstock ");
    std::string text = read(path("m.yaml"));
    const std::size_t at = text.find("  - name: a_axis"), end = text.find("  - name: c\n");
    std::string part = text.substr(at, end - at);
    for (const char* key : {"direction:", "pivot_mm:"}) {
        const std::size_t mark = part.find("# GUESS", part.find(key));
        part.erase(mark, part.find('\n', mark) - mark);
        std::ofstream(path("m.yaml")) << text.substr(0, at) + part + text.substr(end);
        EXPECT_EQ(has(guessed(), "a_axis"), std::string(key) == "direction:");
    }
}

}  // namespace
}  // namespace axg::test
