// SPDX-License-Identifier: Apache-2.0
// The first thing that a stranger runs: one screen, figures from the run, files where it says, and
// commands that work as printed. Runs the program itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

class DemoCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<Workshop>();
        ASSERT_EQ(shop->run("demo"), kExitClean) << shop->err;
        screen = shop->out;
        EXPECT_EQ(shop->err, "");
    }
    static void TearDownTestSuite() { shop.reset(); }
    static bool shows(const std::string& text) { return screen.find(text) != std::string::npos; }

    static std::unique_ptr<Workshop> shop;
    static std::string screen;
};

std::unique_ptr<Workshop> DemoCommand::shop;
std::string DemoCommand::screen;

/// The commands behind "next", each with its further lines.
std::vector<std::string> next_commands(const std::string& screen) {
    std::vector<std::string> commands;
    const auto lines = lines_of(screen.substr(screen.find("\nnext  ") + 1));
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string command = lines[i].substr(6);
        while (command.back() == '\\') {
            command += "\n" + lines[++i];
        }
        commands.push_back(command);
    }
    return commands;
}

// Two of the commands behind "next" take a second line; a long path to the checkout makes more.
TEST_F(DemoCommand, FitsOnOneScreen) {
    constexpr std::size_t kSecondLines = 2;
    const auto lines = lines_of(screen);
    const auto wrapped = static_cast<std::size_t>(std::count_if(
        lines.begin(), lines.end(), [](const std::string& line) { return line.ends_with('\\'); }));
    EXPECT_LE(lines.size() - wrapped + kSecondLines, kScreenLines) << screen;
    EXPECT_LE(widest(lines), kScreenColumns) << screen;
}

TEST_F(DemoCommand, ShowsBothProgramsAndTheStopInPlainWords) {
    std::smatch figures;
    const std::regex line("\\n   (\\d+) of (\\d+) samples proven");
    ASSERT_TRUE(std::regex_search(screen, figures, line)) << screen;
    EXPECT_GE(std::stol(figures[1]) + 1, std::stol(figures[2])) << "all but the first";
    for (const char* const text :
         {"1  paper-trunnion-clean.ngc runs to its end\n", "2  paper-trunnion-demo.ngc drives ",
          "time of a cycle: median ", "; deadline 500 us",
          "stop at 40.875 s, line 700: G1 X0.0000 Y106.2623 ", "are too near to be proven clear\n",
          "they are at least 4.6609 mm apart, the proof of a stop needs up to 9.7041 mm\n",
          "without the guard, cutter and plate are in contact 0.198 s later",
          "3  as 2 with guard: {cap: per_axis}: permits cap speeds, the board rests 0.12 mm above "
          "the plate\n"}) {
        EXPECT_TRUE(shows(text)) << text << "\n" << screen;
    }
    EXPECT_FALSE(shows("leaf_pairs")) << "how the guard is built is a detail";
}

TEST_F(DemoCommand, WritesItsFilesAndKeepsWhatItDoesNotPrint) {
    for (const char* const name : {"clean.log", "clean.log.lines", "collision.log", "guard.log",
                                   "collision.log.lines", "collision.html", "details.txt"}) {
        EXPECT_GT(std::filesystem::file_size(shop->file(std::string("axguard-demo/") + name)), 0U);
    }
    EXPECT_TRUE(shows("axguard-demo/collision.html") && shows("axguard-demo/details.txt"));
    const std::string log = content_of(shop->file("axguard-demo/details.txt"));
    std::size_t commands = 0;
    for (std::size_t at = 0; (at = log.find("$ axguard ", at)) != std::string::npos; ++at) {
        ++commands;
    }
    EXPECT_EQ(commands, 6U);
    for (const char* const text :
         {"samples not proven\n", "samples above\n", "no stop: every checked", "leaf_pairs",
          "of program, ", "STOP at 41.073405 s"}) {
        EXPECT_NE(log.find(text), std::string::npos) << text;
    }
}

TEST_F(DemoCommand, ItsNextStepsWorkAsPrinted) {
    const auto commands = next_commands(screen);
    ASSERT_EQ(commands.size(), 3U) << screen;
    EXPECT_TRUE(shows("  # a simulated board brakes")) << "where a line has room, what it is for";
    const int codes[] = {kExitClean, kExitCollision, kExitClean};
    for (std::size_t i = 0; i < commands.size(); ++i) {
        EXPECT_EQ(shop->run_program("env", "sh -c '" + commands[i] + "'"), codes[i])
            << commands[i] << "\n"
            << shop->out << shop->err;
    }
}

TEST_F(DemoCommand, DetailsPrintEachCommandWithItsText) {
    ASSERT_EQ(shop->run("demo --details --output other"), kExitClean) << shop->err;
    for (const char* const text :
         {"\n$ axguard simulate ", "\n$ axguard replay ", "samples not proven\n", "samples above\n",
          "leaf_pairs", "1  paper-trunnion-clean.ngc"}) {
        EXPECT_NE(shop->out.find(text), std::string::npos) << text;
    }
    EXPECT_TRUE(std::filesystem::exists(shop->file("other/details.txt")));
}

TEST_F(DemoCommand, WithoutItsDataItSaysWhereToPointIt) {
    EXPECT_EQ(shop->run("demo --data /nowhere"), kExitInput);
    EXPECT_NE(shop->err.find("--data FOLDER"), std::string::npos) << shop->err;
}

}  // namespace
}  // namespace axg::test
