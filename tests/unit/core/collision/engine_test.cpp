// SPDX-License-Identifier: Apache-2.0
// The engine's contract where it can go wrong: contact without depth, both sides of a margin,
// queries that make no sense, lists that are one too short. On every lane set of this processor.
#include "core/collision/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

using test::run_query;
using test::shifted;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr QueryKind kQueryKinds[] = {QueryKind::farther, QueryKind::touching, QueryKind::clearance};

enum : std::uint32_t { kCube, kEmpty, kBallA, kBallB, kMeshes };

std::vector<Mesh> surfaces() {
    test::Draw draw(4);
    return {{"cube", test::box({0, 0, 0}, {10, 10, 10})},
            {"empty", {}},
            test::lumpy_ball(draw, 6, 30, 0.2),
            test::lumpy_ball(draw, 9, 40, 0.2)};
}

class Engine : public testing::TestWithParam<LaneSet> {
  protected:
    [[nodiscard]] CpuEngine make(const Capacities& capacities = {}) const {
        return *test::engine_over(surfaces(), capacities, GetParam());
    }
    static Query cubes(QueryKind kind, const Pose& pose, double r_mm) {
        Query q;
        q.kind = kind;
        q.mesh_a = q.mesh_b = kCube;
        q.pose = pose;
        q.r_mm = r_mm;
        return q;
    }
};

INSTANTIATE_TEST_SUITE_P(Lanes, Engine, testing::ValuesIn(test::lane_sets()), [](const auto& set) {
    return set.param == LaneSet::avx512 ? "avx512" : set.param == LaneSet::avx2 ? "avx2" : "neon";
});

void expect_near(const QueryResult& result) {
    EXPECT_EQ(result.status, QueryStatus::ok);
    EXPECT_EQ(result.proof, Proof::not_proven);
    EXPECT_EQ(result.clearance_mm, 0);
}

TEST(EngineResult, ZeroedMemoryMeansNear) {
    const QueryResult result{};
    EXPECT_EQ(result.status, QueryStatus::not_run);
    EXPECT_EQ(result.proof, Proof::not_proven);
    EXPECT_EQ(result.clearance_mm, 0);
    EXPECT_EQ(static_cast<int>(Proof::not_proven), 0);
    EXPECT_EQ(static_cast<int>(QueryStatus::not_run), 0);
}

TEST_P(Engine, ASharedFaceEdgeOrVertexIsNotProvenApart) {
    CpuEngine engine = make();
    for (const Pose& pose : {shifted(10, 0, 0), shifted(0, -10, 0), shifted(10, 10, 0),
                             shifted(-10, 0, 10), shifted(10, 10, 10), shifted(-10, 10, -10)}) {
        for (const QueryKind kind : kQueryKinds) {
            SCOPED_TRACE(static_cast<int>(kind));
            const QueryResult result =
                run_query(engine, cubes(kind, pose, kind == QueryKind::clearance ? 50 : 0));
            expect_near(result);
            if (kind == QueryKind::touching) {
                EXPECT_GT(result.touching, 0U);
            }
        }
    }
}

TEST_P(Engine, AMicrometreOfAirIsProven) {
    CpuEngine engine = make();
    for (const Pose& pose :
         {shifted(10 + 1e-3, 0, 0), shifted(10 + 1e-3, 10, 0), shifted(10, 10, 10 + 1e-3)}) {
        for (const QueryKind kind : kQueryKinds) {
            const QueryResult result =
                run_query(engine, cubes(kind, pose, kind == QueryKind::clearance ? 50 : 0));
            EXPECT_EQ(result.proof, Proof::far);
            EXPECT_EQ(result.touching, 0U);
        }
    }
}

TEST_P(Engine, AMarginHasTwoSides) {
    CpuEngine engine = make();
    // Face to face, edge to edge (3-4-5), corner to corner (2-3-6 makes 7).
    const struct {
        Pose pose;
        double distance_mm;
    } cases[] = {{shifted(15, 1, 2), 5}, {shifted(13, 14, 3), 5}, {shifted(12, 13, 16), 7}};
    for (const auto& c : cases) {
        for (const QueryKind kind : {QueryKind::farther, QueryKind::touching}) {
            EXPECT_EQ(run_query(engine, cubes(kind, c.pose, c.distance_mm - 1e-4)).proof,
                      Proof::far);
            EXPECT_EQ(run_query(engine, cubes(kind, c.pose, c.distance_mm)).proof,
                      Proof::not_proven);
            const QueryResult inside = run_query(engine, cubes(kind, c.pose, c.distance_mm + 1e-4));
            EXPECT_EQ(inside.proof, Proof::not_proven);
            EXPECT_EQ(inside.status, QueryStatus::ok);
            EXPECT_GT(inside.touching, 0U);
        }
        const QueryResult near = run_query(engine, cubes(QueryKind::clearance, c.pose, 50));
        EXPECT_LE(near.clearance_mm, c.distance_mm);
        EXPECT_GT(near.clearance_mm, c.distance_mm - 1e-6);
    }
}

