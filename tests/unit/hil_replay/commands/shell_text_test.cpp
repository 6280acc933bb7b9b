// SPDX-License-Identifier: Apache-2.0
// Commands that are printed to be pasted: a shell reads back what was meant, in lines that fit.
#include "hil_replay/commands/shell_text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

namespace axg {
namespace {

std::string said_by_shell(const std::string& command) {
    const std::unique_ptr<std::FILE, decltype(&pclose)> shell(popen(command.c_str(), "r"), &pclose);
    std::array<char, 1000> text{};
    const std::size_t size = std::fread(text.data(), 1, text.size(), shell.get());
    return {text.data(), size};
}

TEST(ShellText, AShellReadsBackEachWord) {
    for (const char* const word : {"plain/a-b_c.ngc", "two words", "it's", "$HOME", "", "a;b\\c"}) {
        EXPECT_EQ(said_by_shell("printf %s " + shell_word(word)), word);
    }
    EXPECT_EQ(shell_word("config/machines/m.yaml"), "config/machines/m.yaml") << "no quotes needed";
}

TEST(ShellText, ALongCommandGoesOnBehindABackslash) {
    const std::vector<std::string> words = {"printf", "%s,", std::string(30, 'a'),
                                            std::string(30, 'b'), std::string(30, 'c')};
    const std::string command = shell_command(words, 6, 60);
    std::istringstream lines(command);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        EXPECT_LE(line.size() + (count == 0 ? 6 : 0), 60U) << line;
    }
    EXPECT_EQ(count, 3);
    EXPECT_EQ(said_by_shell(command), words[2] + "," + words[3] + "," + words[4] + ",");
    EXPECT_EQ(shell_command({"axguard", "check", "m.yaml"}, 6, 60), "axguard check m.yaml");
}

TEST(ShellText, APathIsNamedTheShortWay) {
    const std::string here = std::filesystem::current_path().string();
    EXPECT_EQ(shorter_path(here + "/config/m.yaml"), "config/m.yaml");
    EXPECT_EQ(shorter_path("/m.yaml"), "/m.yaml");
}

// A test program is not in PATH: its own file is named, with a slash, so that a shell finds it.
TEST(ShellText, TheOwnCommandStartsThisProgram) {
    EXPECT_NE(own_command().find('/'), std::string::npos) << own_command();
    EXPECT_TRUE(std::filesystem::equivalent(own_command(), "/proc/self/exe"));
}

}  // namespace
}  // namespace axg
