// SPDX-License-Identifier: Apache-2.0
// axguardd run refuses a machine file whose frames can never show that the axes stand, before it
// opens anything, and says what to add.
#include <gtest/gtest.h>

#include <filesystem>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

TEST(AxguarddRun, RefusesDrivesThatDoNotAllReportTheirSpeed) {
    for (const bool has_speeds : {false, true}) {
        const test::Workshop shop;
        const std::string file = shop.write(
            "drives.yaml",
            test::paper_machine_with_drives(test::content_of(test::kPaperMachine), has_speeds));
        testing::internal::CaptureStderr();
        const int code = run_axguardd(
            {"run", file, "--mesh-root",
             std::filesystem::path(test::kPaperMachine).parent_path().string(), "--bus", "nocan9",
             "--state-dir", shop.file("."), "--engine", "cpu", "--priority", "0"});
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_EQ(code, has_speeds ? kExitCan : kExitInput) << said;
        EXPECT_EQ(std::filesystem::exists(shop.file("nocan9.latch")), has_speeds);
        const std::string words =
            "axguardd: " + file +
            ": can.drives: no stop can be confirmed without the velocity of every axis (missing: "
            "X, Y, Z, A, C). Map object 0x606C and add the key velocity.";
        EXPECT_EQ(said.find(words) != std::string::npos, !has_speeds) << said;
    }
}

TEST(AxguarddRun, WarnsWhereNobodyComparesTheMachines) {
    const std::string required = test::content_of(test::kPaperMachine);
    const std::string none = test::with(required, "hashes: required", "hashes: none");
    for (const std::string& text : {required, none}) {
        const test::Workshop shop;
        const std::string file = shop.write("machine.yaml", text);
        testing::internal::CaptureStderr();
        const int code = run_axguardd(
            {"run", file, "--mesh-root",
             std::filesystem::path(test::kPaperMachine).parent_path().string(), "--bus", "nocan9",
             "--state-dir", shop.file("."), "--engine", "cpu", "--priority", "0"});
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_EQ(code, kExitCan) << said;
        const std::string words = "axguardd: " + file + ": warning: can.hashes: none: ";
        EXPECT_EQ(said.find(words) != std::string::npos, text == none) << said;
    }
}

/// What `run` and `admit` print of the paper's machine with `keys` added, on an interface that is
/// not there.
std::string refused_by(const char* command, const std::string& keys, int exit_code) {
    const test::Workshop shop;
    const std::string file = shop.write("machine.yaml", keys);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const int code = run_axguardd(
        {command, file, "--mesh-root",
         std::filesystem::path(test::kPaperMachine).parent_path().string(), "--bus", "nocan9",
         "--state-dir", shop.file("."), "--engine", "cpu", "--priority", "0"});
    (void)testing::internal::GetCapturedStdout();
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(code, exit_code) << said;
    EXPECT_FALSE(std::filesystem::exists(shop.file("nocan9.latch")));
    return said;
}

// No permit of such a machine ends when its certificate supposes.
TEST(AxguarddRun, RefusesPermitsThatNothingObeys) {
    const std::string paper = test::content_of(test::kPaperMachine);
    const std::string drives = test::paper_machine_with_drives(paper, true);
    std::string empty_sync = drives, line = paper;
    empty_sync.erase(empty_sync.find("  sync_counter: 240\n"),
                     std::string("  sync_counter: 240\n").size());
    line.insert(line.find("\nguard:\n") + 8, "  obeyed_by: line\n");
    for (const char* command : {"run", "admit"}) {
        EXPECT_NE(refused_by(command, empty_sync, kExitInput)
                      .find("machine.yaml: guard.obeyed_by: no board can obey these permits: a "
                            "permit does not name its sample (found can.sync_counter: 0, expected "
                            "240)"),
                  std::string::npos);
        EXPECT_NE(refused_by(command, line, kExitInput)
                      .find("guard.obeyed_by: no line can obey these permits: not built."),
                  std::string::npos);
        EXPECT_NE(refused_by(command, test::with(paper, "permit: 2", "permit: 1"), kExitInput)
                      .find("can.permit: invalid value (found 1, expected 2"),
                  std::string::npos);
    }
}

// Both would name one file, or none.
TEST(AxguarddRun, AStatusSocketNeedsANameOfItsOwn) {
    const test::Workshop shop;
    const auto run_with = [&shop](const std::vector<std::string>& more) {
        std::vector<std::string> words{"run",         test::kPaperMachine, "--bus",    "nocan9",
                                       "--state-dir", shop.file("."),      "--engine", "cpu"};
        words.insert(words.end(), more.begin(), more.end());
        testing::internal::CaptureStderr();
        const int code = run_axguardd(words);
        return std::pair(code, testing::internal::GetCapturedStderr());
    };
    EXPECT_EQ(run_with({"--status-socket", ""}).first, kExitUsage);
    const std::string name = shop.file("one");
    for (const std::string& other : {name, shop.file("./one"), name + ".part"}) {
        const auto [code, said] = run_with({"--metrics", name, "--status-socket", other});
        EXPECT_EQ(code, kExitUsage) << said;
        EXPECT_NE(said.find("--metrics and --status-socket both name"), std::string::npos) << said;
    }
    EXPECT_FALSE(std::filesystem::exists(shop.file("nocan9.lock"))) << "nothing was begun";
}

// As `run` does, so that nobody learns it at the machine.
TEST(AxguardCheck, ListsWhatALiveGuardRefuses) {
    const std::string paper = test::content_of(test::kPaperMachine);
    std::string reports = paper;
    reports.insert(reports.find("\nguard:\n") + 8, "  obeyed_by: line\n  limits_broken: report\n");
    test::Workshop shop;
    (void)shop.write("bad.yaml", reports);
    const std::string root = std::filesystem::path(test::kPaperMachine).parent_path().string();
    ASSERT_EQ(shop.run("check bad.yaml --engine cpu --json=bad.json --mesh-root " + root),
              kExitClean)
        << shop.err;
    for (const char* const why : {"guard.obeyed_by: no line ", "guard.limits_broken: report "}) {
        EXPECT_NE(shop.out.find("  axguardd run rejects this machine: " + std::string(why)),
                  std::string::npos)
            << shop.out;
        EXPECT_NE(test::content_of(shop.file("bad.json")).find('"' + std::string(why)),
                  std::string::npos);
    }
    ASSERT_EQ(shop.run("check " + test::kPaperMachine + " --engine cpu"), kExitClean);
    EXPECT_EQ(shop.out.find("rejects this machine"), std::string::npos) << shop.out;
}

}  // namespace
}  // namespace axg
