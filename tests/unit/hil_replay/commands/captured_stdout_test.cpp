// SPDX-License-Identifier: Apache-2.0
// All that is written to stdout meanwhile, by whichever call, and nothing before or after.
#include "hil_replay/commands/captured_stdout.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

namespace axg {
namespace {

TEST(CapturedStdout, TakesWhatIsPrintedMeanwhileOnly) {
    testing::internal::CaptureStdout();
    std::printf("before ");
    const std::string long_text(100'000, 'x');
    const std::string taken = captured_stdout([&] {
        std::printf("taken %s", long_text.c_str());
        std::fflush(stdout);
        EXPECT_EQ(write(STDOUT_FILENO, " raw", 4), 4);
    });
    std::printf("after");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "before after");
    EXPECT_EQ(taken, "taken " + long_text + " raw");
}

TEST(CapturedStdout, OfNothingIsEmpty) {
    EXPECT_EQ(captured_stdout([] {}), "");
}

}  // namespace
}  // namespace axg
