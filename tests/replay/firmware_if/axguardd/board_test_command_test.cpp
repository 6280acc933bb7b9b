// SPDX-License-Identifier: Apache-2.0
// What axguardd board-test refuses before a frame is sent. What it does on a bus:
// can_vm_board_test.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

struct Told {
    int code = 0;
    std::string words;
};

Told board_test(const test::Workshop& shop, const std::string& machine,
                const std::vector<std::string>& more) {
    std::vector<std::string> words{
        "board-test",  shop.write("machine.yaml", machine),
        "--mesh-root", std::filesystem::path(test::kPaperMachine).parent_path().string(),
        "--bus",       "nocan9",
        "--state-dir", shop.file("."),
        "--priority",  "0"};
    words.insert(words.end(), more.begin(), more.end());
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const int code = run_axguardd(words);
    return {code, testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout()};
}

TEST(BoardTestCommand, NamesAnInterfaceThatIsMissing) {
    const test::Workshop shop;
    const Told told = board_test(shop, test::content_of(test::kPaperMachine), {"--yes"});
    EXPECT_EQ(told.code, kExitCan) << told.words;
    EXPECT_NE(told.words.find("nocan9"), std::string::npos) << told.words;
    EXPECT_FALSE(std::filesystem::exists(shop.file("report.json")));
}

TEST(BoardTestCommand, RefusesAMachineWithoutSuchABoard) {
    const std::string paper = test::content_of(test::kPaperMachine);
    std::string version_1 = paper;
    version_1.replace(version_1.find("permit: 2"), 9, "permit: 1");
    for (const std::string& machine : {test::paper_machine_with_drives(paper, true), version_1}) {
        const test::Workshop shop;
        const Told told = board_test(shop, machine, {"--yes"});
        EXPECT_EQ(told.code, kExitInput) << told.words;
        EXPECT_NE(told.words.find("wanted can.format classical or fd and can.permit: 2"),
                  std::string::npos)
            << told.words;
    }
}

TEST(BoardTestCommand, ListsTheCasesWhereOneIsUnknown) {
    const test::Workshop shop;
    const Told told =
        board_test(shop, test::content_of(test::kPaperMachine), {"--only", "nonsense"});
    EXPECT_EQ(told.code, kExitUsage) << told.words;
    EXPECT_NE(told.words.find("run, lapse, gap, stop_frame"), std::string::npos) << told.words;
}

TEST(BoardTestCommand, WritesNoReportOverItsInput) {
    const test::Workshop shop;
    const Told told = board_test(shop, test::content_of(test::kPaperMachine),
                                 {"-o", shop.file("machine.yaml"), "--yes"});
    EXPECT_EQ(told.code, kExitUsage) << told.words;
}

}  // namespace
}  // namespace axg
