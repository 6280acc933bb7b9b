// SPDX-License-Identifier: Apache-2.0
// Queries posed from chains of joints, as a GPU does it, have the bits of those that a cycle asks;
// positions that no sine or box allows for are refused.
#include "core/certificate/posed_queries.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>

#include "core/certificate/pair_queries.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

/// Expects the same bits for every pair at so many positions. Returns the number of queries.
std::size_t expect_same_poses(const Machine& machine, std::uint16_t tool, std::uint32_t count) {
    const PosedPairs posed = posed_pairs_of(machine);
    const auto pair_queries = std::make_unique<PairQueries>();
    std::size_t queries = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        AxisSnapshot snapshot = sampled_position(machine, i);
        snapshot.tool = tool;
        make_contact_queries(machine, snapshot, *pair_queries);
        for (std::uint32_t k = 0; k < pair_queries->count; ++k, ++queries) {
            const Query& wanted = pair_queries->queries[k];
            Query found;
            const PosedPair& pair =
                posed.pairs[posed_pair(machine, pair_queries->pair[k], pair_queries->tool)];
            EXPECT_TRUE(fill_posed(posed.chains.joints.data(), posed.chains.chains.data(), pair,
                                   snapshot.position.data(), found));
            EXPECT_EQ(found.mesh_a, wanted.mesh_a);
            EXPECT_EQ(found.mesh_b, wanted.mesh_b);
            EXPECT_EQ(std::memcmp(&found.pose, &wanted.pose, sizeof(Pose)), 0)
                << "position " << i << ", query " << k;
        }
    }
    return queries;
}

TEST(PosedQueries, HaveTheBitsOfContactMode) {
    const test::PaperMachine paper;
    const Machine& machine = paper.loaded.machine;
    std::size_t queries = expect_same_poses(machine, 0, 500);
    for (const Tool& tool : machine.tools) {
        queries += expect_same_poses(machine, tool.number, 100);
    }
    EXPECT_GT(queries, 2000U);
}

TEST(PosedQueries, PlaceTheToolInTheSpindle) {
    enum : std::uint32_t { kTable, kHead, kCutter, kBodies };
    Machine m = motion_test_machine();
    m.bodies.assign(kBodies, Body{});
    m.bodies[kTable].joint = {0, {-1, 0, 0}, {}};
    m.bodies[kHead].joint = {3, {1, 0, 0}, {0, 5, 10}};
    m.bodies[kCutter].parent = kHead;
    m.bodies[kCutter].is_tool = true;
    m.bodies[kCutter].at.t[1] = 4;
    m.tools[1].at.t[2] = -7;
    m.pairs = {{kCutter, kTable, 0.5}, {kHead, kTable, 2}, {kHead, kCutter, 0}};
    for (const Tool& tool : m.tools) {
        EXPECT_EQ(expect_same_poses(m, tool.number, 50), 150U);
    }
}

TEST(PosedQueries, RefusePositionsThatNothingAllowsFor) {
    const ChainJoint linear{{1, 0, 0}, {}, 0, true}, rotary{{1, 0, 0}, {}, 0, false};
    EXPECT_TRUE(may_pose(linear, kCoordinateMmMax));
    EXPECT_FALSE(may_pose(linear, -1.01 * kCoordinateMmMax));
    EXPECT_TRUE(may_pose(rotary, -kSinCosArgumentMax));
    EXPECT_FALSE(may_pose(rotary, 1.01 * kSinCosArgumentMax));
    for (const ChainJoint& joint : {linear, rotary}) {
        EXPECT_FALSE(may_pose(joint, std::numeric_limits<double>::infinity()));
        EXPECT_FALSE(may_pose(joint, std::numeric_limits<double>::quiet_NaN()));
        const PlacedChain chain{0, 1, false, {}, {}};
        const double position = std::numeric_limits<double>::quiet_NaN();
        Pose placed;
        EXPECT_FALSE(place_chain(&joint, chain, &position, placed));
    }
}

}  // namespace
}  // namespace axg
