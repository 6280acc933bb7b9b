// SPDX-License-Identifier: Apache-2.0
// axguardd proof-test against a status socket that plays a guard, and a person who answers.
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/system/status_socket.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

std::string guard_line(const std::string& phase, const std::string& cause, int permits,
                       const std::string& pair = "null", const std::string& sha = "0123456789") {
    return R"({"bus":"can0","machine":"mill","configuration_sha256":")" + sha + R"(","phase":")" +
           phase + R"(","age_ms":3,"permits":)" + std::to_string(permits) + R"(,"cause":")" +
           cause + R"(","reason":"none","pair":)" + pair +
           R"(,"withheld":"nothing","withheld_pair":null,"stands":true,"confirmed":true})" + "\n";
}
const std::string kPair = R"(["cutter","block"])";
const std::string kGone = "gone";
/// What a guard shows in a test that passes, a line for each look.
const std::vector<std::string> kWhole{guard_line("ready", "none", 0),
                                      guard_line("armed", "none", 10),
                                      guard_line("stopped", "verdict", 20, kPair),
                                      guard_line("stopped", "verdict", 20, kPair),
                                      guard_line("armed", "none", 30),
                                      guard_line("stopped", "input", 40),
                                      guard_line("armed", "none", 50),
                                      kGone,
                                      guard_line("stopped", "latched", 0)};

/// Serves one line a reader, in order; the last one for ever.
class PlayedGuard {
  public:
    PlayedGuard(std::string path, std::vector<std::string> lines)
        : path_(std::move(path)), lines_(std::move(lines)), thread_([this] { play(); }) {
        while (!is_open_.load()) {
            poll(nullptr, 0, 1);
        }
    }
    ~PlayedGuard() {
        is_ending_.store(true);
        thread_.join();
    }
    PlayedGuard(const PlayedGuard&) = delete;
    PlayedGuard& operator=(const PlayedGuard&) = delete;

  private:
    void open() {
        std::string fault;
        socket_ = StatusSocket::open(path_, fault);
        EXPECT_EQ(fault, "");
        EXPECT_TRUE(socket_.listen());
        is_open_.store(true);
    }
    void play() {
        open();
        for (std::size_t at = 0; !is_ending_.load();) {
            if (lines_[at] == kGone) {
                socket_ = StatusSocket();
                poll(nullptr, 0, 300);
                open();
                ++at;
            }
            if (socket_.await(10)) {
                const std::string& line = lines_[at];
                socket_.serve([&line] { return std::span(line.data(), line.size()); });
                at = std::min(at + 1, lines_.size() - 1);
            }
        }
    }

    std::string path_;
    std::vector<std::string> lines_;
    StatusSocket socket_;
    std::atomic<bool> is_open_{false}, is_ending_{false};
    std::thread thread_;
};

class ProofTestCommand : public testing::Test {
  protected:
    int run(const std::vector<std::string>& lines, const std::string& answers,
            const std::vector<std::string>& more = {}) {
        const PlayedGuard guard(shop.file("status"), lines);
        return run_only(answers, more);
    }
    int run_only(const std::string& answers, const std::vector<std::string>& more = {}) {
        std::vector<std::string> words{"proof-test", "--socket", shop.file("status"),
                                       "--log",      log_file,   "--person-seconds",
                                       seconds};
        words.insert(words.end(), more.begin(), more.end());
        std::istringstream typed(answers);
        std::streambuf* const before = std::cin.rdbuf(typed.rdbuf());
        std::cin.clear();
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        const int code = run_axguardd(words);
        printed = testing::internal::GetCapturedStdout();
        told = testing::internal::GetCapturedStderr();
        std::cin.rdbuf(before);
        std::cin.clear();
        return code;
    }
    std::string log() const { return test::content_of(log_file); }

    test::Workshop shop;
    std::string log_file = shop.file("maintenance.log"), printed, told, seconds = "1";
};

TEST_F(ProofTestCommand, LogsEachStepThatPasses) {
    (void)shop.write("maintenance.log", "earlier\n");
    ASSERT_EQ(run(kWhole, "yes\nyes\nyes\nyes\n", {"--by", "Ann", "--pair", "cutter - block"}),
              kExitClean)
        << told << log();
    EXPECT_EQ(log(), "earlier\n" + printed);
    for (const char* text :
         {"Z can0 mill 01234567 proof-test armed: passed, seen: armed\n",
          "proof-test place: passed, seen: stopped: verdict: cutter - block\n",
          "rest: passed, seen: stopped: verdict: cutter - block; Did the machine rest before",
          "proof-test plug: passed, seen: stopped: input; Did every axis stay at rest? yes\n",
          "proof-test killed: passed, seen: stopped: latched; ",
          "proof-test estop: passed, answered",
          "proof-test PASSED: 8 of 8 steps passed by Ann\n"}) {
        EXPECT_NE(log().find(text), std::string::npos) << text << log();
    }
    EXPECT_NE(told.find("It does not cover: braking at full speed"), std::string::npos) << told;
}

TEST_F(ProofTestCommand, AnAnswerOtherThanYesFails) {
    EXPECT_EQ(run(kWhole, "no\n"), kExitUnfit);
    EXPECT_NE(log().find("rest: FAILED"), std::string::npos) << log();
    EXPECT_NE(log().find("proof-test FAILED: 2 of 8 steps passed\n"), std::string::npos) << log();
    EXPECT_EQ(run(kWhole, ""), kExitUnfit);  // nobody answers
}

TEST_F(ProofTestCommand, AnotherPairOrNoStopFails) {
    EXPECT_EQ(run(kWhole, "yes\n", {"--pair", "cutter - plate"}), kExitUnfit);
    EXPECT_NE(log().find("place: FAILED, seen: stopped: verdict: cutter - block"),
              std::string::npos)
        << log();
    seconds = "0.3";
    EXPECT_EQ(run({kWhole[0], kWhole[1]}, "yes\n"), kExitUnfit);
    EXPECT_NE(log().find("place: FAILED, not seen within 0.3 s: armed"), std::string::npos)
        << log();
}

// A file that was changed and read by the restart is another guard than the one under test.
TEST_F(ProofTestCommand, AnotherConfigurationFails) {
    EXPECT_EQ(run({kWhole[0], guard_line("armed", "none", 10, "null", "9999999999")}, ""),
              kExitUnfit);
    EXPECT_NE(log().find("armed: FAILED, another configuration"), std::string::npos) << log();
}

TEST_F(ProofTestCommand, RefusesWithoutAGuardOrALog) {
    EXPECT_EQ(run_only(""), kExitInput);
    EXPECT_NE(told.find("no guard"), std::string::npos) << told;
    EXPECT_FALSE(std::filesystem::exists(log_file));
    EXPECT_EQ(run({"{}\n"}, ""), kExitInput);
    EXPECT_NE(told.find("another axguardd version"), std::string::npos) << told;
    log_file = shop.file("no-folder/maintenance.log");
    EXPECT_EQ(run(kWhole, ""), kExitUsage);
    EXPECT_NE(told.find("cannot be opened"), std::string::npos) << told;
    log_file = "/dev/full";
    EXPECT_EQ(run(kWhole, "yes\nyes\nyes\nyes\n"), kExitInternal) << told;
}

}  // namespace
}  // namespace axg
