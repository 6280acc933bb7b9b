// SPDX-License-Identifier: Apache-2.0
// Values that no option can mean, whatever a library's number reader makes of them. Runs the
// programs themselves.
#include <gtest/gtest.h>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

TEST(OptionValues, NanAndNegativeCountsAreRefused) {
    Workshop shop;
    (void)shop.write("p.ngc", "G0 X1\nM2\n");
    ASSERT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o t.log"), kExitClean) << shop.err;
    const std::string replay = "replay " + kPaperMachine + " t.log ";
    for (const char* const options :
         {"--arm-at nan", "--arm-at -nan", "--csv a.csv --within nan", "--arm-at inf"}) {
        EXPECT_EQ(shop.run(replay + options), kExitUsage) << options;
    }
    const std::string drive = "drive " + kPaperMachine + " p.ngc ";
    for (const char* const options : {"--seed -1", "--seed=-1", "--seed x"}) {
        EXPECT_EQ(shop.run(drive + options), kExitUsage) << options;
    }
    EXPECT_EQ(shop.run("check " + kPaperMachine + " --sms -1"), kExitUsage);
    EXPECT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o a.log --blend-mm nan"), kExitUsage);
    EXPECT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o a.log --max-moves -1"), kExitUsage);
    EXPECT_EQ(shop.run(drive + "--seed 7"), kExitClean) << shop.err;
    EXPECT_EQ(shop.run(replay + "--arm-at 0"), kExitClean) << shop.err;
}

TEST(OptionValues, AFaultGivenTwiceIsRefused) {
    Workshop shop;
    (void)shop.write("p.ngc", "G0 X1\nM2\n");
    const std::string drive = "drive " + kPaperMachine + " p.ngc --faults ";
    EXPECT_EQ(shop.run(drive + "killed=1,killed=2"), kExitUsage);
    EXPECT_NE(shop.err.find("--faults: killed: given twice."), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run(drive + "lost=0,late=0"), kExitClean) << shop.err;
}

}  // namespace
}  // namespace axg::test
