// SPDX-License-Identifier: Apache-2.0
// Exclusions over the travel: never near, always in contact, or both with a witness. Each verdict
// is shown beside the machine that differs in one place only and must not get it.
#include "firmware_if/setup/exclusion_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/mesh/shape.hpp"
#include "firmware_if/setup/near_proof.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {
namespace {

/// A fixed rail under z = 0, a carriage on it that X moves by -100 to 100 mm, a wheel that A turns
/// about z by -90 to 90 degrees, and a cutter in the carriage. The overrun is 2 mm and 0.5 degrees.
class OverTravel : public testing::Test {
  protected:
    enum : std::uint32_t { kRail, kCarriage, kWheel, kCutter };

    OverTravel() {
        Machine& m = loaded_.machine;
        Axis x{.name = "X", .min = -100, .max = 100};
        Axis a{.name = "A", .kind = AxisKind::rotary, .min = -kPi / 2, .max = kPi / 2};
        m.axes = {x, a};
        m.bodies.assign(4, Body{});
        m.bodies[kCarriage].joint = {0, {1, 0, 0}, {}};
        m.bodies[kWheel].joint = {1, {0, 0, 1}, {}};
        m.bodies[kCutter].parent = kCarriage;
        m.bodies[kCutter].is_tool = true;
        loaded_.meshes.bodies = {{"rail", box({-300, -10, -20}, {300, 10, 0})},
                                 {"carriage", box({-30, -30, 0}, {30, 30, 25})},
                                 {"wheel", box({-40, -40, 0}, {40, 40, 30})},
                                 {"", {}}};
    }

    PairOverTravel judge(std::uint32_t a, std::uint32_t b, const ExclusionEffort& effort = {}) {
        const auto out = judge_over_travel(loaded_, {{.a = a, .b = b}}, effort);
        EXPECT_TRUE(out.has_value());
        return out ? out->front() : PairOverTravel{};
    }
    Triangles& mesh(std::uint32_t body) { return loaded_.meshes.bodies[body].triangles; }

    LoadedMachine loaded_;
};

TEST_F(OverTravel, ACarriageOnItsRailIsInContactAtEveryPlace) {
    const PairOverTravel found = judge(kRail, kCarriage);
    EXPECT_EQ(found.verdict, TravelVerdict::always_near);
    EXPECT_FALSE(found.apart.is_known);
    EXPECT_LT(found.queries, 300U) << "one box is enough where nothing turns";
}

TEST_F(OverTravel, AWheelThatTurnsOnItsSeatIsInContactAtEveryPlace) {
    EXPECT_EQ(judge(kRail, kWheel).verdict, TravelVerdict::always_near);
    mesh(kWheel) = moved(mesh(kWheel), {0, 0, 0.2F});
    const PairOverTravel found = judge(kRail, kWheel);
    EXPECT_EQ(found.verdict, TravelVerdict::never_near);
    EXPECT_GE(found.apart_mm, kContactMm);
    EXPECT_LE(found.apart_mm, 0.2);
}

// The gap is on both sides of the distance that counts as contact.
TEST_F(OverTravel, AGapIsFoundOnBothSidesOfContact) {
    mesh(kCarriage) = moved(mesh(kCarriage), {0, 0, 0.09F});
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::always_near);
    mesh(kCarriage) = moved(mesh(kCarriage), {0, 0, 0.06F});
    const PairOverTravel found = judge(kRail, kCarriage);
    EXPECT_EQ(found.verdict, TravelVerdict::never_near);
    EXPECT_GE(found.apart_mm, kContactMm);
    EXPECT_LE(found.apart_mm, 0.15);
}

// A hundredth of a millimetre above contact, along a metre: boxes that prove 0.1 mm would be as
// short as that hundredth.
TEST_F(OverTravel, ASmallGapAlongALongTravelIsProven) {
    loaded_.machine.axes[0].min = -500;
    loaded_.machine.axes[0].max = 500;
    mesh(kRail) = box({-700, -10, -20}, {700, 10, 0});
    mesh(kCarriage) = moved(mesh(kCarriage), {0, 0, 0.11F});
    std::vector<double> shares;
    const PairOverTravel found =
        judge(kRail, kCarriage, {.progress = [&](double share) { shares.push_back(share); }});
    EXPECT_EQ(found.verdict, TravelVerdict::never_near);
    EXPECT_GE(found.apart_mm, kContactMm / 4);
    EXPECT_LT(found.apart_mm, 0.11);
    ASSERT_FALSE(shares.empty());
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_LE(shares.back(), 1);
}

// A block that the carriage meets in the last 0.1 mm of the overrun: no sample of the travel sees
// it.
TEST_F(OverTravel, AContactAtOnePlaceThatNoSampleMeetsIsFound) {
    mesh(kRail) = box({132, -10, 0}, {300, 10, 20});
    mesh(kCarriage) = box({-30, -30, 0}, {30, 30, 25});
    const PairOverTravel sampled = judge(kRail, kCarriage, {.queries = 0});
    EXPECT_EQ(sampled.verdict, TravelVerdict::undecided) << "samples prove nothing";
    EXPECT_FALSE(sampled.near.is_known) << "and see nothing";
    const PairOverTravel found = judge(kRail, kCarriage);
    EXPECT_EQ(found.verdict, TravelVerdict::both);
    EXPECT_GT(found.near.position[0], 101.89);
    EXPECT_TRUE(found.apart.is_known);
    mesh(kRail) = moved(mesh(kRail), {0.2F, 0, 0});
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::never_near);
}