TEST_P(Engine, APoseErrorCountsAsDistanceLost) {
    CpuEngine engine = make();
    Query q = cubes(QueryKind::farther, shifted(10.5, 0, 0), 0);
    q.pose_error_mm = 0.4;
    EXPECT_EQ(run_query(engine, q).proof, Proof::far);
    q.pose_error_mm = 0.501;
    EXPECT_EQ(run_query(engine, q).proof, Proof::not_proven);
    q.kind = QueryKind::clearance;
    q.r_mm = 50;
    q.pose_error_mm = 0.4;
    EXPECT_LE(run_query(engine, q).clearance_mm, 0.1);
    EXPECT_GT(run_query(engine, q).clearance_mm, 0.04);
}

TEST_P(Engine, ClearanceIsTheLimitWhenNothingIsNearerAndZeroAtNoInterest) {
    CpuEngine engine = make();
    for (const double limit : {1e-6, 0.1, 50.0, 89.9}) {
        const QueryResult result =
            run_query(engine, cubes(QueryKind::clearance, shifted(100, 0, 0), limit));
        EXPECT_EQ(result.clearance_mm, limit);
        EXPECT_EQ(result.proof, Proof::far);
        EXPECT_EQ(result.nearest, TriangleIds{});
    }
    expect_near(run_query(engine, cubes(QueryKind::clearance, shifted(100, 0, 0), 0)));
}

TEST_P(Engine, ClearanceNamesThePairThatSetIt) {
    CpuEngine engine = make();
    const QueryResult result =
        run_query(engine, cubes(QueryKind::clearance, shifted(13, 1, 2), 50));
    const Mesh cube = surfaces()[kCube];
    const auto least_x = [](const Triangle& t) { return std::min({t.a.x, t.b.x, t.c.x}); };
    const auto most_x = [](const Triangle& t) { return std::max({t.a.x, t.b.x, t.c.x}); };
    EXPECT_EQ(least_x(cube.triangles.at(result.nearest.a)), 0) << "the moved cube's near face";
    EXPECT_EQ(most_x(cube.triangles.at(result.nearest.b)), 10);
}

TEST_P(Engine, QueriesThatMakeNoSenseAreRefusedAndNear) {
    CpuEngine engine = make();
    std::vector<std::pair<const char*, Query>> bad;
    const auto add = [&bad](const char* name, auto change) {
        Query q = cubes(QueryKind::farther, shifted(1000, 0, 0), 1);
        change(q);
        bad.emplace_back(name, q);
    };
    add("mesh a", [](Query& q) { q.mesh_a = kMeshes; });
    add("mesh b", [](Query& q) { q.mesh_b = 0xffffffffU; });
    add("empty a", [](Query& q) { q.mesh_a = kEmpty; });
    add("empty b", [](Query& q) { q.mesh_b = kEmpty; });
    add("r below 0", [](Query& q) { q.r_mm = -1e-300; });
    add("r NaN", [](Query& q) { q.r_mm = kNaN; });
    add("r infinite", [](Query& q) { q.r_mm = kInfinity; });
    add("r too large", [](Query& q) { q.r_mm = std::nextafter(kMarginMmMax, kInfinity); });
    add("error below 0", [](Query& q) { q.pose_error_mm = -1e-12; });
    add("error NaN", [](Query& q) { q.pose_error_mm = kNaN; });
    add("error large", [](Query& q) { q.pose_error_mm = std::nextafter(1.0, 2.0); });
    for (int k = 0; k < 3; ++k) {
        add("t NaN", [k](Query& q) { q.pose.t[k] = kNaN; });
        add("t infinite", [k](Query& q) { q.pose.t[k] = -kInfinity; });
        add("t too far",
            [k](Query& q) { q.pose.t[k] = std::nextafter(4 * kCoordinateMmMax, kInfinity); });
        for (int j = 0; j < 3; ++j) {
            add("r NaN", [=](Query& q) { q.pose.r[k][j] = kNaN; });
            add("r infinite", [=](Query& q) { q.pose.r[k][j] = kInfinity; });
            add("not rigid", [=](Query& q) { q.pose.r[k][j] += 1e-8; });
        }
    }
    add("scaled", [](Query& q) {
        for (auto& row : q.pose.r) {
            for (double& x : row) {
                x *= 1.1;
            }
        }
    });
    for (auto& [name, query] : bad) {
        for (const QueryKind kind : kQueryKinds) {
            SCOPED_TRACE(name);
            query.kind = kind;
            const QueryResult result = run_query(engine, query);
            EXPECT_EQ(result.status, QueryStatus::bad_query);
            EXPECT_EQ(result.proof, Proof::not_proven);
            EXPECT_EQ(result.clearance_mm, 0);
            EXPECT_EQ(result.touching, 0U);
        }
    }
}

