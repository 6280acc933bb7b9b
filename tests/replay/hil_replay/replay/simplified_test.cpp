// SPDX-License-Identifier: Apache-2.0
// A machine whose engines get simplified surfaces: check says at what price, replay stops at the
// same sample or before, and a body inside another one is found all the same.
#include <gtest/gtest.h>

#include <string>

#include "config/mesh/simplify_meshes.hpp"
#include "core/mesh/stl.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/round_solids.hpp"

namespace axg::test {
namespace {

constexpr double kDeviationMm = 0.3;

/// A ball of 4,800 triangles that the cutter comes down on, and then would be inside of.
constexpr const char* kBallMachine = R"(version: 1
name: ball
axes:
  Z: {kind: linear, travel_mm: [-200, 200], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
bodies:
  - {name: ball, mesh: {file: ball.stl, unit: mm@SIMPLIFY@}, at_mm: [0, 0, @AT@]}
  - {name: slide, axis: Z, direction: [0, 0, 1]}
  - {name: cutter, parent: slide, tool: true}
tools:
  - {number: 1, length_mm: 1, profile_mm: [[0, -0.1], [0.1, -0.1], [0.1, 0.1], [0, 0.1]]}
pairs:
  - {a: cutter, b: ball, margin_mm: 0.5}
)";

class Simplified : public testing::Test {
  protected:
    void SetUp() override {
        if (simplify({"ball", kBall}, kDeviationMm).deviation_mm == 0) {
            GTEST_SKIP() << "skipped: built without libmeshoptimizer";
        }
        const std::vector<std::byte> bytes = write_stl(kBall);
        (void)shop_.write("ball.stl", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        write("whole.yaml", "");
        write("simple.yaml", ", simplify_mm: 0.3");
    }
    void write(const std::string& name, const std::string& key,
               const std::string& ball_at = "-100") const {
        std::string text = kBallMachine;
        text.replace(text.find("@AT@"), 4, ball_at);
        (void)shop_.write(name, text.replace(text.find("@SIMPLIFY@"), 10, key));
    }
    Json report_of(const std::string& command, int wanted) {
        EXPECT_EQ(shop_.run(command + " --json=r.json"), wanted) << shop_.out << shop_.err;
        return Json::parse(content_of(shop_.file("r.json")));
    }

    const Triangles kBall = ball(20, 40);
    Workshop shop_;
};

TEST_F(Simplified, CheckSaysAtWhatPrice) {
    const Json check = report_of("check simple.yaml", 0);
    ASSERT_EQ(check.at("notes").size(), 1U);
    const auto note = check.at("notes").at(0).get<std::string>();
    EXPECT_NE(note.find("bodies.ball.mesh: "), std::string::npos) << note;
    EXPECT_NE(note.find(" of 4800 triangles"), std::string::npos) << note;
    const SimplifiedMesh simple = simplify({"ball", kBall}, kDeviationMm);
    const auto expect_behind = [&note](const std::string& before, double true_mm) {
        ASSERT_NE(note.find(before), std::string::npos) << note;
        const double printed_mm = std::stod(note.substr(note.find(before) + before.size()));
        EXPECT_GE(printed_mm, true_mm) << note;
        EXPECT_LT(printed_mm, true_mm + 2e-4) << note;
    };
    expect_behind("deviation at most ", simple.deviation_mm);
    expect_behind("excess at most ", simple.excess_mm);
    EXPECT_EQ(check.at("bodies").at(0).at("mesh").at("triangles"), 4800);
    EXPECT_NE(check.at("configuration_sha256"),
              report_of("check whole.yaml", 0).at("configuration_sha256"));
}

TEST_F(Simplified, StopsAtTheSameSampleOrBefore) {
    (void)shop_.write("down.ngc", "G21 G90\nG1 Z-90 F6000\nM2\n");
    ASSERT_EQ(shop_.run("simulate whole.yaml down.ngc -o down.log"), 0) << shop_.err;
    for (const std::string mode : {"contact", "stoppable"}) {
        const auto stop_of = [&](const std::string& machine) {
            return report_of("replay " + machine + " down.log --deadline-us 1000000 --mode " + mode,
                             10)
                .at("stops")
                .at(0);
        };
        const Json whole = stop_of("whole.yaml"), simple = stop_of("simple.yaml");
        ASSERT_GT(whole.at("sample"), 100);
        EXPECT_EQ(whole.at("reason"), simple.at("reason"));
        EXPECT_LE(simple.at("sample"), whole.at("sample")) << mode;
        // 0.1 mm a sample, and stopping sets in where it is fast: a few samples.
        EXPECT_GE(simple.at("sample").get<int>() + 20, whole.at("sample").get<int>()) << mode;
        const double difference_mm = simple.at("pairs").at(0).at("clearance_mm").get<double>() -
                                     whole.at("pairs").at(0).at("clearance_mm").get<double>();
        std::printf("%s: sample %d in place of %d, clearance %+.4f mm\n", mode.c_str(),
                    simple.at("sample").get<int>(), whole.at("sample").get<int>(), difference_mm);
    }
}

/// Of a trace that begins inside the ball nothing but the insides tells.
TEST_F(Simplified, InsideIsInside) {
    (void)shop_.write("in.ngc", "G21 G90\nG1 Z5 F600\nM2\n");
    ASSERT_EQ(shop_.run("simulate whole.yaml in.ngc -o in.log"), 0) << shop_.err;
    write("whole.yaml", "", "0");
    write("simple.yaml", ", simplify_mm: 0.3", "0");
    for (const std::string machine : {"whole.yaml", "simple.yaml"}) {
        const Json report =
            report_of("replay " + machine + " in.log --mode contact --deadline-us 1000000", 10);
        EXPECT_EQ(report.at("permits"), 0) << report.dump(2);
    }
}

TEST_F(Simplified, TooCoarseIsRefused) {
    write("coarse.yaml", ", simplify_mm: 0.5");
    EXPECT_EQ(shop_.run("check coarse.yaml"), 3);
    EXPECT_NE(shop_.err.find("bodies.ball.mesh.simplify_mm: invalid value (found \"0.5\""),
              std::string::npos)
        << shop_.err;
}

}  // namespace
}  // namespace axg::test
