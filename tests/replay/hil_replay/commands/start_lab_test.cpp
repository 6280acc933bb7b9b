// SPDX-License-Identifier: Apache-2.0
// Commands that moved to axguard-lab: axguard becomes that program, so words, output, exit codes
// and signals are its own; one line on stderr says so.
#include <gtest/gtest.h>

#include <filesystem>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class StartLab : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM) || !std::filesystem::exists(AXG_LAB_PROGRAM)) {
            GTEST_SKIP() << "axguard or axguard-lab is not built";
        }
    }
    test::Workshop shop;
};

TEST_F(StartLab, SaysSoAndThenWhatTheLaboratorySays) {
    for (const std::string words : {"query --help", "accuracy --list", "bench 'no such folder'",
                                    "chart ''", "query --json", "bench --no-such-option"}) {
        const int code = shop.run_program(AXG_LAB_PROGRAM, words);
        const std::string out = shop.out, err = shop.err;
        EXPECT_EQ(shop.run_program(AXG_PROGRAM, words), code) << words;
        EXPECT_EQ(shop.out, out) << words;
        const std::string word = words.substr(0, words.find(' '));
        EXPECT_EQ(shop.err, "axguard: " + word + " is now axguard-lab " + word +
                                "; starting axguard-lab\n" + err);
    }
}

TEST_F(StartLab, AloneItSaysWhatIsMissing) {
    const std::string alone = shop.file("axguard");
    std::filesystem::copy_file(AXG_PROGRAM, alone);
    EXPECT_EQ(shop.run_program(alone, "chart --help"), kExitInput);
    EXPECT_NE(
        shop.err.find("No such file or directory. Install axguard-lab in the folder of axguard"),
        std::string::npos)
        << shop.err;
    EXPECT_EQ(shop.run_program(alone, "--help"), kExitClean) << "the rest needs no laboratory";
}

}  // namespace
}  // namespace axg
