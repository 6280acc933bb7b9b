// SPDX-License-Identifier: Apache-2.0
// The first word a person types: a command, or the names of those there are.
#include "hil_replay/commands/axguard.hpp"

#include <gtest/gtest.h>

#include "firmware_if/cli/exit_codes.hpp"

namespace axg {
namespace {

struct Typed {
    int exit_code;
    std::string err;
};

Typed type(const std::vector<std::string>& words) {
    testing::internal::CaptureStderr();
    const int exit_code = run_axguard(words);
    return {exit_code, testing::internal::GetCapturedStderr()};
}

TEST(Axguard, AnUnknownCommandIsAnsweredWithThoseThereAre) {
    const Typed typed = type({"replya", "m.yaml", "t.log"});
    EXPECT_EQ(typed.exit_code, kExitUsage);
    EXPECT_NE(typed.err.find(
                  "invalid command (found \"replya\", expected one of demo, init, check, compile"),
              std::string::npos)
        << typed.err;
    EXPECT_NE(typed.err.find("Did you mean replay?"), std::string::npos) << typed.err;
    EXPECT_EQ(type({"xylophone"}).err.find("Did you mean"), std::string::npos);
}

TEST(Axguard, NoCommandIsAUsageError) {
    const Typed typed = type({});
    EXPECT_EQ(typed.exit_code, kExitUsage);
    EXPECT_NE(typed.err.find("invalid command (found nothing"), std::string::npos) << typed.err;
}

TEST(Axguard, AKnownCommandIsLeftToItself) {
    const Typed typed = type({"replay"});
    EXPECT_EQ(typed.exit_code, kExitUsage);
    EXPECT_EQ(typed.err.find("invalid command"), std::string::npos) << typed.err;
    testing::internal::CaptureStdout();
    EXPECT_EQ(type({"--version"}).exit_code, kExitClean);
    EXPECT_NE(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace axg
