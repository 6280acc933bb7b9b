// SPDX-License-Identifier: Apache-2.0
// What axguardd board-test refuses before a frame is sent. What it does on a bus:
// can_vm_board_test.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/system/end_signals.hpp"
#include "firmware_if/system/one_guard.hpp"
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
    const test::Workshop shop;
    const Told told = board_test(shop, test::paper_machine_with_drives(paper, true), {"--yes"});
    EXPECT_EQ(told.code, kExitInput) << told.words;
    EXPECT_NE(told.words.find("found can.format cia402, expected classical or fd"),
              std::string::npos)
        << told.words;
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

// Opening a pipe that nobody reads waits for ever, and the machine has moved by then.
TEST(BoardTestCommand, RefusesAReportThatIsNoRegularFile) {
    const test::Workshop shop;
    const std::string pipe = shop.file("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const std::string option : {"-o", "--write"}) {
        for (const std::string& name : {pipe, std::string("/dev/null")}) {
            const Told told =
                board_test(shop, test::content_of(test::kPaperMachine), {option, name, "--yes"});
            EXPECT_EQ(told.code, kExitUsage) << told.words;
            EXPECT_NE(told.words.find("not a regular file"), std::string::npos) << told.words;
        }
    }
}

TEST(BoardTestCommand, ARecordNeedsASerialAndAPlaceBeforeAnythingMoves) {
    const std::string paper = test::content_of(test::kPaperMachine);
    const std::pair<std::vector<std::string>, const char*> refusals[] = {
        {{"--write", "keys.yaml"}, "Pass its serial number with --serial"},
        {{"--write", "keys.yaml", "--serial", ""}, "Pass its serial number with --serial"},
        {{"--write", "keys.yaml", "--serial", "a\tb"}, "--serial: no serial"},
        {{"--serial", "MB7-0012"}, "--serial needs --write"}};
    for (const auto& [options, words] : refusals) {
        const test::Workshop shop;
        std::vector<std::string> more = options;
        more.emplace_back("--yes");
        if (more[0] == "--write") {
            more[1] = shop.file(more[1]);
        }
        const Told told = board_test(shop, paper, more);
        EXPECT_EQ(told.code, kExitUsage) << told.words;
        EXPECT_NE(told.words.find(words), std::string::npos) << told.words;
    }
    const test::Workshop shop;
    ASSERT_EQ(mkfifo(shop.file("nocan9.board-test.json").c_str(), 0600), 0);
    const Told told = board_test(
        shop, paper, {"--write", shop.file("keys.yaml"), "--serial", "MB7-0012", "--yes"});
    EXPECT_EQ(told.code, kExitUsage) << told.words;
    EXPECT_NE(told.words.find("board-test.json: is not a regular file"), std::string::npos)
        << told.words;
}

TEST(BoardTestCommand, RefusesACaseThatCannotBePlayed) {
    const char* const names[] = {"cap", "hold", "jog", "run_in_jog"};
    for (const std::string name : names) {
        const test::Workshop shop;
        const Told told =
            board_test(shop, test::content_of(test::kPaperMachine), {"--yes", "--only", name});
        EXPECT_EQ(told.code, kExitUsage) << told.words;
        EXPECT_NE(told.words.find("--only " + name), std::string::npos) << told.words;
    }
}

TEST(BoardTestCommand, AnotherGuardIsNoFaultOfTheBoard) {
    const test::Workshop shop;
    const OneGuard other(shop.file("."), "nocan9");
    ASSERT_EQ(other.status(), OneGuard::Status::mine);
    const Told told = board_test(shop, test::content_of(test::kPaperMachine), {"--yes"});
    EXPECT_EQ(told.code, kExitCan) << told.words;
}

TEST(EndSignals, AreNotedAndEndNothing) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        EndSignals signals;
        raise(SIGPIPE);
        EXPECT_FALSE(signals.was_sent());
        raise(signal);
        EXPECT_TRUE(signals.was_sent()) << signal;
        EXPECT_TRUE(signals.was_sent()) << signal;
    }
}

}  // namespace
}  // namespace axg
