// SPDX-License-Identifier: Apache-2.0
// The line of progress: on a terminal, with rate and time left, and wiped in the end; nothing where
// standard error is none.
#include "firmware_if/cli/progress.hpp"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <optional>
#include <regex>
#include <string>

#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

constexpr const char* kNoTerminal = "no pseudo-terminal here: mount /dev/pts";

TEST(Progress, Durations) {
    EXPECT_EQ(duration_text(0.2), "1 s");
    EXPECT_EQ(duration_text(59), "59 s");
    EXPECT_EQ(duration_text(61.5), "1 min 2 s");
    EXPECT_EQ(duration_text(3600), "1 h 0 min");
    EXPECT_EQ(duration_text(5430), "1 h 30 min");
}

/// What a process that does this prints on a terminal of its own. Nothing: no terminal can be had
/// here.
std::optional<std::string> on_a_terminal(const std::function<void()>& work) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child < 0) {
        return std::nullopt;
    }
    if (child == 0) {
        work();
        _exit(0);
    }
    std::string said;
    char buffer[4096];
    for (ssize_t count = 0; (count = read(terminal, buffer, sizeof buffer)) > 0;) {
        said.append(buffer, static_cast<std::size_t>(count));
    }
    close(terminal);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << said;
    return said;
}

std::optional<std::string> on_a_terminal(const std::string& command) {
    return on_a_terminal([&command] {
        execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        _exit(127);
    });
}

TEST(Progress, OfWorkWithoutMachineTimeSaysHowMuchIsLeft) {
    const std::optional<std::string> said = on_a_terminal([] {
        Progress progress;
        usleep(250'000);
        if (progress.is_due()) {
            progress.show(0.25, "proving");
        }
    });
    if (!said) {
        GTEST_SKIP() << kNoTerminal;
    }
    EXPECT_TRUE(std::regex_search(*said, std::regex(R"(\rproving, 25 %, \d+ s left )"))) << *said;
    EXPECT_TRUE(said->ends_with(std::string(79, ' ') + "\r")) << *said;
}

/// A minute of machine time to and fro: no trace is needed to see the line of a drive.
TEST(Progress, IsSeenOnATerminalAlone) {
    Workshop shop;
    std::string program = "G21 G90 F6000\n";
    for (int i = 0; i < 60; ++i) {
        program += i % 2 == 0 ? "G1 X50\n" : "G1 X-50\n";
    }
    const std::string file = shop.write("to_and_fro.ngc", program + "M2\n");
    const std::string command =
        std::string(AXG_PROGRAM) + " drive " + kPaperMachine + " " + file + " 2>&1 >/dev/null";
    const std::regex line(R"(\r[0-9.]+ s of machine time, \d+ x real time, \d+ %, .* left, )");
    EXPECT_EQ(shop.run("drive " + kPaperMachine + " " + file), 0);
    EXPECT_EQ(shop.err.find(" x real time"), std::string::npos) << shop.err;
    const std::optional<std::string> said = on_a_terminal(command);
    if (!said) {
        GTEST_SKIP() << kNoTerminal;
    }
    EXPECT_TRUE(std::regex_search(*said, line)) << *said;
    EXPECT_TRUE(said->ends_with(std::string(79, ' ') + "\r")) << *said;
}

}  // namespace
}  // namespace axg::test
