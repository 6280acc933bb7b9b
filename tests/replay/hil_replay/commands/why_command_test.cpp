// SPDX-License-Identifier: Apache-2.0
// What `axguard replay` and `axguard drive` state about the distance of a stop: of the shipped
// program that collides, predicted and in contact mode; of a machine that never gets a permit; and
// nothing at all of a stop that is about no distance. Runs the program itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <memory>
#include <regex>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

class WhyCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<Workshop>();
        ASSERT_EQ(shop->run("simulate " + kPaperMachine + " " + kDemoProgram + " -o demo.log"),
                  kExitClean)
            << shop->err;
    }
    static void TearDownTestSuite() { shop.reset(); }

    static Json replayed(const std::string& arguments, int wanted_code) {
        EXPECT_EQ(
            shop->run("replay " + arguments + " --details --deadline-us 10000000 --json=out.json"),
            wanted_code)
            << shop->out << shop->err;
        return Json::parse(content_of(shop->file("out.json")));
    }
    /// The paper's machine with this margin of all pairs.
    static std::string machine_with_margin(double margin_mm) {
        const std::string whole = content_of(kPaperMachine);
        const std::string changed = std::regex_replace(whole, std::regex("margin_mm: 0"),
                                                       "margin_mm: " + std::to_string(margin_mm));
        EXPECT_NE(changed, whole);
        return shop->write("margin.yaml", changed) + " --mesh-root " +
               source_file("config/machines");
    }
    static double number(const Json& why, const char* key) {
        return why.contains(key) ? why[key].get<double>() : -1;
    }
    static bool says(const std::string& text) { return shop->out.find(text) != std::string::npos; }

    static std::unique_ptr<Workshop> shop;
};

std::unique_ptr<Workshop> WhyCommand::shop;

double sum_of_parts(const Json& why) {
    double sum = 0;
    for (const char* key : {"margin_mm", "arithmetic_mm", "until_braking_mm", "braking_mm",
                            "position_error_mm", "speed_uncertainty_mm"}) {
        sum += why[key].get<double>();
    }
    return sum;
}

TEST_F(WhyCommand, APredictedStopNeedsMoreThanThereIs) {
    const Json all = replayed(kPaperMachine + " demo.log", kExitCollision);
    const Json& stop = all["stops"].at(0);
    ASSERT_EQ(stop["reason"], "predicted");
    const Json& why = stop["why"];
    EXPECT_EQ(why["pair"], stop["pair"]);
    EXPECT_GT(number(why, "needed_mm"), number(why, "available_mm"));
    EXPECT_NEAR(number(why, "needed_mm"), sum_of_parts(why), 1e-9);
    EXPECT_GT(number(why, "until_braking_mm"), 0);
    EXPECT_GT(number(why, "braking_mm"), 0);
    EXPECT_LE(number(why, "worst_mm"), number(why, "available_mm"));
    EXPECT_NEAR(number(why, "available_mm"), stop["pairs"].at(0)["clearance_mm"].get<double>(),
                1e-6)
        << "the nearest pair is the one of the stop";
    const double share = number(why["remedies"], "speed_share");
    EXPECT_GT(share, 0.5);
    EXPECT_LT(share, 1);
    ASSERT_EQ(why["reach_bodies"].size(), 2U);
    for (const auto& [axis, position] : stop["axes"].items()) {
        EXPECT_LE(why["reach"][axis][0], position.get<double>()) << axis;
        EXPECT_GE(why["reach"][axis][1], position.get<double>()) << axis;
    }
    EXPECT_TRUE(says("\n  why (" + why["cause"].get<std::string>() + "): ")) << shop->out;
    EXPECT_FALSE(says(" % of this speed")) << "no advice, as a later sample may need less";
}

// In contact mode the bodies touch: a margin of 0 has no smaller one.
TEST_F(WhyCommand, AContactHasNoDistanceLeft) {
    const Json all = replayed(kPaperMachine + " demo.log --mode contact", kExitCollision);
    const Json& why = all["stops"].at(0)["why"];
    EXPECT_EQ(why["cause"], "margin");
    EXPECT_EQ(number(why, "margin_mm"), 0);
    EXPECT_EQ(number(why, "available_mm"), 0);
    EXPECT_GT(number(why, "needed_mm"), 0) << "arithmetic";
    EXPECT_TRUE(why["remedies"].empty());
    EXPECT_FALSE(why.contains("reach_bodies"));
    EXPECT_TRUE(says("has none\n    margin 0, arithmetic ")) << shop->out;
}

