// SPDX-License-Identifier: Apache-2.0
// axguard check --plan on a machine whose ball has more triangles than it needs: the models it
// measures, what it chooses, and that the lines it prints load and keep what they promise.
// ctest-labels: long rare core.worst_case firmware_if.setup
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>

#include "config/mesh/simplify_meshes.hpp"
#include "core/mesh/stl.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/round_solids.hpp"

namespace axg::test {
namespace {

/// A ball of 4,800 triangles under a pin that comes down beside or onto it. Lists that no model
/// fills, and a deadline that every model meets on a busy machine, too.
constexpr const char* kMachine = R"(version: 1
name: ball
deadline_us: 1000000
axes:
  X: {kind: linear, travel_mm: [-100, 100], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  Z: {kind: linear, travel_mm: [-200, 200], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
bodies:
  - {name: ball, mesh: {file: ball.stl, unit: mm@SIMPLIFY@}, at_mm: [0, 0, -100]}
  - {name: table, axis: X, direction: [1, 0, 0]}
  - {name: slide, parent: table, axis: Z, direction: [0, 0, 1]}
  - {name: cutter, parent: slide, tool: true}
tools:
  - {number: 1, length_mm: 1, profile_mm: [[0, -0.1], [0.1, -0.1], [0.1, 0.1], [0, 0.1]]}
first_tool: 1
cycle: {lists: {node_pairs: 65536, leaf_pairs: 65536, box_rows: 1048576, triangle_pairs: 1048576}}
pairs:
  - {a: cutter, b: ball, margin_mm: 0.5}
@LINES@)";

class CheckPlan : public testing::Test {
  protected:
    void SetUp() override {
        if (simplify({"ball", kBall}, 0.3).deviation_mm == 0) {
            GTEST_SKIP() << "skipped: built without libmeshoptimizer";
        }
        const std::vector<std::byte> bytes = write_stl(kBall);
        (void)shop_.write("ball.stl", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        write("whole.yaml", "", "");
    }
    void write(const std::string& name, const std::string& key, const std::string& lines) const {
        std::string text = kMachine;
        text.replace(text.find("@SIMPLIFY@"), 10, key);
        (void)shop_.write(name, text.replace(text.find("@LINES@"), 7, lines));
    }
    Json report_of(const std::string& command, int wanted) {
        EXPECT_EQ(shop_.run(command + " --json=r.json"), wanted) << shop_.out << shop_.err;
        return Json::parse(content_of(shop_.file("r.json")));
    }
    /// A plan that has chosen a coarser model: one is chosen where less time was measured, which a
    /// busy machine may hide. Null: it did so each time.
    Json plan_of(const std::string& options) {
        for (int i = 0; i < 4; ++i) {
            Json plan = report_of("check whole.yaml --plan --positions 60 --passes 1 " + options, 0)
                            .at("plan");
            if (plan.at("chosen") > 0) {
                return plan;
            }
        }
        return nullptr;
    }
    /// The line of what was printed that begins so, without its remark.
    [[nodiscard]] std::string line_of(const std::string& begin) const {
        const std::size_t at = shop_.out.find("\n    " + begin);
        EXPECT_NE(at, std::string::npos) << shop_.out;
        const std::size_t end = at == std::string::npos ? at : shop_.out.find("    #", at + 5);
        return at == std::string::npos ? "" : shop_.out.substr(at + 5, end - at - 5);
    }

    static constexpr const char* kNoGain = "skipped: measured four times, no model took less time";
    const Triangles kBall = ball(20, 40);
    Workshop shop_;
};

TEST_F(CheckPlan, ModelsGetCoarserAndTheCoarsestThatLosesNothingIsChosen) {
    const Json plan = plan_of("--output plan");
    if (plan.is_null()) {
        GTEST_SKIP() << kNoGain;
    }
    const Json& models = plan.at("models");
    ASSERT_GE(models.size(), 3U);
    EXPECT_EQ(models.at(0).at("simplify_mm"), 0);
    EXPECT_EQ(models.at(0).at("inflation_mm"), 0);
    EXPECT_GT(models.at(0).at("triangles"), 4800);  // the ball, and the pin
    for (std::size_t i = 0; i < models.size(); ++i) {
        const Json& model = models.at(i);
        EXPECT_LE(model.at("inflation_mm"), 2 * model.at("simplify_mm").get<double>());
        EXPECT_EQ(model.at("contact_us").at("cycles"), 60);
        EXPECT_EQ(model.at("rest_us").at("cycles"), 60);
        EXPECT_GT(model.at("rest_us").at("p50"), 0);
        EXPECT_GT(model.at("queries_most"), 0);
        EXPECT_EQ(model.at("over_capacity"), 0);
        if (i != 0) {
            EXPECT_LT(model.at("triangles"), models.at(i - 1).at("triangles"));
            EXPECT_GT(model.at("inflation_mm"), models.at(i - 1).at("inflation_mm"));
            EXPECT_GE(model.at("earlier_mm").at("max"), 0);
        }
    }
    ASSERT_GT(plan.at("approaches"), 0);
    EXPECT_GT(models.back().at("earlier_mm").at("p50"), 0);  // the price is seen
    const Json& chosen = models.at(plan.at("chosen").get<std::size_t>());
    EXPECT_EQ(chosen.at("contact_lost"), 0);
    EXPECT_EQ(chosen.at("rest_lost"), 0);
    EXPECT_EQ(plan.at("confirmed").at("contact_lost"), 0);
    const std::string csv = content_of(shop_.file("plan/plan.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + models.size());
    EXPECT_NE(content_of(shop_.file("plan/conditions.csv")).find("scene,"), std::string::npos);
    if (std::system("/usr/bin/python3 -c 'import matplotlib' >/dev/null 2>&1") == 0) {
        EXPECT_NE(content_of(shop_.file("plan/plan.svg")).find("contact mode, p99"),
                  std::string::npos);
    }
}

/// Pasted into the machine file, the lines give what was promised: fewer triangles, and of a trace
/// that the choice was told of no permit is lost.
TEST_F(CheckPlan, TheLinesLoadAndLoseNothingOfTheTrace) {
    (void)shop_.write("clear.ngc", "G21 G90\nG1 X70 F6000\nG1 Z-90 F6000\nG1 Z-20 F6000\nM2\n");
    ASSERT_EQ(shop_.run("simulate whole.yaml clear.ngc -o clear.log"), 0) << shop_.err;
    const Json plan = plan_of("--trace clear.log");
    if (plan.is_null()) {
        GTEST_SKIP() << kNoGain;
    }
    const Json& chosen = plan.at("models").at(plan.at("chosen").get<std::size_t>());
    EXPECT_GT(chosen.at("trace_us").at("cycles"), 1000);
    EXPECT_EQ(chosen.at("trace_lost"), 0);
    write("planned.yaml", ", " + line_of("simplify_mm: "), line_of("capacities: ") + "\n");
    const Json check = report_of("check planned.yaml", 0);
    EXPECT_EQ(check.at("engine").at("node_pairs"), plan.at("capacities").at("node_pairs"));
    ASSERT_EQ(check.at("notes").size(), 1U) << "the mesh is simplified";
    const std::string replay = " clear.log --keep-going --deadline-us 10000000 --engine cpu";
    const Json whole = report_of("replay whole.yaml" + replay, 0);
    const Json planned = report_of("replay planned.yaml" + replay, 0);
    EXPECT_GT(whole.at("permits"), 1000);
    EXPECT_EQ(planned.at("permits"), whole.at("permits"));
    EXPECT_EQ(planned.at("stop_count"), 0);
}

/// Every result that is counted as lost has its line, and lies where the ball is just far enough:
/// of surfaces, so inside it, too.
TEST_F(CheckPlan, WhatIsLostIsListed) {
    const Json plan =
        report_of("check whole.yaml --plan --positions 2000 --passes 1 -o plan", 0).at("plan");
    std::istringstream csv(content_of(shop_.file("plan/lost.csv")));
    std::string line;
    ASSERT_TRUE(std::getline(csv, line));
    EXPECT_EQ(line, "simplify_mm,what,sample,pair,X_mm,Z_mm");
    std::map<std::string, std::size_t> contacts;  // of a model
    std::size_t at_rest = 0;
    while (std::getline(csv, line)) {
        char model[16]{}, what[16]{};
        double x = 0, z = 0;
        ASSERT_EQ(
            std::sscanf(line.c_str(), "%15[^,],%15[^,],,cutter-ball,%lf,%lf", model, what, &x, &z),
            4)
            << line;
        // From the ball's surface, on either side: the margin, what the model leaves it by, and for
        // a certificate the way to a stop.
        const double away_mm = std::fabs(std::hypot(x, z + 100) - 40);
        const bool is_contact = std::string(what) == "contact";
        EXPECT_GT(away_mm, 0.5) << line;
        EXPECT_LT(away_mm, is_contact ? 2.5 : 10) << line;
        contacts[model] += is_contact ? 1 : 0;
        at_rest += is_contact ? 0 : 1;
    }
    std::size_t lost = 0, rest_lost = 0;
    for (const Json& model : plan.at("models")) {
        char name[16];
        std::snprintf(name, sizeof name, "%g", model.at("simplify_mm").get<double>());
        EXPECT_EQ(contacts[name], model.at("contact_lost")) << name;
        lost += model.at("contact_lost").get<std::size_t>();
        rest_lost += model.at("rest_lost").get<std::size_t>();
    }
    ASSERT_GT(lost, 0U) << "nothing was lost: nothing was shown";
    EXPECT_EQ(at_rest, rest_lost);
    EXPECT_NE(shop_.out.find("lost, 0.4 mm: cutter-ball at X "), std::string::npos) << shop_.out;
}

/// The order that docs/reference/plan.md gives: plan, paste, compile. What is compiled keeps the
/// promise.
TEST_F(CheckPlan, PlannedThenCompiled) {
    (void)shop_.write("clear.ngc", "G21 G90\nG1 X70 F6000\nG1 Z-90 F6000\nG1 Z-20 F6000\nM2\n");
    ASSERT_EQ(shop_.run("simulate whole.yaml clear.ngc -o clear.log"), 0) << shop_.err;
    if (plan_of("--trace clear.log").is_null()) {
        GTEST_SKIP() << kNoGain;
    }
    write("planned.yaml", ", " + line_of("simplify_mm: "), line_of("capacities: ") + "\n");
    ASSERT_EQ(shop_.run("compile planned.yaml -o planned.axg"), 0) << shop_.err;
    const Json read = report_of("check planned.yaml", 0),
               compiled = report_of("check planned.axg", 0);
    EXPECT_EQ(compiled.at("configuration_sha256"), read.at("configuration_sha256"));
    EXPECT_EQ(compiled.at("notes"), read.at("notes"));
    EXPECT_EQ(compiled.at("engine"), read.at("engine"));
    const std::string replay = " clear.log --keep-going --deadline-us 10000000 --engine cpu";
    const Json whole = report_of("replay whole.yaml" + replay, 0);
    EXPECT_GT(whole.at("permits"), 1000);
    EXPECT_EQ(report_of("replay planned.axg" + replay, 0).at("permits"), whole.at("permits"));
}

TEST_F(CheckPlan, SaysWhatItCannotRead) {
    EXPECT_EQ(shop_.run("check whole.yaml --plan --positions 10 --passes 1 --trace none.log"), 3);
    EXPECT_NE(shop_.err.find("none.log"), std::string::npos) << shop_.err;
    EXPECT_EQ(shop_.run("check whole.yaml --plan --positions 1"), 2);
}

}  // namespace
}  // namespace axg::test
