// SPDX-License-Identifier: Apache-2.0
// axguard drive as a user runs it: exit codes, reports, the table, faults, and what it refuses.
// ctest-labels: long
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

// Up and down in free air: no part of the paper's machine is near another.
constexpr const char* kFreeAir = "G0 Z-20\nG0 Z0 X30\nG0 C90\nM2\n";

class DriveCommand : public testing::Test {
  protected:
    int drive(const std::string& program, const std::string& options) {
        return shop.run("drive '" + kPaperMachine + "' '" + program + "' " + options);
    }
    Json document() { return Json::parse(shop.out); }

    Workshop shop;
    std::string free_air = shop.write("free.ngc", kFreeAir);
};

TEST_F(DriveCommand, AProgramInFreeAirRunsToItsEnd) {
    for (const std::string mode : {"contact", "stoppable"}) {
        ASSERT_EQ(drive(free_air, "--json --mode " + mode), 0) << shop.err;
        const Json result = document();
        EXPECT_EQ(result["state"], "finished");
        EXPECT_EQ(result["mode"], mode);
        EXPECT_NEAR(result["rest"]["X_mm"].get<double>(), 30, 1e-9);
        EXPECT_NEAR(result["rest"]["C_deg"].get<double>(), 90, 1e-9);
        EXPECT_GT(result["permits"].get<int>(), 500);
        EXPECT_FALSE(result.contains("guard_stop"));
    }
}