TEST_P(Engine, TheLargestValuesAllowedGiveResults) {
    CpuEngine engine = make();
    Query q = cubes(QueryKind::farther, shifted(4 * kCoordinateMmMax, 0, 0), kMarginMmMax);
    EXPECT_EQ(run_query(engine, q).proof, Proof::far);
    q.pose_error_mm = 1.0;
    EXPECT_EQ(run_query(engine, q).proof, Proof::far);
    q.pose.r[0][0] += 0.4e-9;  // |R^T R - I| = 0.8e-9
    EXPECT_EQ(run_query(engine, q).status, QueryStatus::ok);
    q.pose.r[0][0] += 0.2e-9;  // 1.2e-9
    EXPECT_EQ(run_query(engine, q).status, QueryStatus::bad_query);
}

TEST_P(Engine, TheListOfTouchingPairsIsCutAtItsLengthNotTheCount) {
    CpuEngine engine = make();
    Query q;
    q.kind = QueryKind::touching;
    q.mesh_a = kBallA;
    q.mesh_b = kBallB;
    q.pose = shifted(50, 3, 1);
    const std::uint32_t count = run_query(engine, q).touching;
    ASSERT_GT(count, 10U);
    std::vector<TriangleIds> whole(count);
    q.list = whole;
    EXPECT_EQ(run_query(engine, q).touching, count);
    EXPECT_EQ(std::set<TriangleIds>(whole.begin(), whole.end()).size(), count) << "each pair once";
    constexpr TriangleIds kMark{77777, 88888};
    for (const std::uint32_t length : {0U, 1U, count - 1, count, count + 1}) {
        std::vector<TriangleIds> list(length + 1, kMark);
        q.list = std::span(list).first(length);
        EXPECT_EQ(run_query(engine, q).touching, count);
        EXPECT_EQ(list[length], kMark) << "nothing is written behind the end";
        for (std::uint32_t i = 0; i < length; ++i) {
            EXPECT_EQ(list[i], i < count ? whole[i] : kMark);
        }
    }
}

bool equal(const QueryResult& a, const QueryResult& b) {
    test::Hash one, two;
    one.add(a, {});
    two.add(b, {});
    return one.value() == two.value();
}

void expect_overflow(const QueryResult& result, QueryStatus status) {
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(result.proof, Proof::not_proven);
    EXPECT_EQ(result.clearance_mm, 0);
}

TEST_P(Engine, ListsOneTooShortAreNotProvenAndListsJustLongEnoughChangeNothing) {
    CpuEngine ample = make();
    const Capacities usual;
    for (const QueryKind kind : kQueryKinds) {
        SCOPED_TRACE(static_cast<int>(kind));
        Query q;
        q.mesh_a = kBallA;
        q.mesh_b = kBallB;
        q.r_mm = 0.5;
        double x = 90;  // the last place of an approach at which the margin is proven: most work
        do {
            x -= 0.125;
            q.pose = shifted(x, 5, 2);
        } while (run_query(ample, q).proof == Proof::far);
        q.pose = shifted(x + 0.125, 5, 2);
        q.kind = kind;
        q.r_mm = kind == QueryKind::clearance ? 50 : 0.5;
        const QueryResult full = run_query(ample, q);
        ASSERT_EQ(full.proof, Proof::far) << "a proof that is then lost";
        ASSERT_GT(full.node_pairs, 2U);
        ASSERT_GT(full.triangle_pairs, 2U);
        for (const int more : {-1, 0, 1}) {
            Capacities few = usual;
            few.node_pairs = full.node_pairs + static_cast<std::uint32_t>(more);
            CpuEngine nodes = make(few);
            few = usual;
            few.triangle_pairs = full.triangle_pairs + static_cast<std::uint32_t>(more);
            CpuEngine triangles = make(few);
            if (more < 0) {
                expect_overflow(run_query(nodes, q), QueryStatus::too_many_node_pairs);
                expect_overflow(run_query(triangles, q), QueryStatus::too_many_triangle_pairs);
            } else {
                EXPECT_TRUE(equal(run_query(nodes, q), full));
                EXPECT_TRUE(equal(run_query(triangles, q), full));
            }
        }
    }
}

