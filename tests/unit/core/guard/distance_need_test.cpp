// SPDX-License-Identifier: Apache-2.0
// The distance that a proof needs, in parts, against figures by hand; and which proof of a
// certificate it is about.
#include "core/guard/distance_need.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kHeadAndTable = 1;  // Machine::pairs

class DistanceNeedTest : public testing::Test {
  protected:
    DistanceNeedTest() : scene(table_and_head_scene()) { m.tools.resize(1); }

    /// The pair of head and table with nothing known of accelerations, and no jerk to wait for.
    UnprovenPair falling(double speed, double speed_error) {
        UnprovenPair pair;
        pair.is_known = true;
        extents = {extent_of(scene.meshes()[kTable]), extent_of(scene.meshes()[kHead]), {}, {}, {}};
        pair.task = pair_task(m, kHeadAndTable, kNoIndex, extents);
        pair.free_s = 5e-3;
        for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
            pair.limits[i] = stop_limits(m, i);
            pair.limits[i].jerk_max = 1e15;
        }
        pair.position_error[0] = 0.001;
        pair.position_error[2] = 0.01;
        pair.now[0].low = -0.001;
        pair.now[0].high = 0.001;
        pair.now[2] = {-0.01, 0.01, -speed - speed_error, -speed + speed_error};
        pair.task.box = {};
        for (const std::uint32_t i : {0U, 2U}) {
            put_reach(axis_reach(m, i, pair.limits[i], pair.now[i], pair.free_s, 0), i,
                      pair.task.box);
        }
        return pair;
    }
    /// `sample` snapshots of a motion that ends at z.
    void come_to(double z, double speed) {
        certificate.emplace(certificate_over(scene, m));
        for (std::uint32_t k = 0; k < kSamplesKept; ++k) {
            AxisSnapshot snapshot;
            snapshot.sample = k + 1;
            snapshot.axis_count = 5;
            snapshot.tool = 1;
            snapshot.mode = kModeMoving;
            snapshot.position[2] = z + speed * 1e-3 * (kSamplesKept - 1 - k);
            certificate->note(snapshot, k == 0);
        }
        certificate->prove(scene.engine().engine(), scene.containment_test());
    }

    Machine m = table_and_head_machine();
    ContainmentScene scene;
    std::vector<BodyExtent> extents;
    std::optional<StopCertificate> certificate;
};

// Z falls at 100 +- 10 mm/s: within 5 ms at 2000 mm/s2 it moves 100 x 0.005 + 0.025 = 0.525 mm and
// is at 110 mm/s; at 1500 mm/s2 it brakes within 110^2 / 3000 = 4.0333 mm. From 110 mm/s the two
// are 0.575 and 120^2 / 3000 = 4.8. X is at rest: 0.025, and 10^2 / 3000 = 0.0333. The two are at a
// right angle.
constexpr double kWayOfXMm = 0.025 + 0.033333;

TEST_F(DistanceNeedTest, ThePartsAreThoseOfTheFormulas) {
    const DistanceNeed need = distance_need(m, falling(100, 10));
    const double free = std::hypot(0.525, 0.025), braked = std::hypot(0.525 + 4.033333, kWayOfXMm);
    const double placed = std::hypot(0.525 + 4.033333 + 0.01, kWayOfXMm + 0.001);
    EXPECT_NEAR(need.until_braking_mm, free, 1e-4);
    EXPECT_NEAR(need.braking_mm, braked - free, 1e-4);
    EXPECT_NEAR(need.position_error_mm, placed - braked, 1e-5);
    EXPECT_NEAR(need.speed_uncertainty_mm, std::hypot(5.375 + 0.01, kWayOfXMm + 0.001) - placed,
                1e-5);
    EXPECT_EQ(need.margin_mm, 2);
    EXPECT_EQ(need.arithmetic_mm, kPlacementErrorMm);
    EXPECT_NEAR(need.sum_mm(), 2 + std::hypot(5.375 + 0.01, kWayOfXMm + 0.001), 1e-5);
}

TEST_F(DistanceNeedTest, WhereSpeedIsExactNoneOfItIsUncertainty) {
    const DistanceNeed need = distance_need(m, falling(100, 0));
    EXPECT_NEAR(need.speed_uncertainty_mm, 0, 1e-9);
    EXPECT_NEAR(need.sum_mm(), 2 + std::hypot(0.525 + 4.033333 + 0.01, kWayOfXMm + 0.001), 1e-5);
}

// Of a jog or a path the reach is one whole.
TEST_F(DistanceNeedTest, AWholeReachHasNoParts) {
    UnprovenPair pair = falling(100, 10);
    const double sum_mm = distance_need(m, pair).sum_mm();
    pair.is_whole = true;
    const DistanceNeed need = distance_need(m, pair);
    EXPECT_NEAR(need.sum_mm(), sum_mm, 1e-9);
    EXPECT_EQ(need.braking_mm + need.position_error_mm + need.speed_uncertainty_mm, 0);
}

