// SPDX-License-Identifier: Apache-2.0
// What model is chosen from measurements, and which lists it gives an engine. Measurements are made
// up here; tests/replay/hil_replay/plan/check_plan_test.cpp has measured ones.
#include "hil_replay/plan/model_choice.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/sincos.hpp"
#include "hil_replay/plan/plan_lost.hpp"

namespace axg {
namespace {

ModelCandidate model_of(std::size_t triangles, std::size_t contact_lost, std::size_t rest_lost,
                        std::size_t trace_lost) {
    ModelCandidate model;
    model.triangles = triangles;
    model.contact_lost = contact_lost;
    model.rest_lost = rest_lost;
    model.trace_lost = trace_lost;
    model.measured.rest = {1000, 5, static_cast<double>(triangles), 400};
    model.measured.memory_bytes = 1000;
    return model;
}

/// A model that lost nothing, with its times and memory.
ModelCandidate timed_model(std::size_t triangles, double p99_us, double slowest_us,
                           std::size_t memory_bytes) {
    ModelCandidate model = model_of(triangles, 0, 0, 0);
    model.measured.rest = {1000, 5, p99_us, slowest_us};
    model.measured.memory_bytes = memory_bytes;
    model.earlier_mm_max = model.triangles == 1000 ? 0 : 0.5;
    return model;
}

TEST(ChooseModel, TheCoarsestThatLosesNothing) {
    const ModelCandidate whole = model_of(1000, 0, 0, 0);
    EXPECT_EQ(choose_model({whole}), 0U);
    EXPECT_EQ(choose_model({whole, model_of(500, 0, 0, 0), model_of(200, 0, 0, 0)}), 2U);
    EXPECT_EQ(choose_model({whole, model_of(500, 0, 0, 0), model_of(200, 1, 0, 0)}), 1U);
    EXPECT_EQ(choose_model({whole, model_of(500, 0, 1, 0), model_of(200, 0, 0, 1)}), 0U);
}

TEST(ChooseModel, NoInflationForNothing) {
    const ModelCandidate whole = model_of(1000, 0, 0, 0);
    EXPECT_EQ(choose_model({whole, model_of(701, 0, 0, 0)}), 0U);
    EXPECT_EQ(choose_model({whole, model_of(700, 0, 0, 0)}), 1U);
    // Measured against what is chosen so far, not against the model before.
    EXPECT_EQ(choose_model({whole, model_of(500, 0, 0, 0), model_of(451, 0, 0, 0)}), 1U);
    EXPECT_EQ(choose_model({whole, model_of(750, 0, 0, 0), model_of(690, 0, 0, 0)}), 2U);
}

/// Fewer triangles may bend back: a larger inflation opens more of them. One sample that was slow
/// with the whole surfaces is no reason for a model that costs time, memory and millimetres.
TEST(ChooseModel, NoneThatCostsMoreOfEverything) {
    const ModelCandidate whole = timed_model(1000, 100, 500, 1000);
    const ModelCandidate dearer = timed_model(500, 120, 300, 1200);
    const ModelCandidate as_fast = timed_model(500, 96, 300, 1000);
    const ModelCandidate faster = timed_model(200, 94, 300, 1200);
    const ModelCandidate smaller = timed_model(500, 120, 500, 999);
    EXPECT_EQ(choose_model({whole, dearer}), 0U);
    EXPECT_EQ(choose_model({whole, as_fast}), 0U);
    EXPECT_EQ(choose_model({whole, faster}), 1U);
    EXPECT_EQ(choose_model({whole, smaller}), 1U);
    EXPECT_EQ(choose_model({whole, dearer, faster}), 2U);
    EXPECT_EQ(next_coarser({whole, dearer}, 0), 2U);
    EXPECT_EQ(next_coarser({whole, dearer, faster}, 0), 2U);
    EXPECT_EQ(next_coarser({whole, faster}, 1), 2U);
    // It saves time against the smaller model, and costs more of everything than the whole.
    const ModelCandidate between = timed_model(200, 110, 300, 1100);
    EXPECT_EQ(choose_model({whole, smaller, between}), 1U);
    EXPECT_EQ(next_coarser({whole, smaller, between}, 1), 3U);
}

/// The constructed longest cycle of a GPU is a time that each model has.
TEST(ChooseModel, TheLongestCycleCounts) {
    ModelCandidate whole = timed_model(1000, 100, 500, 1000);
    ModelCandidate coarse = timed_model(500, 100, 500, 1000);
    whole.measured.longest_us = coarse.measured.longest_us = 400;
    EXPECT_FALSE(saves(coarse, whole));
    coarse.measured.longest_us = 300;
    EXPECT_TRUE(saves(coarse, whole));
}

TEST(CapacitiesFor, TwiceTheWorkAndAPowerOfTwo) {
    Capacities now;
    now.batch.leaf_pairs = 77;
    const Capacities chosen = capacities_for(
        {.node_pairs = 100, .triangle_pairs = 1500, .rechecks = 33, .queries = 64}, now);
    EXPECT_EQ(chosen.node_pairs, 256U);
    EXPECT_EQ(chosen.triangle_pairs, 4096U);
    EXPECT_EQ(chosen.rechecks, 128U);
    EXPECT_EQ(chosen.batch.leaf_pairs, 77U);
    const Capacities least = capacities_for({}, now);
    EXPECT_GE(least.node_pairs, 32U);  // or the machine file would refuse it
    EXPECT_GE(least.triangle_pairs, 32U * 32U);
    EXPECT_GE(least.rechecks, 1U);
}

/// How much more than its list a query would have needed is not known.
TEST(CapacitiesFor, NothingSmallerWhereAListWasFull) {
    const Capacities now;
    const Capacities chosen = capacities_for(
        {.node_pairs = 100, .triangle_pairs = 1500, .rechecks = 33, .over_capacity = 1}, now);
    EXPECT_EQ(chosen.node_pairs, now.node_pairs);
    EXPECT_EQ(chosen.triangle_pairs, now.triangle_pairs);
    EXPECT_EQ(chosen.rechecks, now.rechecks);
}

// What is proposed has to be something that a machine file may say.
TEST(SimplifiedTo, ShapesStayAsTheyWereStated) {
    LoadedMachine loaded;
    ASSERT_TRUE(load(AXG_SOURCE_DIR "/config/machines/vice-mill.yaml", "", loaded, stderr));
    std::string fault;
    EXPECT_TRUE(simplified_to(kSimplifyMmMax, loaded, fault)) << fault;
    for (const Body& body : loaded.machine.bodies) {
        EXPECT_EQ(body.mesh.simplify_mm, 0) << body.name;
        EXPECT_EQ(body.mesh.deviation_mm, 0) << body.name;
    }
    for (const Tool& tool : loaded.machine.tools) {
        EXPECT_EQ(tool.mesh.simplify_mm, 0) << tool.number;
        EXPECT_EQ(tool.mesh.deviation_mm, 0) << tool.number;
    }
}

/// Three by name and the rest counted; of what a trace never came to, no position.
TEST(LostResults, AreNamed) {
    Machine machine;
    machine.bodies.resize(2);
    machine.bodies[0].name = "table";
    machine.bodies[1].name = "head";
    machine.pairs = {{.a = 0, .b = 1, .margin_mm = 0}};
    machine.axes.resize(2);
    machine.axes[0].name = "X";
    machine.axes[1].name = "C";
    machine.axes[1].kind = AxisKind::rotary;
    ModelCandidate model;
    EXPECT_EQ(format_lost(machine, model), "");
    model.simplify_mm = 0.2;
    using Kind = LostResult::Kind;
    model.lost_results = {{Kind::contact, 0, {1.5, 0.5 * kPi}, 0},
                          {Kind::trace, 0, {2, 0}, 71},
                          {Kind::trace, kNoIndex, {}, 72}};
    EXPECT_EQ(format_lost(machine, model),
              "table-head at X 1.500 C 90.000 (contact); table-head at X 2.000 C 0.000 (sample 71 "
              "of the trace); the trace ends early (sample 72 of the trace)");
    model.lost_results.push_back({Kind::rest, 0, {3, 0}, 0});
    EXPECT_TRUE(format_lost(machine, model).ends_with("; and 1 more"));
    EXPECT_EQ(csv_of_lost(machine, {ModelCandidate{}, model}),
              "simplify_mm,what,sample,pair,X_mm,C_deg\n"
              "0.2,contact,,table-head,1.500000,90.000000\n"
              "0.2,trace,71,table-head,2.000000,0.000000\n"
              "0.2,trace,72,,,\n"
              "0.2,at rest,,table-head,3.000000,0.000000\n");
}

TEST(TimesOf, SharesOfAllCycles) {
    std::vector<double> us;
    for (int i = 200; i > 0; --i) {
        us.push_back(i);
    }
    const CycleTimes times = times_of(us);
    EXPECT_EQ(times.cycles, 200U);
    EXPECT_DOUBLE_EQ(times.p50_us, 101);
    EXPECT_DOUBLE_EQ(times.p99_us, 199);
    EXPECT_DOUBLE_EQ(times.max_us, 200);
    EXPECT_EQ(times_of({}).cycles, 0U);
}

}  // namespace
}  // namespace axg
