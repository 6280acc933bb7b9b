// SPDX-License-Identifier: Apache-2.0
// A recorded bus to watch: a trace that shows nothing is refused, and one that lacks a side is
// played, with a note about what to do.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class WatchCommand : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) {
            GTEST_SKIP() << "libjs-three is not installed";
        }
    }
    /// Ends it after a second, as Ctrl-C does. 1: built without its server.
    void watch(const std::string& traces) {
        const int code = shop.run_program(
            "timeout", "--preserve-status -s INT 1 '" + std::string(AXG_PROGRAM) + "' watch '" +
                           test::kPaperMachine + "' --listen 127.0.0.1:0 " + traces);
        EXPECT_TRUE(code == kExitClean || code == kExitInternal) << code << shop.err;
    }
    [[nodiscard]] bool says(const std::string& words) const {
        return shop.err.find(words) != std::string::npos;
    }

    test::Workshop shop;
};

TEST_F(WatchCommand, ATraceThatShowsNothingIsRefused) {
    (void)shop.write("empty.log", "");
    (void)shop.write("other.log", "(1.000000) can0 7A5#00\n");
    const std::string command = "watch '" + std::string(test::kPaperMachine) + "' --trace ";
    EXPECT_EQ(shop.run(command + "empty.log"), kExitInput);
    EXPECT_TRUE(says("empty.log: the trace is empty")) << shop.err;
    EXPECT_EQ(shop.run(command + "other.log"), kExitInput);
    EXPECT_TRUE(says("other.log: no frame of the board or the guard (found 1 frames,")) << shop.err;
    EXPECT_EQ(shop.run(command + "none.log"), kExitInput);
    EXPECT_TRUE(says("none.log: cannot be opened: ")) << shop.err;
}

TEST_F(WatchCommand, ATraceWithoutAGuardIsPlayedWithTheNextStep) {
    (void)shop.write("clear.ngc", "G1 X10 F3000\nM2\n");
    const std::string machine = " '" + std::string(test::kPaperMachine) + "' ";
    ASSERT_EQ(shop.run("simulate" + machine + "clear.ngc -o board.log"), kExitClean) << shop.err;
    watch("--trace board.log");
    EXPECT_TRUE(says("note: board.log: no frame of the guard")) << shop.err;
    const std::size_t begin = shop.err.find("axguard replay ");
    ASSERT_NE(begin, std::string::npos) << shop.err;
    const std::string next = shop.err.substr(begin + 8, shop.err.find(", then", begin) - begin - 8);
    ASSERT_EQ(shop.run(next), kExitClean) << next << shop.err;
    watch("--trace board.log --trace guard.log");
    EXPECT_FALSE(says("note: ")) << shop.err;
    watch("--trace guard.log");
    EXPECT_TRUE(says("note: guard.log: no position of the board")) << shop.err;
    watch("--trace - < board.log");
    EXPECT_TRUE(says("-: read to its end first")) << shop.err;
}

}  // namespace
}  // namespace axg