TEST_P(Engine, RechecksOneTooManyAreNotProven) {
    CpuEngine ample = make();
    for (const QueryKind kind : {QueryKind::farther, QueryKind::touching}) {
        // So near that float32 cannot prove it and double can.
        const Query q = cubes(kind, shifted(10 + 2e-9, 0, 0), 0);
        const QueryResult full = run_query(ample, q);
        ASSERT_EQ(full.proof, Proof::far);
        ASSERT_GT(full.rechecks, 1U);
        for (const int more : {-1, 0, 1}) {
            Capacities few;
            few.rechecks = full.rechecks + static_cast<std::uint32_t>(more);
            CpuEngine engine = make(few);
            if (more < 0) {
                expect_overflow(run_query(engine, q), QueryStatus::too_many_rechecks);
            } else {
                EXPECT_TRUE(equal(run_query(engine, q), full));
            }
        }
    }
}

TEST_P(Engine, WithoutAnyRoomNothingIsProven) {
    Capacities none;
    none.node_pairs = 0;
    CpuEngine engine = make(none);
    for (const QueryKind kind : kQueryKinds) {
        expect_overflow(run_query(engine, cubes(kind, shifted(1000, 0, 0), 1)),
                        QueryStatus::too_many_node_pairs);
    }
}

TEST_P(Engine, ABadOrOverflowingQueryHarmsNoOtherOfItsBatch) {
    CpuEngine ample = make();
    Query heavy;
    heavy.kind = QueryKind::touching;
    heavy.mesh_a = kBallA;
    heavy.mesh_b = kBallB;
    heavy.pose = shifted(50, 3, 1);
    Capacities few;
    few.node_pairs = run_query(ample, heavy).node_pairs - 1;
    CpuEngine engine = make(few);
    Query bad = cubes(QueryKind::farther, shifted(kNaN, 0, 0), 0);
    const Query good = cubes(QueryKind::farther, shifted(11, 0, 0), 0.5);
    const Query queries[] = {good, bad, good, heavy, good};
    QueryResult results[5];
    for (QueryResult& result : results) {
        result.proof = Proof::far;  // what was there before must not stay
        result.clearance_mm = 9;
    }
    engine.run(queries, results);
    const QueryResult alone = run_query(engine, good);
    for (const std::size_t i : {0U, 2U, 4U}) {
        EXPECT_EQ(results[i].proof, Proof::far);
        EXPECT_TRUE(equal(results[i], alone));
    }
    EXPECT_EQ(results[1].status, QueryStatus::bad_query);
    EXPECT_EQ(results[1].proof, Proof::not_proven);
    expect_overflow(results[3], QueryStatus::too_many_node_pairs);
}

TEST(CpuEngine, PlansItsMemoryToTheByte) {
    const std::vector<Mesh> meshes = surfaces();
    Capacities small, large;
    large.node_pairs = small.node_pairs + 1024;
    const auto one = test::engine_over(meshes, small), two = test::engine_over(meshes, large);
    ASSERT_TRUE(one && two);
    EXPECT_EQ(one->memory().trees_bytes, two->memory().trees_bytes);
    EXPECT_EQ(two->memory().lists_bytes - one->memory().lists_bytes, 1024 * sizeof(NodePair));
    EXPECT_EQ(one->memory().total_bytes(), one->memory().trees_bytes + one->memory().lists_bytes);
}

TEST(CpuEngine, ALaneSetThatThisProcessorLacksIsRefused) {
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        EXPECT_EQ(test::engine_over(surfaces(), {}, set).has_value(), has_lane_set(set));
    }
    EXPECT_FALSE(has_lane_set(LaneSet::neon) && has_lane_set(LaneSet::avx2));
    EXPECT_FALSE(test::lane_sets().empty()) << kNoLaneSet;
}

TEST(CpuEngineDeathTest, AsManyResultsAsQueriesOrTheProgramStops) {
    auto engine = test::engine_over(surfaces());
    const Query queries[2] = {};
    QueryResult result;
    EXPECT_DEATH(engine->run(queries, {&result, 1}), "");
}

}  // namespace
}  // namespace axg