TEST_F(DriveCommand, TheDemoIsStoppedAndSaysWhereAndHowFarFromContact) {
    ASSERT_EQ(drive(kDemoProgram, "--json"), 10) << shop.err;
    const Json result = document();
    EXPECT_EQ(result["state"], "stopped");
    EXPECT_EQ(result["guard_stop"]["reason"], "predicted");
    ASSERT_FALSE(result["pairs"].empty());
    for (const Json& pair : result["pairs"]) {
        EXPECT_FALSE(pair["touching"].get<bool>()) << pair;
    }
    ASSERT_FALSE(result["escapes"].empty());
    for (const Json& way : result["escapes"]) {
        EXPECT_GT(way["clearance_mm"], result["pairs"][0]["clearance_mm"]) << way;
    }
    EXPECT_TRUE(
        std::any_of(result["escapes"].begin(), result["escapes"].end(),
                    [](const Json& way) { return way["axis"] == "Z" && way["direction"] == "+"; }))
        << "the cutter goes up";
    // The block whose target lies beyond the stop.
    EXPECT_EQ(result["program_block"].get<std::string>().rfind("G1 X0.0000 Y106.2623 ", 0), 0U)
        << result["program_block"];
    EXPECT_LT(result["rest"]["Y_mm"].get<double>(), 106.2623);
    ASSERT_EQ(drive(kDemoProgram, "--details"), 10);
    EXPECT_NE(shop.out.find("paper-trunnion-demo.ngc:" +
                            std::to_string(result["program_line"].get<int>()) + ": G1 X0.0000 "),
              std::string::npos)
        << shop.out;
    EXPECT_NE(shop.out.find(" Z+ (1 mm: clearance at least "), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("STOP: the guard ordered a stop"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("at rest: X "), std::string::npos);
    EXPECT_NE(shop.out.find("clearance at least"), std::string::npos);
}

// Nothing is permitted 0.3 mm above the table, within the margin, but a jog: up, and then it is
// out.
TEST_F(DriveCommand, OutOfAMarginLeadsAJog) {
    const std::string machine = test::source_file("config/machines/table-spindle-tilting.yaml");
    ASSERT_EQ(
        shop.run("drive '" + machine + "' '" + shop.write("up.ngc", "G21 G90\nG0 Z-100\nM2\n") +
                 "' --json --jog-out --start \"X40 Z-259.7\""),
        10)
        << shop.err;
    const Json result = document();
    EXPECT_EQ(result["state"], "waiting");
    ASSERT_EQ(result["jogs"].size(), 1U) << result;
    EXPECT_EQ(result["jogs"][0]["axis"], "Z");
    EXPECT_EQ(result["jogs"][0]["direction"], "+");
    EXPECT_NEAR(result["jogs"][0]["moved_mm"].get<double>(), 5, 0.1);
    EXPECT_GT(result["jogs"][0]["clearance_mm"].get<double>(), 5);
    EXPECT_FALSE(result["jogs"][0]["stopped"].get<bool>());
    EXPECT_TRUE(result["is_out"].get<bool>());
    EXPECT_EQ(drive(free_air, "--jog-out"), 0) << "nothing to get out of";
}

// The paper's way of judging is too late: the machine touches before it stands.
TEST_F(DriveCommand, ContactModeStopsTheDemoTooLate) {
    ASSERT_EQ(drive(kDemoProgram, "--json --mode contact"), 10) << shop.err;
    const Json result = document();
    EXPECT_EQ(result["guard_stop"]["reason"], "contact");
    bool touches = false;
    for (const Json& pair : result["pairs"]) {
        touches = touches || pair["touching"].get<bool>();
    }
    EXPECT_TRUE(touches);
    EXPECT_TRUE(result["escapes"].empty()) << "out of a contact nothing is proven";
}

TEST_F(DriveCommand, AKilledGuardStopsTheBoardUnlessItsDeadManIsGone) {
    ASSERT_EQ(drive(free_air, "--json --faults killed=0.3"), 10) << shop.err;
    EXPECT_EQ(document()["board_stop"]["why"], "permit_ran_out");
    ASSERT_EQ(shop.run_program(AXG_LAB_PROGRAM, "drive '" + kPaperMachine + "' '" + free_air +
                                                    "' --json --faults killed=0.3 "
                                                    "--ablate no-dead-man"),
              0)
        << shop.err;
    EXPECT_EQ(document()["state"], "finished");
}

// The words of simulate mean the same here.
TEST_F(DriveCommand, TakesWhatTheControlWouldKnow) {
    const std::string program =
        shop.write("words.ngc", "T150 M6\nG54\nM428\nG0 X0 Z0\n/G0 X20\nM2\n");
    EXPECT_EQ(drive(program, ""), 3);
    const std::string words =
        "--tool 150=1 --work-offset 'G54 X30 Z-20' --ignore m428 --block-delete skip";
    ASSERT_EQ(drive(program, "--json " + words), 0) << shop.err;
    EXPECT_NE(shop.err.find("M428: ignored (--ignore)"), std::string::npos) << shop.err;
    EXPECT_NEAR(document()["rest"]["X_mm"].get<double>(), 30, 1e-9);
    EXPECT_NEAR(document()["rest"]["Z_mm"].get<double>(), -20, 1e-9);
    EXPECT_EQ(drive(program, "--tool 150"), 2);
    EXPECT_NE(shop.err.find("--tool: invalid value (found \"150\", expected PROGRAM=MACHINE"),
              std::string::npos);
    EXPECT_EQ(drive(program, words + " --work-offset G99"), 2);
    EXPECT_EQ(drive(program, words + " --max-errors 0"), 2);
    EXPECT_EQ(drive(free_air, "--start X100000"), 3);
    EXPECT_NE(shop.err.find("--start: X: "), std::string::npos) << shop.err;
}

// No frame comes any more, so no frame can tell: the guard's own clock does.
TEST_F(DriveCommand, SilenceIsFoundByTheClock) {
    ASSERT_EQ(drive(free_air, "--json --faults silent=0.3"), 12) << shop.err;
    EXPECT_EQ(document()["state"], "stopped");
    EXPECT_EQ(document()["board_stop"]["why"], "permit_ran_out") << "the stop does not get through";
    // A wire that is cut brings no echo either, and the guard waits for that least.
    EXPECT_EQ(document()["guard_stop"]["reason"], "output");
}

TEST_F(DriveCommand, WithoutAPermitNothingMoves) {
    ASSERT_EQ(drive(free_air, "--json --faults permit-lost=1"), 10) << shop.err;
    EXPECT_EQ(document()["state"], "waiting");
    EXPECT_EQ(document()["permits"], 0);
}

TEST_F(DriveCommand, TheSameSeedGivesTheSameBytes) {
    const auto table = [this](const std::string& seed) {
        EXPECT_NE(drive(free_air, "--csv t.csv --faults lost=0.002 --seed " + seed), 2);
        return content_of(shop.file("t.csv"));
    };
    const std::string first = table("7");
    EXPECT_EQ(first.substr(0, first.find('\n')),
              "sample,board,X_mm,Y_mm,Z_mm,A_deg,C_deg,permit,"
              "reason");
    EXPECT_EQ(first, table("7"));
    EXPECT_NE(first, table("8"));
}

// The cap knows no path, so it costs time in free air too; how much is said, and nothing is
// stopped.
TEST_F(DriveCommand, TheTimeThatTheCapCostsIsReported) {
    ASSERT_EQ(drive(free_air, "--json --obey-cap"), 0) << shop.err;
    const Json result = document();
    EXPECT_GT(result["speed_cap_least"], 0);
    const auto seconds = result["machine_s"].get<double>();
    const auto free_s = result["machine_s_without_cap"].get<double>();
    EXPECT_GT(free_s, 0.5);
    EXPECT_GT(seconds, free_s - 2e-3);
    EXPECT_NEAR(result["rest"]["C_deg"].get<double>(), 90, 1e-9);
    ASSERT_EQ(drive(free_air, "--json"), 0);
    EXPECT_FALSE(document().contains("speed_cap_least"));
    EXPECT_NEAR(document()["machine_s"].get<double>(), free_s, 2e-3);
}

// Straight down on the plate. Who obeys the cap is slower and slower, and so comes nearer before
// the guard has to stop it.
TEST_F(DriveCommand, WhoObeysTheCapGetsNearerToTheObstacle) {
    const std::string down = shop.write("down.ngc", "G0 X60 Y60\nG1 Z-270 F10000\nM2\n");
    const auto clearance_mm = [this, &down](const std::string& options) {
        EXPECT_EQ(drive(down, "--json " + options), 10) << shop.err;
        const Json result = document();
        EXPECT_EQ(result["guard_stop"]["reason"], "predicted");
        return result["pairs"][0]["clearance_mm"].get<double>();
    };
    const double free_mm = clearance_mm(""), capped_mm = clearance_mm("--obey-cap");
    std::printf("%.3f mm, with the cap obeyed %.3f mm\n", free_mm, capped_mm);
    EXPECT_GT(capped_mm, 0);
    EXPECT_LT(capped_mm, 0.5 * free_mm);
}

// Down towards the plate and up again: with a clearance level for slow the board is
// slow near it, and no slower elsewhere.
TEST_F(DriveCommand, ABoardIsSlowWhereThePermitSaysSo) {
    const std::string dip = shop.write("dip.ngc", "G0 X60 Y60\nG1 Z-200 F10000\nG0 Z0\nM2\n");
    ASSERT_EQ(drive(dip, "--json --csv plain.csv"), 0) << shop.err;
    const auto plain_s = document()["machine_s"].get<double>();
    EXPECT_FALSE(document().contains("samples_slow"));
    std::string text = content_of(kPaperMachine);
    const auto levels = [&](const std::string& words) {
        const std::size_t at = text.find("margin_mm: 0}");
        return shop.write("levels.yaml",
                          text.substr(0, at) + "margin_mm: 0, " + words + text.substr(at + 12)) +
               "' --mesh-root '" + source_file("config/machines");
    };
    const auto run = [&](const std::string& words) {
        return shop.run("drive '" + levels(words) + "' '" + dip + "' --json --csv levels.csv");
    };
    ASSERT_EQ(run("slow_mm: 120, warn_mm: 150"), 0) << shop.err;
    const Json slow = document();
    EXPECT_GT(slow["samples_slow"].get<int>(), 100);
    EXPECT_GT(slow["machine_s"].get<double>(), plain_s * 1.1);
    const std::string table = content_of(shop.file("levels.csv"));
    EXPECT_NE(table.find(",permit,reason,level\n"), std::string::npos);
    for (const char* level : {",1,none,slow\n", ",1,none,warn\n", ",1,none,clear\n"}) {
        EXPECT_NE(table.find(level), std::string::npos) << level;
    }
    ASSERT_EQ(run("warn_mm: 150"), 0) << shop.err;
    EXPECT_EQ(document()["samples_slow"], 0) << "a warning slows nobody";
    EXPECT_NEAR(document()["machine_s"].get<double>(), plain_s, 5e-3);
}

// What belongs to the guard belongs to axguardd, and the refusal says where.
TEST_F(DriveCommand, OnABusTheGuardIsAnotherProgram) {
    for (const std::string option :
         {"--mode contact", "--mode stoppable", "--engine cpu", "--faults killed=1", "--jog-out"}) {
        EXPECT_EQ(drive(free_air, "--bus axgnone0 " + option), 2) << option;
        EXPECT_EQ(shop.err.find(option.substr(0, option.find(' ')) + ": "), 0U) << shop.err;
        EXPECT_NE(shop.err.find("With --bus, the guard on axgnone0 is a separate program"),
                  std::string::npos)
            << shop.err;
    }
    EXPECT_EQ(drive(free_air, "--bus ''"), 2) << "an empty variable";
    EXPECT_NE(shop.err.find("empty name. Pass an interface name"), std::string::npos) << shop.err;
    EXPECT_EQ(drive(free_air, "--bus axgnone0 --obey-cap"), 2);
    EXPECT_NE(shop.err.find("guard.speed_cap"), std::string::npos) << shop.err;
}

// With CAN in the kernel or without: which interface, what is wrong with it, and what to do.
TEST_F(DriveCommand, AnInterfaceThatIsNotThereIsNamed) {
    EXPECT_EQ(drive(free_air, "--bus axgnone0"), 12);
    EXPECT_EQ(shop.err.find("axgnone0: no "), 0U) << shop.err;
    const bool has_advice = shop.err.find("List them with ip link") != std::string::npos ||
                            shop.err.find("modprobe can-raw") != std::string::npos;
    EXPECT_TRUE(has_advice) << shop.err;
}

TEST_F(DriveCommand, RefusesWhatItCannotDo) {
    EXPECT_EQ(drive(free_air, "--mode contact --obey-cap"), 2);
    EXPECT_EQ(drive(free_air, "--faults lost=2"), 2);
    EXPECT_NE(
        shop.err.find("--faults: lost: invalid value (found \"2\", expected a number from 0 to 1)"),
        std::string::npos)
        << shop.err;
    EXPECT_EQ(drive(free_air, "--faults lots=0.1"), 2);
    EXPECT_EQ(drive(free_air, "--faults killed=soon"), 2);
    EXPECT_EQ(drive(free_air, "--ablate no-dead-man"), 2) << "a part of tests and the laboratory";
    EXPECT_EQ(drive(free_air, "--start Q1"), 2);
    EXPECT_EQ(drive(shop.write("bad.ngc", "G87 X1\nM2\n"), ""), 3);
    EXPECT_NE(shop.err.find("bad.ngc:1: G87"), std::string::npos) << shop.err;
    EXPECT_EQ(drive(shop.file("none.ngc"), ""), 3);
}

}  // namespace
}  // namespace axg::test
