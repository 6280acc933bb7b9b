// SPDX-License-Identifier: Apache-2.0
// What axguard check prints of exclusions, and when it is a line to review.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/commands/commands.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

std::string file_of(const char* end) {
    return testing::TempDir() + "axg_exclusions_" + std::to_string(getpid()) + end;
}
std::string json_file() {
    return file_of(".json");
}

/// What check prints of this machine.
std::string check(const std::string& text) {
    std::ofstream(file_of(".yaml")) << text;
    CommandLine line({.name = "axguard", .purpose = "", .version = ""});
    add_check(line);
    testing::internal::CaptureStdout();
    EXPECT_EQ(line.parse({"check", file_of(".yaml"), "--json=" + json_file()}), kExitClean);
    std::fflush(stdout);
    return testing::internal::GetCapturedStdout();
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// A carriage that leaves its rail at the end of the travel: an exclusion that hides a contact is
// reviewed until the file explains it; one that hides none, or a permanent one, is not.
TEST(CheckExclusions, AContactThatIsHiddenIsReviewedUntilItIsExplained) {
    const std::string machine = R"(version: 1
name: rail
axes:
  X: {kind: linear, travel_mm: [-100, 100], speed_mm_min: 6000, acceleration_mm_s2: 1000,
      jerk_mm_s3: 20000, stopping_mm_s2: 800, position_error_mm: 0.001, following_error_mm: 0}
bodies:
  - {name: rail, mesh: {shapes: [{box_mm: [400, 20, 20], at_mm: [0, 0, -20]}]}}
  - {name: wall, mesh: {shapes: [{box_mm: [10, 20, 20], at_mm: [500, 0, 0]}]}}
  - {name: carriage, axis: X, direction: [1, 0, 0], mesh: {shapes: [{box_mm: [60, 60, 25]}]}}
pairs:
  - {a: wall, b: carriage, margin_mm: 1}
exclusions:
  - {a: rail, b: wall, reason: both are fixed}
  - {a: rail, b: carriage, reason: guides}
)";
    std::string out = check(machine);
    EXPECT_TRUE(has(out, "  rail-wall                never nearer than ")) << out;
    EXPECT_TRUE(has(out, "  rail-carriage            in contact at every place\n")) << out;
    EXPECT_FALSE(has(out, "exclusion of")) << out;

    const std::string leaving = with(machine, "box_mm: [400, 20, 20]", "box_mm: [140, 20, 20]");
    out = check(leaving);
    EXPECT_TRUE(has(out, "exclusion of rail and carriage: meets at X 0 and is apart at X ")) << out;
    const auto item = Json::parse(content_of(json_file()))["exclusions"][1];
    EXPECT_EQ(item["over_travel"], "both");
    EXPECT_EQ(item["meets_at"]["X"], 0);
    EXPECT_GT(std::fabs(item["apart_at"]["X"].get<double>()), 100);

    const std::string because = ", because: it is taken off there}";
    out = check(with(leaving, "reason: guides}", "reason: guides" + because));
    EXPECT_FALSE(has(out, "exclusion of")) << out;
    EXPECT_TRUE(has(out, "; because it is taken off there\n")) << out;
    out = check(with(machine, "reason: guides}", "reason: guides" + because));
    EXPECT_TRUE(has(out, "in contact at every place, so because explains nothing. Remove it."))
        << out;
    std::remove(json_file().c_str());
    std::remove(file_of(".yaml").c_str());
}

}  // namespace
}  // namespace axg::test
