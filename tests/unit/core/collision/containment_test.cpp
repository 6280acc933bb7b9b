// SPDX-License-Identifier: Apache-2.0
// Which bodies are inside which: by both ways of querying, in cavities, in several parts, where a
// shell is open, and each way to get no result.
#include "core/collision/containment.hpp"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/round_solids.hpp"

namespace axg {
namespace {

using test::box;
using test::ContainmentScene;
using test::shifted;
using test::together;
using test::turned_over;

const Mesh kSmallCube{"cube", box({-1, -1, -1}, {1, 1, 1})};
const Mesh kRoom{"room", box({-8, -8, -8}, {8, 8, 8})};

TEST(Containment, ACubeInACubeBothWays) {
    ContainmentScene scene({kSmallCube, kRoom});
    for (const double x : {0.0, 5.0, 6.999}) {
        EXPECT_EQ(scene.judge(shifted(x, 0, -x)), Containment::a_in_b) << x;
        EXPECT_EQ(scene.judge(shifted(-x, 0, x), 1, 0), Containment::b_in_a) << x;
    }
    for (const double x : {9.001, 20.0, 1000.0}) {
        EXPECT_EQ(scene.judge(shifted(x, 0, 0)), Containment::none) << x;
        EXPECT_EQ(scene.judge(shifted(0, -x, 0), 1, 0), Containment::none) << x;
    }
}

// Where the surfaces are not proven apart there is no claim, and none is needed: that is a stop.
TEST(Containment, TouchingSurfacesLeaveNothingToSay) {
    ContainmentScene scene({kSmallCube, kRoom});
    for (const double x : {7.0, 8.0, 9.0}) {
        const ContainmentResult result = scene.run(ContainmentScene::about(shifted(x, 0, 0)));
        EXPECT_EQ(result.status, QueryStatus::not_run) << x;
        EXPECT_EQ(result.containment, Containment::not_proven) << x;
    }
    EXPECT_EQ(ContainmentResult{}.containment, Containment::not_proven) << "zeroed memory";
}

TEST(Containment, AMarginIsProvenFirst) {
    ContainmentScene scene({kSmallCube, kRoom});
    Query query = ContainmentScene::about(shifted(5, 0, 0));  // 2 mm to the wall
    query.r_mm = 1.99;
    EXPECT_EQ(scene.run(query).containment, Containment::a_in_b);
    query.r_mm = 2.01;
    EXPECT_EQ(scene.run(query).status, QueryStatus::not_run);
}

TEST(Containment, ACavityIsOutside) {
    const Mesh hollow{"hollow",
                      together(kRoom.triangles, turned_over(box({-4, -4, -4}, {4, 4, 4})))};
    ContainmentScene scene({kSmallCube, hollow});
    EXPECT_EQ(scene.judge(shifted(0, 0, 0)), Containment::none);
    EXPECT_EQ(scene.judge(shifted(0, 0, 0), 1, 0), Containment::none);
    EXPECT_EQ(scene.judge(shifted(6, 0, 0)), Containment::a_in_b) << "in the wall";
    EXPECT_EQ(scene.judge(shifted(-6, 0, 0), 1, 0), Containment::b_in_a);
}

// Each part of each body counts by itself.
TEST(Containment, EveryPartIsQueried) {
    const Mesh pieces{"pieces",
                      together(box({20, 0, 0}, {22, 2, 2}),
                               together(box({40, 0, 0}, {42, 2, 2}), box({60, 0, 0}, {62, 2, 2})))};
    ContainmentScene scene({pieces, kRoom});
    EXPECT_EQ(scene.judge(shifted(0, 0, 0)), Containment::none);
    for (const double x : {-20.0, -40.0, -60.0}) {
        EXPECT_EQ(scene.judge(shifted(x, 0, 0)), Containment::a_in_b) << x;
        EXPECT_EQ(scene.judge(shifted(-x, 0, 0), 1, 0), Containment::b_in_a) << x;
    }
    EXPECT_EQ(scene.judge(shifted(-31, 0, 0)), Containment::none) << "between two pieces";
}

// Both pieces lie in the ring's box, one of them in its hole: whichever comes first.
TEST(Containment, APartInTheHoleDoesNotSpeakForTheOther) {
    const auto hole = box({-1, -1, -1}, {1, 1, 1}), tube = test::moved(hole, {40, 0, 0});
    const Mesh ring{"ring", test::ring(32, 16, 40, 10)};
    for (const auto& pieces : {together(hole, tube), together(tube, hole)}) {
        ContainmentScene scene({{"pieces", pieces}, ring});
        EXPECT_EQ(scene.judge(Pose{}), Containment::a_in_b);
        EXPECT_EQ(scene.judge(Pose{}, 1, 0), Containment::b_in_a);
    }
}

// Its box lies in the other's box, and yet it is beside it.
TEST(Containment, NestedBoxesAloneAreNoContainment) {
    ContainmentScene scene({kSmallCube, {"ring", test::ring(32, 16, 40, 10)}});
    const ContainmentResult hole = scene.run(ContainmentScene::about(shifted(0, 0, 0)));
    EXPECT_EQ(hole.containment, Containment::none);
    EXPECT_EQ(hole.rays, 1U);
    EXPECT_EQ(scene.judge(shifted(40, 0, 0)), Containment::a_in_b);
    EXPECT_EQ(scene.judge(shifted(28, 0, 0)), Containment::none);
    const ContainmentResult away = scene.run(ContainmentScene::about(shifted(0, 0, 20)));
    EXPECT_EQ(away.containment, Containment::none);
    EXPECT_EQ(away.rays, 0U) << "no box holds the other: no ray";
}

TEST(Containment, AnOpenShellHoldsNothingButCanBeHeld) {
    Mesh open = kRoom;
    open.triangles.pop_back();
    ContainmentScene scene({kSmallCube, open, {"hall", box({-20, -20, -20}, {20, 20, 20})}});
    EXPECT_EQ(scene.judge(shifted(0, 0, 0)), Containment::none) << "no claim about what is open";
    EXPECT_EQ(scene.judge(shifted(0, 0, 0), 1, 2), Containment::a_in_b) << "inside a closed shell";
    EXPECT_EQ(scene.judge(shifted(0, 0, 0), 2, 1), Containment::b_in_a);
}

// Boxes side by side share corners and edges, four facets to an edge: the sum of their winding
// numbers is what counts. So is each way in which they overlap.
TEST(Containment, ABodyOfSeveralBoxesHoldsInEachOfThem) {
    const auto cube = box({-4, -4, -4}, {4, 4, 4});
    const Mesh small{"small", box({-1, -1, -1}, {1, 1, 1})};
    for (const Vec3f by : {Vec3f{8, 0, 0}, Vec3f{8, 8, 0}, Vec3f{8, 8, 8}, Vec3f{5, 3, 2},
                           Vec3f{5, 0, 0}, Vec3f{0, 0, 0}}) {
        ContainmentScene scene({small, {"two", together(cube, test::moved(cube, by))}});
        const auto at = [&](double x, double y, double z) { return scene.judge(shifted(x, y, z)); };
        const double x = static_cast<double>(by.x), y = static_cast<double>(by.y),
                     z = static_cast<double>(by.z);
        EXPECT_EQ(at(-1.5, -1.5, -1.5), Containment::a_in_b) << x << y << z;
        EXPECT_EQ(at(x + 1.5, y + 1.5, z + 1.5), Containment::a_in_b) << x << y << z;
        EXPECT_EQ(at(-6, 0, 0), Containment::none);
        EXPECT_EQ(at(x + 6, y, z), Containment::none);
    }
}

TEST(Containment, AnyTurnOfTheBodiesIsTheSameScene) {
    test::Draw draw(7);
    ContainmentScene scene({kSmallCube, kRoom});
    for (int i = 0; i < 200; ++i) {
        Pose turned = test::random_rotation(draw);
        EXPECT_EQ(scene.judge(turned), Containment::a_in_b);
        EXPECT_EQ(scene.judge(turned, 1, 0), Containment::b_in_a);
        turned.t[0] = 30;
        EXPECT_EQ(scene.judge(turned), Containment::none);
    }
}

TEST(Containment, AQueryProvenWithoutRoomForRoundingIsRefused) {
    ContainmentScene scene({kSmallCube, kRoom});
    Query query = ContainmentScene::about(shifted(3, 0, 0));
    EXPECT_EQ(scene.run(query).status, QueryStatus::ok);
    query.pose_error_mm = kPlaceErrorMm / 2;
    EXPECT_EQ(scene.run(query).status, QueryStatus::bad_query);
    EXPECT_EQ(scene.run(query).containment, Containment::not_proven);
}

// The queries of a cycle leave that room.
TEST(Containment, PairQueriesLetContainmentFollow) {
    Machine machine = motion_test_machine();
    machine.bodies.assign(2, Body{});
    machine.bodies[0].joint = {0, {1, 0, 0}, {}};
    machine.pairs = {{0, 1, 0.5}};
    AxisSnapshot snapshot;
    snapshot.axis_count = 5;
    snapshot.tool = 1;
    PairQueries pair_queries;
    make_contact_queries(machine, snapshot, pair_queries);
    ASSERT_EQ(pair_queries.status, SnapshotStatus::ok);
    EXPECT_EQ(pair_queries.queries[0].pose_error_mm, kPlaceErrorMm);
}

// A pose so far from rigid that a corner cannot be placed in the other frame to within
// kPlaceErrorMm: taken by the engine, refused here, and only where it matters.
TEST(Containment, ABarelyRigidPoseIsNotProven) {
    ContainmentScene scene({kSmallCube, {"room", box({-800, -800, -800}, {800, 800, 800})}});
    Pose pose = shifted(700, 0, 0);
    EXPECT_EQ(scene.judge(pose), Containment::a_in_b);
    EXPECT_EQ(scene.judge(shifted(-700, 0, 0), 1, 0), Containment::b_in_a);
    pose.r[0][0] += 0x1p-32;  // 2e-10, a fifth of kRigidDefectMax
    EXPECT_EQ(scene.judge(pose), Containment::a_in_b) << "forwards the pose itself places corners";
    pose.t[0] = -700;
    const ContainmentResult back = scene.run(ContainmentScene::about(pose, 1, 0));
    EXPECT_EQ(back.status, QueryStatus::bad_query);
    EXPECT_EQ(back.containment, Containment::not_proven);
}

TEST(Containment, UnknownAndEmptyBodiesAreRefused) {
    ContainmentScene scene({kSmallCube, kRoom, {"link", {}}});
    QueryResult far;
    far.status = QueryStatus::ok;
    far.proof = Proof::far;
    for (const std::uint32_t body : {2U, 3U, 0xffffffffU}) {
        for (const bool is_a : {true, false}) {
            const Query query = ContainmentScene::about(Pose{}, is_a ? body : 0, is_a ? 0 : body);
            ContainmentResult result;
            scene.containment_test().run({&query, 1}, {&far, 1}, {&result, 1});
            EXPECT_EQ(result.status, QueryStatus::bad_query);
        }
    }
}

// Nothing is known of a pose that nobody proved, and a proof with less room than a corner's
// rounded place needs is none.
TEST(Containment, BeginsWithAProof) {
    ContainmentScene scene({kSmallCube, kRoom});
    ApartPose at;
    at.is_proven = true;
    at.mesh_b = 1;
    at.pose_error_mm = kPlaceErrorMm;
    EXPECT_EQ(scene.containment_test().test(at).containment, Containment::a_in_b);
    at.is_proven = false;
    EXPECT_EQ(scene.containment_test().test(at).status, QueryStatus::not_run);
    EXPECT_EQ(scene.containment_test().test(at).containment, Containment::not_proven);
    at.is_proven = true;
    at.pose_error_mm = std::nextafter(kPlaceErrorMm, 0.0);
    EXPECT_EQ(scene.containment_test().test(at).status, QueryStatus::bad_query);
    EXPECT_EQ(scene.containment_test().test(at).containment, Containment::not_proven);
}

TEST(Containment, AnotherRoundingModeProvesNothing) {
    ContainmentScene scene({kSmallCube, kRoom});
    const Query query = ContainmentScene::about(shifted(0, 0, 0));
    const QueryResult far = test::run_query(scene.engine(), query);
    ContainmentResult result;
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        ASSERT_EQ(std::fesetround(mode), 0);
        scene.containment_test().run({&query, 1}, {&far, 1}, {&result, 1});
        ASSERT_EQ(std::fesetround(FE_TONEAREST), 0);
        EXPECT_EQ(result.status, QueryStatus::bad_rounding);
        EXPECT_EQ(result.containment, Containment::not_proven);
    }
}

TEST(Containment, ACapacityTooSmallIsNotProven) {
    const Mesh ball{"ball", test::ball(24, 50)};
    const Query query = ContainmentScene::about(shifted(0, 0, 0));
    ContainmentScene scene({kSmallCube, ball});
    const ContainmentResult used = scene.run(query);
    ASSERT_EQ(used.containment, Containment::a_in_b);
    QueryResult far;
    far.status = QueryStatus::ok;
    far.proof = Proof::far;
    Capacities less;
    less.node_pairs = used.nodes - 1;
    ContainmentResult result;
    ContainmentScene({kSmallCube, ball}, less)
        .containment_test()
        .run({&query, 1}, {&far, 1}, {&result, 1});
    EXPECT_EQ(result.status, QueryStatus::too_many_node_pairs);
    EXPECT_EQ(result.containment, Containment::not_proven);
}

TEST(Containment, EveryQueryHasItsOwnResult) {
    ContainmentScene scene({kSmallCube, kRoom});
    const std::vector<Query> queries{ContainmentScene::about(shifted(0, 0, 0)),
                                     ContainmentScene::about(shifted(8, 0, 0)),
                                     ContainmentScene::about(shifted(20, 0, 0))};
    std::vector<QueryResult> surfaces(3);
    scene.engine().run(queries, surfaces);
    std::vector<ContainmentResult> results(3, {QueryStatus::ok, Containment::none});
    scene.containment_test().run(queries, surfaces, results);
    EXPECT_EQ(results[0].containment, Containment::a_in_b);
    EXPECT_EQ(results[1].containment, Containment::not_proven);
    EXPECT_EQ(results[1].status, QueryStatus::not_run);
    EXPECT_EQ(results[2].containment, Containment::none);
}

TEST(SurfaceParts, PartsMeetInCornersAndShellsInEdges) {
    const auto one = box({0, 0, 0}, {1, 1, 1});
    const SurfaceParts corner = take_apart(together(one, box({1, 1, 1}, {2, 3, 4})));
    ASSERT_EQ(corner.parts.size(), 1U);
    const auto& e = corner.parts[0].extreme;
    EXPECT_EQ(e[0].x, 0);
    EXPECT_EQ(e[1].x, 2);
    EXPECT_EQ(e[2].y, 0);
    EXPECT_EQ(e[3].y, 3);
    EXPECT_EQ(e[4].z, 0);
    EXPECT_EQ(e[5].z, 4);
    EXPECT_EQ(corner.is_closed, std::vector<std::uint8_t>(24, 1));
    const SurfaceParts side = take_apart(together(one, box({1, 0, 0}, {2, 1, 1})));
    EXPECT_EQ(side.parts.size(), 1U);
    EXPECT_EQ(side.is_closed, std::vector<std::uint8_t>(24, 1)) << "four facets on shared edges";
    auto torn = together(one, box({1, 0, 0}, {2, 1, 1}));
    torn.pop_back();
    EXPECT_EQ(take_apart(torn).is_closed, std::vector<std::uint8_t>(23, 0));
    const SurfaceParts apart = take_apart(together(one, box({2, 2, 2}, {3, 3, 3})));
    EXPECT_EQ(apart.parts.size(), 2U);
    auto open = box({2, 2, 2}, {3, 3, 3});
    open.pop_back();
    const SurfaceParts mixed = take_apart(together(one, open));
    EXPECT_EQ(mixed.parts.size(), 2U);
    for (std::size_t i = 0; i < mixed.is_closed.size(); ++i) {
        EXPECT_EQ(mixed.is_closed[i], i < 12 ? 1 : 0) << i;
    }
}

}  // namespace
}  // namespace axg
