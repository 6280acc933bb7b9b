// SPDX-License-Identifier: Apache-2.0
// The completion that the programs print, loaded by bash itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

class Completion : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists("/bin/bash")) {
            GTEST_SKIP() << "no bash";
        }
    }

    /// What bash proposes for the last of these words, one blank after each.
    std::string replies(const std::string& program, const std::string& words) {
        std::string function = "_" + program;
        std::replace(function.begin(), function.end(), '-', '_');
        (void)shop.write("try.sh", "set -eu\neval \"$(" + std::string(AXG_BINARY_DIR) + "/" +
                                       program + " completion bash)\"\ncomplete -p " + program +
                                       " >&2\nCOMP_WORDS=(" + words +
                                       ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n" + function +
                                       "\necho \"${COMPREPLY[*]}\"\n");
        EXPECT_EQ(shop.run_program("bash", "try.sh"), 0) << shop.err;
        EXPECT_NE(shop.err.find("-F " + function + " " + program), std::string::npos) << shop.err;
        return shop.out;
    }

    Workshop shop;
};

TEST_F(Completion, BashProposesCommandsOptionsAndValues) {
    EXPECT_EQ(replies("axguard", "axguard rep"), "replay\n");
    EXPECT_EQ(replies("axguard", "axguard help ver"), "verify\n");
    EXPECT_EQ(replies("axguard", "axguard replay m.yaml --mod"), "--mode\n");
    EXPECT_EQ(replies("axguard", "axguard replay --mode ''"), "contact stoppable\n");
    EXPECT_EQ(replies("axguard", "axguard replay ''"), "\n") << "file names, by -o default";
    EXPECT_EQ(replies("axguard", "axguard replay --report ''"), "\n");
    EXPECT_EQ(replies("axguard", "axguard completion z"), "zsh\n");
    EXPECT_EQ(replies("axguardd", "axguardd run --admit-unf"), "--admit-unfit\n");
    EXPECT_EQ(replies("axguard-lab", "axguard-lab acc"), "accuracy\n");
}

TEST_F(Completion, EachShellHasAScript) {
    EXPECT_EQ(shop.run("completion zsh"), kExitClean);
    EXPECT_EQ(shop.out.find("#compdef axguard\n"), 0U);
    EXPECT_NE(shop.out.find("'--mode["), std::string::npos);
    EXPECT_NE(shop.out.find(":value:(contact stoppable)'"), std::string::npos);
    EXPECT_EQ(shop.run("completion fish"), kExitClean);
    EXPECT_NE(
        shop.out.find("'__fish_seen_subcommand_from replay' -l mode -x -a 'contact stoppable'"),
        std::string::npos);
    EXPECT_EQ(shop.run("completion tcsh"), kExitUsage);
}

}  // namespace
}  // namespace axg::test
