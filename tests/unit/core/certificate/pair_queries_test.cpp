// SPDX-License-Identifier: Apache-2.0
// Which queries a cycle runs: tools, empty spindles, snapshots that make no sense, and the
// known-answer test behind them all.
#include "core/certificate/pair_queries.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/collision/containment.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/not_finite.hpp"

namespace axg {
namespace {

enum : std::uint32_t { kTable, kHead, kCutter, kBodies };

/// Axes X Y Z A C; a table on X, a head on Z, a cutter in the head; tools 1 and 2.
Machine machine() {
    Machine m = motion_test_machine();
    m.bodies.assign(kBodies, Body{});
    m.bodies[kTable].name = "table";
    m.bodies[kTable].joint = {0, {-1, 0, 0}, {}};
    m.bodies[kHead].name = "head";
    m.bodies[kHead].joint = {2, {0, 0, 1}, {}};
    m.bodies[kCutter].name = "cutter";
    m.bodies[kCutter].parent = kHead;
    m.bodies[kCutter].is_tool = true;
    m.tools[1].at = test::shifted(0, 0, -7);
    m.pairs = {{kCutter, kTable, 0.5}, {kHead, kTable, 2}, {kHead, kCutter, 0}};
    return m;
}

AxisSnapshot snapshot_at(double x, double z, std::uint16_t tool) {
    AxisSnapshot p;
    p.axis_count = 5;
    p.tool = tool;
    p.position[0] = x;
    p.position[2] = z;
    return p;
}

std::unique_ptr<PairQueries> pair_queries(const Machine& m, const AxisSnapshot& snapshot) {
    auto out = std::make_unique<PairQueries>();
    out->count = 99;  // what was there before must not stay
    out->tool = 99;
    make_contact_queries(m, snapshot, *out);
    return out;
}

/// The two queries behind the pairs: the known-answer test, first far, then near.
void expect_known_answer_behind(const Machine& m, const PairQueries& p) {
    for (std::uint32_t i = 0; i < 2; ++i) {
        const Query& q = p.queries[p.count + i];
        EXPECT_EQ(q.mesh_a, known_answer_mesh_index(m));
        EXPECT_EQ(q.mesh_b, known_answer_mesh_index(m));
        EXPECT_EQ(q.kind, QueryKind::farther);
        EXPECT_EQ(q.r_mm, 0);
    }
    auto engine = test::engine_over({known_answer_mesh()});
    Query far = p.queries[p.count], near = p.queries[p.count + 1];
    far.mesh_a = far.mesh_b = near.mesh_a = near.mesh_b = 0;
    EXPECT_EQ(test::run_query(*engine, far).proof, Proof::far);
    EXPECT_EQ(test::run_query(*engine, near).proof, Proof::not_proven);
    EXPECT_EQ(test::run_query(*engine, near).status, QueryStatus::ok);
}

TEST(PairQueries, QueriesEveryPairWithItsMarginItsMeshesAndItsPose) {
    const Machine m = machine();
    const auto p = pair_queries(m, snapshot_at(30, -4, 1));
    EXPECT_EQ(p->status, SnapshotStatus::ok);
    EXPECT_EQ(p->tool, 0U);
    ASSERT_EQ(p->count, 3U);
    const double margins[] = {0.5, 2, 0};
    for (std::uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(p->pair[i], i);
        EXPECT_EQ(p->queries[i].kind, QueryKind::farther);
        EXPECT_EQ(p->queries[i].r_mm, margins[i]);
    }
    EXPECT_EQ(p->queries[0].mesh_a, tool_mesh_index(m, 0));
    EXPECT_EQ(p->queries[0].mesh_b, kTable);
    EXPECT_EQ(p->queries[1].mesh_a, kHead);
    EXPECT_EQ(p->queries[2].mesh_b, tool_mesh_index(m, 0));
    // The table goes to x = -30, the cutter to z = -4.
    EXPECT_EQ(p->queries[0].pose.t[0], 30);
    EXPECT_EQ(p->queries[0].pose.t[2], -4);
    EXPECT_EQ(p->queries[2].pose.t[2], 0);
    expect_known_answer_behind(m, *p);
}

TEST(PairQueries, TheToolOfTheSnapshotTakesItsSlotAndItsPlace) {
    const Machine m = machine();
    const auto p = pair_queries(m, snapshot_at(0, 0, 2));
    EXPECT_EQ(p->tool, 1U);
    EXPECT_EQ(p->queries[0].mesh_a, tool_mesh_index(m, 1));
    EXPECT_EQ(p->queries[0].pose.t[2], -7) << "tool 2 sits 7 mm lower";
    EXPECT_NE(tool_mesh_index(m, 1), tool_mesh_index(m, 0));
    EXPECT_EQ(known_answer_mesh_index(m), tool_mesh_index(m, 1) + 1);
}

// Stated errors widen the query; where nobody computed them, the engine refuses it.
TEST(PairQueries, StatedErrorsCountOrNothingIsProven) {
    Machine m = machine();
    const double before_mm = pair_queries(m, snapshot_at(0, 0, 1))->queries[1].pose_error_mm;
    m.pose_errors = {.are_stated = true, .mm = {0, 0.5, 0}, .within = {}};
    EXPECT_DOUBLE_EQ(pair_queries(m, snapshot_at(0, 0, 1))->queries[1].pose_error_mm,
                     before_mm + 0.5);
    m.pose_errors.mm.clear();
    Query query = pair_queries(m, snapshot_at(0, 0, 1))->queries[1];
    query.mesh_a = query.mesh_b = 0;
    query.pose.t[0] = 1e4;
    auto engine = test::engine_over({known_answer_mesh()});
    EXPECT_EQ(test::run_query(*engine, query).proof, Proof::not_proven);
}

// Simplified meshes stand for whole surfaces only where the deviations of both widen the query.
TEST(PairQueries, TheDeviationsOfBothSurfacesCount) {
    Machine m = machine();
    m.bodies[kTable].mesh.deviation_mm = 0.25;
    m.bodies[kHead].mesh.deviation_mm = 0.5;
    m.tools[0].mesh.deviation_mm = 1;
    m.tools[1].mesh.deviation_mm = 2;
    for (const std::uint16_t tool : {std::uint16_t{1}, std::uint16_t{2}}) {
        const auto p = pair_queries(m, snapshot_at(0, 0, tool));
        ASSERT_EQ(p->count, 3U);
        EXPECT_DOUBLE_EQ(p->queries[0].pose_error_mm, kPlaceErrorMm + tool + 0.25);
        EXPECT_DOUBLE_EQ(p->queries[1].pose_error_mm, kPlaceErrorMm + 0.5 + 0.25);
        EXPECT_DOUBLE_EQ(p->queries[2].pose_error_mm, kPlaceErrorMm + 0.5 + tool);
    }
}

TEST(PairQueries, ToolZeroMeansTheFirstToolOfTheFile) {
    Machine m = machine();
    m.first_tool = 2;
    EXPECT_EQ(pair_queries(m, snapshot_at(0, 0, 0))->tool, 1U);
    EXPECT_EQ(pair_queries(m, snapshot_at(0, 0, 1))->tool, 0U);
}

TEST(PairQueries, AnEmptySpindleLeavesOutTheToolsPairsOnly) {
    Machine m = machine();
    m.first_tool = 0;
    const auto p = pair_queries(m, snapshot_at(0, 0, 0));
    EXPECT_EQ(p->status, SnapshotStatus::ok);
    EXPECT_EQ(p->tool, kNoIndex);
    ASSERT_EQ(p->count, 1U);
    EXPECT_EQ(p->pair[0], 1U) << "head-table keeps its own number";
    expect_known_answer_behind(m, *p);
}

TEST(PairQueries, AToolNumberWithoutASlotQueriesNothing) {
    Machine m = machine();
    for (const std::uint16_t number : {std::uint16_t{3}, std::uint16_t{65535}}) {
        const auto p = pair_queries(m, snapshot_at(0, 0, number));
        EXPECT_EQ(p->status, SnapshotStatus::unknown_tool);
        EXPECT_EQ(p->count, 0U);
        EXPECT_EQ(p->tool, kNoIndex);
    }
    m.first_tool = 9;
    EXPECT_EQ(pair_queries(m, snapshot_at(0, 0, 0))->status, SnapshotStatus::unknown_tool);
}

TEST(PairQueries, PositionsThatCannotBePlacedQueryNothing) {
    const Machine m = machine();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto status = [&m](std::size_t axis, double value) {
        AxisSnapshot snapshot = snapshot_at(0, 0, 1);
        snapshot.position[axis] = value;
        const auto p = pair_queries(m, snapshot);
        EXPECT_EQ(p->count == 0, p->status != SnapshotStatus::ok);
        return p->status;
    };
    for (std::size_t axis = 0; axis < 5; ++axis) {
        for (const std::uint64_t bits : test::kNotFiniteDoubleBits) {
            EXPECT_EQ(status(axis, test::double_of(bits)), SnapshotStatus::not_finite);
        }
        const double limit = axis < 3 ? kCoordinateMmMax : kSinCosArgumentMax;
        for (const double sign : {-1.0, 1.0}) {
            EXPECT_EQ(status(axis, sign * limit), SnapshotStatus::ok);
            EXPECT_EQ(status(axis, sign * std::nextafter(limit, kInfinity)),
                      SnapshotStatus::not_finite);
        }
    }
}

TEST(PairQueries, ASnapshotOfAnotherNumberOfAxesQueriesNothing) {
    const Machine m = machine();
    for (const std::uint32_t count : {0U, 4U, 6U, 16U}) {
        AxisSnapshot snapshot = snapshot_at(0, 0, 1);
        snapshot.axis_count = count;
        const auto p = pair_queries(m, snapshot);
        EXPECT_EQ(p->status, SnapshotStatus::wrong_axes);
        EXPECT_EQ(p->count, 0U);
    }
}

TEST(PairQueries, ValuesBehindTheLastAxisDoNotMatter) {
    const Machine m = machine();
    AxisSnapshot snapshot = snapshot_at(0, 0, 1);
    snapshot.position[5] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(pair_queries(m, snapshot)->status, SnapshotStatus::ok);
}

TEST(PairQueries, HasRoomForTheMostPairsThereMayBe) {
    Machine m = machine();
    m.pairs.assign(kPairsMax, m.pairs[1]);
    const auto p = pair_queries(m, snapshot_at(1, 1, 1));
    EXPECT_EQ(p->count, kPairsMax);
    EXPECT_EQ(p->pair[kPairsMax - 1], kPairsMax - 1);
    expect_known_answer_behind(m, *p);
}

}  // namespace
}  // namespace axg