TEST_F(WhyCommand, WithAMarginOfContactModeASmallerOneIsNamed) {
    const Json all = replayed(machine_with_margin(3) + " demo.log --mode contact", kExitCollision);
    const Json& why = all["stops"].at(0)["why"];
    EXPECT_EQ(why["cause"], "margin");
    const double available_mm = number(why, "available_mm");
    EXPECT_LT(available_mm, number(why, "needed_mm"));
    EXPECT_NEAR(number(why["remedies"], "margin_mm"), available_mm, 2e-3);
}

// The axes stand half a millimetre above the plate: the worst case of a reach takes more than that,
// at rest too.
TEST_F(WhyCommand, APermitThatNeverComesNamesPairNeedAndAvailable) {
    const std::string start = " --start 'X0 Y107.132 Z-222.9 A-19.1943 C97.0863' ";
    const std::string program = shop->write("rest.ngc", "T1 M6\nG4 P0.5\nM2\n");
    ASSERT_EQ(shop->run("simulate " + kPaperMachine + " " + program + start + "-o rest.log"),
              kExitClean)
        << shop->err;
    const Json all = replayed(kPaperMachine + " rest.log", kExitCollision);
    EXPECT_EQ(all["permits"], 0);
    ASSERT_TRUE(all.contains("kept_back"));
    const Json& why = all["kept_back"]["why"];
    EXPECT_EQ(why["pair"], all["kept_back"]["pair"]);
    EXPECT_NEAR(number(why, "available_mm"), 0.535, 0.01);
    EXPECT_GT(number(why, "needed_mm"), number(why, "available_mm"));
    EXPECT_NEAR(number(why, "needed_mm"), sum_of_parts(why), 1e-9);
    EXPECT_TRUE(says("NO PERMIT from") && says("\n  why (") && says("needs ")) << shop->out;
    EXPECT_LT(shop->out.find("NO PERMIT from"), shop->out.find("\n  why ("));
    EXPECT_EQ(shop->run("drive " + kPaperMachine + " " + program + start + "--json=d.json"),
              kExitCollision);
    const Json drive = Json::parse(content_of(shop->file("d.json")));
    EXPECT_EQ(drive["guard_stop"]["why"]["pair"], why["pair"]);
    EXPECT_NEAR(number(drive["guard_stop"]["why"], "available_mm"), number(why, "available_mm"),
                0.02);
}

TEST_F(WhyCommand, AStopAboutNoDistanceHasNoWhy) {
    const std::string whole = content_of(kPaperMachine);
    const std::string slow =
        shop->write("slow.yaml", std::regex_replace(whole, std::regex("acceleration_mm_s2: [0-9]+"),
                                                    "acceleration_mm_s2: 400")) +
        " --mesh-root " + source_file("config/machines");
    const Json limits = replayed(slow + " demo.log", kExitCollision);
    EXPECT_EQ(limits["stops"].at(0)["reason"], "left_limits");
    EXPECT_FALSE(limits["stops"].at(0).contains("why"));
    EXPECT_FALSE(says("why ("));
    const std::string log = content_of(shop->file("demo.log"));
    const std::size_t middle = log.find('\n', log.size() / 2);
    std::size_t later = middle;
    for (int line = 0; line < 400; ++line) {
        later = log.find('\n', later + 1);
    }
    (void)shop->write("hole.log", log.substr(0, middle) + log.substr(later));
    const Json hole = replayed(kPaperMachine + " hole.log", kExitCollision);
    ASSERT_GE(hole["stops"].size(), 1U);
    EXPECT_FALSE(hole["stops"].at(0).contains("why")) << hole["stops"].at(0).dump(1);
    EXPECT_FALSE(says("why ("));
}

}  // namespace
}  // namespace axg::test