// The carriage leaves its rail in the last of the overrun: contact at all samples, yet not always.
TEST_F(OverTravel, AContactThatEndsAtOnePlaceIsNotPermanent) {
    mesh(kRail) = box({-300, -10, -20}, {71.5F, 10, 0});
    EXPECT_FALSE(judge(kRail, kCarriage, {.queries = 0}).apart.is_known);
    const PairOverTravel found = judge(kRail, kCarriage);
    EXPECT_EQ(found.verdict, TravelVerdict::both);
    EXPECT_GT(found.apart.position[0], 101.5);
    mesh(kRail) = box({-300, -10, -20}, {72.5F, 10, 0});
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::always_near);
}

TEST_F(OverTravel, ABodyInsideTheOtherIsInContactWithoutATouch) {
    mesh(kRail) = box({-300, -60, -60}, {300, 60, 60});
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::always_near);
    mesh(kRail) = box({-131, -60, -60}, {131, 60, 60});  // comes out at the ends
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::always_near)
        << "the surfaces cross: that is contact, too";
    mesh(kRail) = box({-60, -60, -60}, {60, 60, 60});
    EXPECT_EQ(judge(kRail, kCarriage).verdict, TravelVerdict::both);
}

TEST_F(OverTravel, EachToolCounts) {
    Machine& m = loaded_.machine;
    m.tools.resize(2);
    loaded_.meshes.tools = {{"short", box({-2, -2, 5}, {2, 2, 20})},
                            {"long", box({-2, -2, -0.05F}, {2, 2, 20})}};
    const PairOverTravel found = judge(kRail, kCutter);
    EXPECT_EQ(found.verdict, TravelVerdict::both);
    EXPECT_EQ(found.apart.tool, 0U);
    EXPECT_EQ(found.near.tool, 1U);
    loaded_.meshes.tools[1] = loaded_.meshes.tools[0];
    EXPECT_EQ(judge(kRail, kCutter).verdict, TravelVerdict::never_near);
}

TEST_F(OverTravel, TheQueriesAreBounded) {
    const ExclusionEffort effort{.queries = 400};
    mesh(kRail) = box({132, -10, 0}, {300, 10, 20});
    mesh(kRail) = moved(mesh(kRail), {0.11F, 0, 0});
    const PairOverTravel found = judge(kRail, kWheel, effort);
    EXPECT_LE(found.queries, effort.queries + 8U);
}

// The bound of a box holds at random positions in it, with two linear axes and a rotary one.
TEST(NearBox, NoPositionOfTheBoxIsFartherThanTheBound) {
    Machine m;
    m.axes = {{.name = "X", .min = -100, .max = 100},
              {.name = "Y", .min = -100, .max = 100},
              {.name = "A", .kind = AxisKind::rotary, .min = -2, .max = 2}};
    m.bodies.assign(3, Body{});
    m.bodies[0].joint = {0, {1, 0, 0}, {}};
    m.bodies[1].parent = 0;
    m.bodies[1].joint = {2, {0, 0.6, 0.8}, {5, 0, 3}};
    m.bodies[2].joint = {1, {0, 1, 0}, {}};
    JointBoxTask task;
    task.body_a = 1;
    task.body_b = 2;
    task.path = path_between(m, 1, 2);
    Dice dice(printed_seed(5));
    const auto corner = [&] {
        return Vec3f{static_cast<float>(dice.in(-50, 50)), static_cast<float>(dice.in(-50, 50)),
                     static_cast<float>(dice.in(-50, 50))};
    };
    double least_room = 1;
    for (int i = 0; i < 2000; ++i) {
        JointBox box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.centre[axis] = axis == 2 ? dice.in(-1, 1) : dice.in(-50, 50);
            box.half[axis] = axis == 2 ? dice.in(0, 0.3) : dice.in(0, 20);
        }
        const Triangle a{corner(), corner(), corner()}, b{corner(), corner(), corner()};
        const NearBound bound = NearBox(m, task, box).bound(a, b);
        for (int k = 0; k < 5; ++k) {
            JointBox point;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                point.centre[axis] = box.centre[axis] + dice.in(-1, 1) * box.half[axis];
            }
            // Both are upper bounds; at a point only the least pair of points is looked for.
            const double here = NearBox(m, task, point).bound(a, b).mm;
            EXPECT_LE(here, bound.mm + 1e-6) << i;
            least_room = std::min(least_room, bound.mm - here);
        }
    }
    EXPECT_LT(least_room, 1) << "some bound is nearly reached: it is not just large";
}

TEST(NearPoints, PiercingTrianglesAreAtNoDistance) {
    const Triangle flat{{-50, -40, 0}, {60, -30, 0}, {0, 70, 0}};
    const Triangle upright{{1, 2, -30}, {3, 2, 25}, {200, 9, 400}};
    EXPECT_LT(near_points_mm(flat, upright, Pose{}), 1e-6);
    EXPECT_LT(near_points_mm(upright, flat, Pose{}), 1e-6);
    const Triangle above{{1, 2, 5}, {30, 9, 25}, {-20, 9, 40}};
    EXPECT_NEAR(near_points_mm(flat, above, Pose{}), 5, 1e-6);
}

}  // namespace
}  // namespace axg::test