// The head is 120 mm above the table at Z 0: at -118.5 it is within its 2 mm, at rest or not.
TEST_F(DistanceNeedTest, APairWithinItsMarginNeedsMoreThanThereIs) {
    m.pairs = {m.pairs[kHeadAndTable]};
    come_to(-118.5, 0);
    const UnprovenPair pair = unproven_pair(m, *certificate, 0);
    ASSERT_TRUE(pair.is_known);
    EXPECT_FALSE(pair.is_whole || pair.is_jog || pair.is_blind);
    const Engine engine = scene.engine().engine();
    EXPECT_NEAR(available_mm(m, engine, pair, 50), 1.5, 1e-3);
    EXPECT_NEAR(available_mm(m, engine, pair, 1), 1, 0) << "no interest beyond";
    EXPECT_GT(distance_need(m, pair).sum_mm(), 2);
    const double worst_mm = least_clearance_mm(m, engine, pair, 50);
    EXPECT_LT(worst_mm, 1.5);
    EXPECT_GT(worst_mm, 1);
    const NeedRemedies remedies = find_remedies(m, engine, pair, {});
    EXPECT_FALSE(remedies.is_alone || remedies.speed_share || remedies.queries);
    ASSERT_TRUE(remedies.margin_mm);
    EXPECT_LE(*remedies.margin_mm, worst_mm);
    EXPECT_GT(*remedies.margin_mm, worst_mm - 0.1) << "found to a hundredth of 2 mm";
}

// The head falls from z: 5.4 mm of reach and 2 mm of margin above the table at -120. What one query
// takes is said only where it proves the whole reach.
TEST_F(DistanceNeedTest, TheWholeReachIsProvenByOneQueryOrHasNoDemand) {
    const Engine engine = scene.engine().engine();
    const auto demand_at = [&](double z) {
        UnprovenPair pair = falling(100, 10);
        pair.task.box.centre[2] += z;
        return whole_demand(m, engine, pair);
    };
    EXPECT_EQ(demand_at(-110), WorkLists{.leaf_pairs = 1}) << "boxes of two leaves are enough";
    EXPECT_FALSE(demand_at(-113)) << "apart, but nearer than its reach";
    UnprovenPair blind = falling(100, 10);
    blind.is_blind = true;
    EXPECT_FALSE(whole_demand(m, engine, blind));
    EXPECT_FALSE(whole_demand(m, Engine{}, falling(100, 10)));
}

// At full speed 20 mm above its margin; at rest there all is well.
TEST_F(DistanceNeedTest, AFastPairIsProvenMoreSlowlyOrWithOtherLimits) {
    m.pairs = {m.pairs[kHeadAndTable]};
    come_to(-110, 160);
    const UnprovenPair pair = unproven_pair(m, *certificate, 0);
    ASSERT_TRUE(pair.is_known);
    const Engine engine = scene.engine().engine();
    std::array<AxisLimits, kAxesMax> limits = pair.limits;
    const NeedRemedies none = find_remedies(m, engine, pair, {.limits = &limits});
    EXPECT_FALSE(none.are_other_limits) << "those that it has do not help";
    ASSERT_TRUE(none.speed_share);
    EXPECT_GT(*none.speed_share, 0.5);
    EXPECT_LT(*none.speed_share, 1);
    limits[2].stopping_min = 6000;
    limits[2].jerk_max = 1e6;
    EXPECT_TRUE(find_remedies(m, engine, pair, {.limits = &limits}).are_other_limits);
}

TEST_F(DistanceNeedTest, APairThatIsProvenIsNoneOfThem) {
    come_to(-20, 0);
    for (const std::uint32_t pair : {0U, 1U}) {
        EXPECT_FALSE(unproven_pair(m, *certificate, pair).is_known);
    }
}

// One snapshot says nothing about speed: nothing was queried, so no distance was too short.
TEST_F(DistanceNeedTest, WhereNothingWasQueriedThePairIsBlind) {
    certificate.emplace(certificate_over(scene, m));
    AxisSnapshot snapshot;
    snapshot.sample = 1;
    snapshot.axis_count = 5;
    snapshot.tool = 1;
    certificate->note(snapshot, true);
    certificate->prove(scene.engine().engine(), scene.containment_test());
    const UnprovenPair pair = unproven_pair(m, *certificate, 0);
    ASSERT_TRUE(pair.is_known);
    EXPECT_TRUE(pair.is_blind);
    const NeedRemedies remedies = find_remedies(m, scene.engine().engine(), pair, {});
    EXPECT_FALSE(remedies.is_alone || remedies.speed_share || remedies.margin_mm);
}

// Halving goes on where a whole box is too near; a box that is open as it was, was not halved.
TEST_F(DistanceNeedTest, AnOpenPartIsSmallerThanTheReach) {
    m.pairs = {m.pairs[kHeadAndTable]};
    come_to(-110, 160);
    UnprovenPair pair = unproven_pair(m, *certificate, 0);
    ASSERT_TRUE(pair.is_known);
    const auto open = open_part(m, scene.engine().engine(), pair);
    ASSERT_TRUE(open);
    EXPECT_LT(open->available_mm, open->needed_mm);
    EXPECT_LT(open->needed_mm, distance_need(m, pair).sum_mm());
    pair.result.open = pair.task.box;
    EXPECT_FALSE(open_part(m, scene.engine().engine(), pair));
}

}  // namespace
}  // namespace axg::test
