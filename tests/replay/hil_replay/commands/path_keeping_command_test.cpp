// SPDX-License-Identifier: Apache-2.0
// The example programs on a machine whose board sends a look-ahead path and stops along it:
// `axguard simulate`, `replay`, `drive` and `check`. Runs the program itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <memory>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr const char* kLookAhead = "  format: fd\n  ahead: {samples: 300}\n";

class PathKeepingCommand : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
        std::string text = test::content_of(test::kPaperMachine);
        const std::string guard = "guard:\n";
        const std::size_t at = text.find(guard);
        ASSERT_NE(at, std::string::npos);
        (void)shop.write("free.yaml", test::with_can(text, kLookAhead));
        text.insert(at + guard.size(), "  promise: path_keeping\n");
        (void)shop.write("keeps.yaml", test::with_can(text, kLookAhead));
    }
    int run(const std::string& command, const std::string& machine, const std::string& rest) {
        return shop.run(command + ' ' + shop.file(machine) + " --mesh-root " +
                        test::source_file("config/machines") + ' ' + rest);
    }
    int replay(const std::string& machine, const std::string& trace, const std::string& json) {
        return run("replay", machine, trace + " --deadline-us 10000000 --json=" + json);
    }
    test::Json document(const std::string& name) {
        return test::Json::parse(test::content_of(shop.file(name)));
    }
    test::Workshop shop;
};

// As soon as the path is known as far as a stop needs it, the permit is there, and stays.
TEST_F(PathKeepingCommand, TheCleanProgramKeepsItsPermit) {
    ASSERT_EQ(run("simulate", "keeps.yaml", test::kCleanProgram + " -o clean.log"), kExitClean)
        << shop.err;
    EXPECT_EQ(replay("keeps.yaml", "clean.log", "clean.json"), kExitClean) << shop.out << shop.err;
    const auto all = document("clean.json");
    EXPECT_EQ(all["stop_count"], 0);
    EXPECT_EQ(all["receiver_faults"].size(), 0U) << all["receiver_faults"];
    EXPECT_GE(all["permits"].get<long>() + 313, all["samples"].get<long>());
    EXPECT_LT(all["permits"].get<long>() + 290, all["samples"].get<long>())
        << "before the buffer of the board is full nothing can be known";
}

// What both promises say of the same frames: along the path the stop is far later, and in time.
TEST_F(PathKeepingCommand, StopsLaterThanABoxAndBeforeTheContact) {
    ASSERT_EQ(run("simulate", "keeps.yaml", test::kDemoProgram + " -o demo.log"), kExitClean)
        << shop.err;
    ASSERT_EQ(replay("keeps.yaml", "demo.log", "keeps.json"), kExitCollision) << shop.out;
    ASSERT_EQ(replay("free.yaml", "demo.log", "free.json"), kExitCollision) << shop.out;
    ASSERT_EQ(replay("free.yaml", "demo.log --mode contact", "contact.json"), kExitCollision);
    const auto keeps = document("keeps.json")["stops"].at(0);
    const auto free = document("free.json")["stops"].at(0);
    const auto contact = document("contact.json")["stops"].at(0);
    EXPECT_EQ(keeps["reason"], "predicted");
    EXPECT_EQ(keeps["pair"], contact["pair"]);
    EXPECT_LT(free["time_us"], keeps["time_us"]);
    EXPECT_LT(keeps["time_us"], contact["time_us"]);
    EXPECT_GT(keeps["pairs"].at(0)["clearance_mm"].get<double>(), 0);
    // A path is one whole: its reach has no parts, and no speed is named that would be proven.
    EXPECT_GT(keeps["why"]["to_standstill_mm"].get<double>(), 0) << keeps.dump(1);
    EXPECT_FALSE(keeps["why"].contains("braking_mm") ||
                 keeps["why"]["remedies"].contains("speed_share"))
        << keeps.dump(1);
}

TEST_F(PathKeepingCommand, TheBoardOfTheLoopStopsAlongItsPath) {
    EXPECT_EQ(run("drive", "keeps.yaml", test::kDemoProgram + " --json=drive.json"), kExitCollision)
        << shop.out << shop.err;
    const auto driven = document("drive.json");
    EXPECT_EQ(driven["guard_stop"]["reason"], "predicted");
    EXPECT_GT(driven["guard_stop"]["why"]["to_standstill_mm"].get<double>(), 0);
    EXPECT_EQ(driven["state"], "stopped");
    EXPECT_EQ(run("drive", "keeps.yaml", test::kCleanProgram + " --json=clean.json"), kExitClean)
        << shop.out << shop.err;
    EXPECT_EQ(document("clean.json")["state"], "finished");
}

TEST_F(PathKeepingCommand, CheckShowsHowFarABoardMustLookAhead) {
    ASSERT_EQ(run("check", "keeps.yaml", "--json=check.json"), kExitClean) << shop.err;
    const auto guard = document("check.json")["guard"];
    EXPECT_EQ(guard["promise"], "path_keeping");
    EXPECT_EQ(guard["ahead_ms"], 300);
    // C needs longest: 240 deg/s at 1000 deg/s2, with 16000 deg/s3: 0.12 s and the ramp, and a
    // permit of 8 samples.
    const double ramp = 240.0 / 16000 / (2 * 0.24) - 0.015 * 0.015 / (24 * 0.24 * 0.24 * 0.24);
    EXPECT_NEAR(guard["ahead_needed_ms"].get<double>(), 10.1 + 1e3 * (0.12 + ramp), 1e-6);
    EXPECT_EQ(shop.out.find("increase can.ahead.samples"), std::string::npos);
}

}  // namespace
}  // namespace axg
