// SPDX-License-Identifier: Apache-2.0
// A trace beside the limits of the machine file: within them replay stops nowhere and shows what
// was used; where the file declares less, replay stops and names axis and figure, and inspect
// proposes limits with which the same trace is clean.
#include <gtest/gtest.h>

#include <memory>
#include <regex>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

class Limits : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<Workshop>();
        const std::string program =
            shop->write("brief.ngc", "T1 M6\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nG0 X-20\nM2\n");
        ASSERT_EQ(shop->run("simulate " + kPaperMachine + " " + program + " -o trace.log"),
                  kExitClean)
            << shop->err;
    }
    static void TearDownTestSuite() { shop.reset(); }

    /// The paper's machine with other text in place of what the pattern finds.
    static std::string machine_with(const std::string& name, const std::string& pattern,
                                    const std::string& text) {
        const std::string whole = content_of(kPaperMachine);
        const std::string changed = std::regex_replace(whole, std::regex(pattern), text);
        EXPECT_NE(changed, whole) << pattern;
        return shop->write(name, changed) + " --mesh-root " + source_file("config/machines");
    }
    static Json replayed(const std::string& machine, int wanted_code) {
        EXPECT_EQ(shop->run("replay " + machine + " trace.log --details --json=out.json"),
                  wanted_code)
            << shop->out << shop->err;
        return Json::parse(content_of(shop->file("out.json")));
    }

    static std::unique_ptr<Workshop> shop;
};

std::unique_ptr<Workshop> Limits::shop;

TEST_F(Limits, AHealthyTraceStopsNowhereAndShowsWhatItUsed) {
    const Json all = replayed(kPaperMachine, kExitClean);
    EXPECT_EQ(all["stop_count"], 0);
    const Json& x = all["limits"]["X"];
    for (const char* limit : {"speed", "acceleration", "jerk"}) {
        EXPECT_LE(x[limit]["measured"], x[limit]["declared"]) << limit;
        EXPECT_EQ(x[limit]["samples_above"], 0) << limit;
    }
    EXPECT_GT(x["speed"]["measured"], 50);
    EXPECT_GT(x["acceleration"]["measured"], 500);
    EXPECT_EQ(x["acceleration"]["unit"], "mm/s2");
    EXPECT_EQ(all["limits"]["C"]["speed"]["unit"], "deg/s");
    EXPECT_NE(shop->out.find("samples above"), std::string::npos) << shop->out;
}

TEST_F(Limits, AnAxisAtFiveTimesItsDeclaredAccelerationIsAStop) {
    const std::string slow =
        machine_with("slow.yaml", "acceleration_mm_s2: ([0-9]+)", "acceleration_mm_s2: 400");
    const Json all = replayed(slow, kExitCollision);
    ASSERT_GT(all["stop_count"], 0);
    const Json& stop = all["stops"][0];
    EXPECT_EQ(stop["reason"], "left_limits");
    EXPECT_EQ(stop["limit"]["kind"], "acceleration");
    EXPECT_EQ(stop["limit"]["declared"], 400);
    EXPECT_GT(stop["limit"]["measured"], 400);
    EXPECT_EQ(stop["limit"]["unit"], "mm/s2");
    EXPECT_NE(
        shop->out.find("axis " + stop["limit"]["axis"].get<std::string>() + ": acceleration "),
        std::string::npos)
        << shop->out;
    EXPECT_NE(shop->out.find("declared 400 mm/s2. Correct the limits"), std::string::npos);
}

TEST_F(Limits, WhatInspectProposesIsEnoughForTheTrace) {
    const std::string slow =
        machine_with("low.yaml", "acceleration_mm_s2: ([0-9]+)", "acceleration_mm_s2: 400");
    const std::string file = slow.substr(0, slow.find(' '));
    ASSERT_EQ(shop->run("inspect trace.log --limits --machine " + file + " --json=limits.json"),
              kExitClean)
        << shop->err;
    const Json all = Json::parse(content_of(shop->file("limits.json")))["machine"];
    EXPECT_GT(all["limits"]["X"]["acceleration"]["samples_above"], 0);
    EXPECT_NE(shop->out.find("proposed for the machine file"), std::string::npos) << shop->out;
    EXPECT_TRUE(std::regex_search(
        shop->out, std::regex("  X: \\{.*\\}  # trace.log, [0-9]+ samples: at most [0-9.]+ mm/s2, "
                              "times 1\\.[1-2][0-9]?  # not")))
        << shop->out;
    const std::size_t unknown = shop->out.find("# not in this trace: ");
    ASSERT_NE(unknown, std::string::npos);
    EXPECT_NE(shop->out.find("stopping_mm_s2", unknown), std::string::npos) << shop->out;
    const Json& proposed = all["proposed_limits"]["X"];
    const auto measured = all["limits"]["X"]["acceleration"]["measured"].get<double>();
    EXPECT_GE(proposed["acceleration_mm_s2"], 1.1 * measured);
    EXPECT_LE(proposed["acceleration_mm_s2"], 1.5 * measured) << "errors are not taken off";
    EXPECT_TRUE(proposed["stopping_mm_s2"].is_null());
    double most = 0;
    for (const char* axis : {"X", "Y", "Z"}) {
        most = std::max(most, all["proposed_limits"][axis]["acceleration_mm_s2"].get<double>());
    }
    const std::string enough =
        machine_with("enough.yaml", "acceleration_mm_s2: ([0-9]+)",
                     "acceleration_mm_s2: " + std::to_string(static_cast<int>(most)));
    EXPECT_EQ(replayed(enough, kExitClean)["stop_count"], 0);
}

// The guard would stop at the first such step and see no more of it; who measures takes it.
TEST_F(Limits, InspectMeasuresASpeedThatIsAJumpToTheGuard) {
    const std::string slow =
        machine_with("crawl.yaml", "speed_mm_min: ([0-9]+)", "speed_mm_min: 600");
    const std::string file = slow.substr(0, slow.find(' '));
    ASSERT_EQ(shop->run("inspect trace.log --machine " + file + " --json=limits.json"), kExitClean)
        << shop->err;
    const Json all = Json::parse(content_of(shop->file("limits.json")))["machine"];
    double fastest = 0;
    for (const char* axis : {"X", "Y", "Z"}) {
        fastest = std::max(fastest, all["limits"][axis]["speed"]["measured"].get<double>());
    }
    EXPECT_GT(fastest, 50) << "five times what is declared";
}

TEST_F(Limits, ProposalsNeedAMachine) {
    EXPECT_EQ(shop->run("inspect trace.log --limits"), kExitUsage);
    EXPECT_NE(shop->err.find("--limits: missing option --machine"), std::string::npos);
}

}  // namespace
}  // namespace axg::test
