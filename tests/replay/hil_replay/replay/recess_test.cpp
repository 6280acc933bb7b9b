// SPDX-License-Identifier: Apache-2.0
// The cutter in the recess of the example's plate, as in any bore or pocket: the pair needs more
// than its part of a first stage, and most of its stop's box is clear. Runs axguard itself.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

constexpr double kFloorZMm = -272;  // where the tool touches the floor of the recess

class Recess : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    /// What replay says of such motion, from positions alone and with the plan of the file.
    Json replayed(const std::string& moves, int wanted) {
        const std::string machine = source_file("config/machines/paper-trunnion.yaml");
        const std::string program =
            shop.write("recess.ngc", "G21 G90\nT1 M6\nG0 X0 Y0\n" + moves + "M2\n");
        EXPECT_EQ(shop.run("simulate " + machine + " " + program + " -o trace.log"), kExitClean)
            << shop.err;
        EXPECT_EQ(shop.run("replay " + machine +
                           " trace.log --engine cpu --deadline-us 10000000 --json=end.json"),
                  wanted)
            << shop.out << shop.err;
        return Json::parse(content_of(shop.file("end.json")));
    }

    Workshop shop;
};

TEST_F(Recess, HasPermitsOneMillimetreAboveItsFloor) {
    for (const char* above_mm : {"263", "260", "270", "270.9"}) {
        const Json end = replayed(
            "G1 F5000 Z-220\nG1 F1000 Z-255\nG1 F100 Z-" + std::string(above_mm) + "\nG4 P0.2\n",
            kExitClean);
        EXPECT_EQ(end["stop_count"], 0) << above_mm;
    }
}

// As low as with endless lists (docs/measurements/bounded-cycle.md): the rest is the uncertainty of
// its speed. Without the second time for whole boxes it stopped 26.3, 18.0 and 13.6 mm above.
TEST_F(Recess, IsEnteredAsFarAsAStopNeeds) {
    const struct {
        const char* feed;
        double above_mm;
    } kDown[] = {{"10000", 15.7}, {"5000", 6.8}, {"1000", 1.8}};
    for (const auto& [feed, above_mm] : kDown) {
        const Json end =
            replayed("G1 F5000 Z-200\nG1 Z-300 F" + std::string(feed) + "\n", kExitCollision);
        ASSERT_EQ(end["stop_count"], 1) << feed;
        EXPECT_EQ(end["stops"][0]["pair"], "cutter-c");
        EXPECT_LT(end["stops"][0]["axes"]["Z_mm"].get<double>(), kFloorZMm + above_mm) << feed;
    }
}

}  // namespace
}  // namespace axg::test
