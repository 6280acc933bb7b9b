// SPDX-License-Identifier: Apache-2.0
// How a cycle uses what was proven of the travel: fewer triangles for boxes and margins that it
// holds for, whole surfaces for all others, and a stop beyond it. The proofs here are made up, so
// that it shows what was queried.
#include "core/certificate/travel.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "core/guard/monitor.hpp"
#include "core/machine/cycle_plan.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

/// Of the pair of head and table nothing but a bar high above is left.
class TravelTest : public testing::Test {
  protected:
    TravelTest()
        : scene({{"table", box({-50, -50, -10}, {50, 50, 0})},
                 {"head", box({-20, -20, 120}, {20, 20, 200})},
                 {"", {}},
                 {"short", box({-2, -2, 180}, {2, 2, 190})},
                 {"long", box({-2, -2, 170}, {2, 2, 190})},
                 known_answer_mesh(),
                 {"bar", box({-20, -20, 190}, {20, 20, 200})}}) {
        counting = {this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> results) noexcept {
                        auto& test = *static_cast<TravelTest*>(self);
                        for (const Query& query : queries) {
                            test.queried_whole += query.mesh_a == kHead ? 1 : 0;
                            test.queried_pruned += query.mesh_a == pair_mesh_index(test.m, 0);
                        }
                        test.scene.engine().run(queries, results);
                    }};
        m.travel = travel_of(m);
        m.travel.proofs.resize(stop_tasks(m));
        head().distance_mm = 2;
        head().surface_a = 0;
    }

    /// Behind the cutter with either tool.
    TravelProof& head() { return m.travel.proofs.at(2); }

    /// Whether head and table are proven to keep their margin, the axes at rest.
    bool is_proven(double z) {
        std::vector<const Mesh*> surfaces;
        for (const Mesh& mesh : scene.meshes()) {
            surfaces.push_back(&mesh);
        }
        certificate.emplace(
            *StopCertificate::create(m, surfaces, {.plan = cycle_plan(m, stop_tasks(m))}));
        AxisSnapshot snapshot = at(z);
        for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
            ++snapshot.sample;
            certificate->note(snapshot, i == 0);
        }
        queried_whole = queried_pruned = 0;
        certificate->prove(counting, scene.containment_test());
        const StopCycle cycle = certificate->cycle();
        return cycle.status == SnapshotStatus::ok &&
               cycle.proofs.back().surfaces.proof == JointBoxProof::proven;
    }
    static AxisSnapshot at(double z) {
        AxisSnapshot snapshot;
        snapshot.axis_count = 5;
        snapshot.tool = 1;
        snapshot.position[2] = z;
        return snapshot;
    }

    Machine m = table_and_head_machine();
    ContainmentScene scene;
    Engine counting;
    std::uint32_t queried_whole = 0, queried_pruned = 0;
    std::optional<StopCertificate> certificate;
};

TEST_F(TravelTest, IsThatOfTheAxesAndTheOverrun) {
    m.guard.overrun_mm = 3;
    m.guard.overrun_rad = 0.1;
    const Travel travel = travel_of(m);
    EXPECT_EQ(travel.low[2], m.axes[2].min - 3);
    EXPECT_EQ(travel.high[2], m.axes[2].max + 3);
    EXPECT_EQ(travel.low[3], m.axes[3].min - 0.1);
    EXPECT_EQ(travel.high[3], m.axes[3].max + 0.1);
    EXPECT_TRUE(travel.proofs.empty());
}

TEST_F(TravelTest, ABoxIsInsideIfAllOfItIsAsFarAsItMattersToThePair) {
    const JointPath path = path_between(m, kHead, kTable);  // X and Z
    JointBox box;
    box.centre[2] = m.travel.low[2] + 5;
    box.half[2] = 5;
    EXPECT_TRUE(is_in_travel(m, path, box));
    box.half[2] = 5.001;
    EXPECT_FALSE(is_in_travel(m, path, box));
    box.centre[2] = m.travel.high[2] - 5;
    EXPECT_FALSE(is_in_travel(m, path, box));
    box.half[2] = 4.999;
    EXPECT_TRUE(is_in_travel(m, path, box));
    box.half[1] = box.half[4] = 1e4;
    EXPECT_TRUE(is_in_travel(m, path, box)) << "Y and C move neither";
    box.half[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(is_in_travel(m, path, box));
    box.half[0] = 0;
    m.axes[0].unlimited = true;
    box.centre[0] = 1e4;
    EXPECT_TRUE(is_in_travel(m, path, box)) << "endless";
    m.travel.proofs.clear();
    EXPECT_FALSE(is_in_travel(m, path, box)) << "nothing was proven";
}

TEST_F(TravelTest, PrunedSurfacesAreQueriedWithinIt) {
    EXPECT_TRUE(is_proven(-119));
    EXPECT_GT(queried_pruned, 0U);
    head() = {};
    EXPECT_FALSE(is_proven(-119)) << "all of the head is near";
    EXPECT_EQ(queried_pruned, 0U);
}

TEST_F(TravelTest, WholeSurfacesWhereAStopMayLeaveIt) {
    m.travel.low[2] = -119.01;
    EXPECT_FALSE(is_proven(-119));
    EXPECT_EQ(certificate->cycle().status, SnapshotStatus::ok);
    EXPECT_GT(queried_whole, 0U);
}

TEST_F(TravelTest, WholeSurfacesForMoreThanWasProven) {
    m.pairs[1].margin_mm = 2.001;
    EXPECT_FALSE(is_proven(-119));
    EXPECT_EQ(queried_pruned, 0U);
    m.pairs[1].margin_mm = 2;
    EXPECT_TRUE(is_proven(-119));
}

TEST_F(TravelTest, APairThatNeverMeetsIsNotQueried) {
    head() = {.distance_mm = 2, .is_apart = true};
    EXPECT_TRUE(is_proven(-60));
    EXPECT_EQ(queried_pruned, 0U);
    EXPECT_EQ(queried_whole, 0U);
    EXPECT_EQ(certificate->cycle().proofs.back().containment_result.containment, Containment::none)
        << "tested, of a box that is new";
    m.travel.low[2] = -60.01;
    EXPECT_TRUE(is_proven(-60));
    EXPECT_GT(queried_whole, 0U) << "and where a stop may leave the travel, all that is needed";
}

TEST_F(TravelTest, ASnapshotBeyondItIsAStop) {
    m.travel.low[2] = -50;
    EXPECT_FALSE(is_proven(-50.001));
    EXPECT_EQ(certificate->cycle().status, SnapshotStatus::left_travel);
    const CycleResult result = judge(certificate->cycle(), true, true);
    EXPECT_TRUE(result.is_stop);
    EXPECT_EQ(result.reason, StopReason::left_travel);
    EXPECT_STREQ(to_text(result.reason), "left_travel");
    EXPECT_TRUE(is_proven(-50));
    const auto contact = std::make_unique<PairQueries>();
    make_contact_queries(m, at(-50.001), *contact, QueryScope::needed);
    EXPECT_EQ(contact->status, SnapshotStatus::left_travel);
    m.travel.proofs.clear();
    make_contact_queries(m, at(-50.001), *contact, QueryScope::needed);
    EXPECT_EQ(contact->status, SnapshotStatus::ok) << "without proofs the travel is no matter";
}

TEST_F(TravelTest, ContactModeQueriesWhatIsNeededAndReportsForAll) {
    const auto contact = std::make_unique<PairQueries>();
    make_contact_queries(m, at(0), *contact, QueryScope::needed);
    ASSERT_EQ(contact->count, 2U);
    EXPECT_EQ(contact->queries[1].mesh_a, pair_mesh_index(m, 0));
    EXPECT_EQ(contact->queries[1].mesh_b, kTable);
    make_contact_queries(m, at(0), *contact);
    EXPECT_EQ(contact->queries[1].mesh_a, kHead);
    head() = {.distance_mm = 2, .is_apart = true};
    make_contact_queries(m, at(0), *contact, QueryScope::needed);
    ASSERT_EQ(contact->count, 1U);
    EXPECT_EQ(contact->pair[0], 0U);
    make_contact_queries(m, at(0), *contact);
    EXPECT_EQ(contact->count, 2U);
    // With the other tool it is the cutter of the first that is pruned no more.
    m.travel.proofs[1] = {.distance_mm = 0.5, .is_apart = true};
    AxisSnapshot snapshot = at(0);
    make_contact_queries(m, snapshot, *contact, QueryScope::needed);
    EXPECT_EQ(contact->count, 1U);
    snapshot.tool = 2;
    make_contact_queries(m, snapshot, *contact, QueryScope::needed);
    EXPECT_EQ(contact->count, 0U);
}

TEST_F(TravelTest, ContactModeQueriesWholeSurfacesForMoreThanWasProven) {
    const auto contact = std::make_unique<PairQueries>();
    for (const bool is_apart : {false, true}) {
        head().is_apart = is_apart;
        m.pairs[1].margin_mm = 2.001;
        make_contact_queries(m, at(0), *contact, QueryScope::needed);
        ASSERT_EQ(contact->count, 2U);
        EXPECT_EQ(contact->queries[1].mesh_a, kHead);
    }
}

}  // namespace
}  // namespace axg::test
