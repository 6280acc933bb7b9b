// SPDX-License-Identifier: Apache-2.0
// What the engine refuses: queries, meshes and processor modes for which its proofs do not hold,
// and lists that are too short by one. All of these count as near.
#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "tests/support/solids.hpp"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace axg::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

QueryResult result_of(const Mesh& a, const Mesh& b, const Query& query,
                      const Capacities& capacities = {}) {
    const Mesh* const meshes[] = {&a, &b};
    std::optional<CpuEngine> engine = CpuEngine::create(meshes, capacities);
    EXPECT_TRUE(engine.has_value());
    QueryResult result;
    engine->run({&query, 1}, {&result, 1});
    return result;
}

const Mesh kBox{"box", box({-1, -1, -1}, {1, 1, 1})};

Query ten_apart() {
    Query q{.mesh_a = 0, .mesh_b = 1, .pose = {}};
    q.pose.t[0] = 10;
    return q;
}

void expect_status(QueryStatus expected, const Query& query) {
    const QueryResult result = result_of(kBox, kBox, query);
    EXPECT_EQ(result.status, expected);
    EXPECT_EQ(result.proof == Proof::far, expected == QueryStatus::ok);
    EXPECT_EQ(result.clearance_mm, 0);
}

TEST(RefusedQueries, NumbersOutsideTheirBounds) {
    expect_status(QueryStatus::ok, ten_apart());
    struct Bound {
        double Query::*field;
        double most;
    };
    for (const Bound& bound :
         {Bound{&Query::r_mm, kMarginMmMax}, Bound{&Query::pose_error_mm, 1.0}}) {
        Query q = ten_apart();
        q.pose.t[0] = 4e4;
        q.*bound.field = bound.most;
        expect_status(QueryStatus::ok, q);
        for (const double bad :
             {std::nextafter(bound.most, kInfinity), -0x1p-1074, kNan, kInfinity, -kInfinity}) {
            q.*bound.field = bad;
            expect_status(QueryStatus::bad_query, q);
        }
    }
}

TEST(RefusedQueries, PosesThatAreNotRigidOrTooFar) {
    const double farthest = 4 * kCoordinateMmMax;
    for (int k = 0; k < 3; ++k) {
        Query q = ten_apart();
        q.pose.t[k] = -farthest;
        expect_status(QueryStatus::ok, q);
        for (const double bad : {std::nextafter(farthest, kInfinity), kNan, kInfinity}) {
            q.pose.t[k] = bad;
            expect_status(QueryStatus::bad_query, q);
        }
        for (int j = 0; j < 3; ++j) {
            for (const double bad : {kNan, kInfinity, 1e200, 1.1}) {
                q = ten_apart();
                q.pose.r[k][j] = bad;
                expect_status(QueryStatus::bad_query, q);
            }
        }
        q = ten_apart();
        q.pose.r[k][k] = 1 + 0.45 * kRigidDefectMax;
        expect_status(QueryStatus::ok, q);
        q.pose.r[k][k] = 1 + 0.55 * kRigidDefectMax;
        expect_status(QueryStatus::bad_query, q);
    }
}

TEST(RefusedQueries, MeshesTheProofDoesNotHoldFor) {
    const auto limit = static_cast<float>(kCoordinateMmMax);
    Mesh mesh{"triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    Query q = ten_apart();
    mesh.triangles[0].c.z = -limit;
    EXPECT_EQ(result_of(mesh, kBox, q).status, QueryStatus::ok);
    for (const float bad :
         {std::nextafter(limit, 2 * limit), std::numeric_limits<float>::quiet_NaN(),
          -std::numeric_limits<float>::infinity()}) {
        mesh.triangles[0].c.z = bad;
        EXPECT_EQ(result_of(mesh, kBox, q).status, QueryStatus::bad_query) << bad;
        EXPECT_EQ(result_of(kBox, mesh, q).status, QueryStatus::bad_query) << bad;
    }
    EXPECT_EQ(result_of(Mesh{"none", {}}, kBox, q).status, QueryStatus::bad_query);
    q.mesh_b = 2;
    EXPECT_EQ(result_of(kBox, kBox, q).status, QueryStatus::bad_query);
}

// Touching faces fill every list; each list holds exactly what it must, or one less.
TEST(RefusedQueries, ListsShortByOneProveNothing) {
    for (const QueryKind kind : {QueryKind::touching, QueryKind::clearance}) {
        Query q{.kind = kind,
                .mesh_a = 0,
                .mesh_b = 1,
                .r_mm = kind == QueryKind::clearance ? 5.0 : 0,
                .pose = {}};
        q.pose.t[0] = kind == QueryKind::clearance ? 2.5 : 2;
        const QueryResult roomy = result_of(kBox, kBox, q);
        ASSERT_EQ(roomy.status, QueryStatus::ok);
        ASSERT_GT(roomy.triangle_pairs, 1U);
        const Capacities least{roomy.node_pairs, roomy.triangle_pairs, roomy.rechecks};
        const QueryResult filled = result_of(kBox, kBox, q, least);
        EXPECT_EQ(filled.status, QueryStatus::ok);
        EXPECT_EQ(filled.touching, roomy.touching);
        EXPECT_EQ(filled.clearance_mm, roomy.clearance_mm);
        Capacities shorter = least;
        --shorter.triangle_pairs;
        EXPECT_EQ(result_of(kBox, kBox, q, shorter).status, QueryStatus::too_many_triangle_pairs);
        EXPECT_EQ(result_of(kBox, kBox, q, shorter).proof, Proof::not_proven);
        EXPECT_EQ(result_of(kBox, kBox, q, shorter).clearance_mm, 0);
        shorter = least;
        --shorter.node_pairs;
        EXPECT_EQ(result_of(kBox, kBox, q, shorter).status, QueryStatus::too_many_node_pairs);
        if (kind == QueryKind::touching) {
            ASSERT_GT(roomy.rechecks, 0U);
            shorter = least;
            --shorter.rechecks;
            const QueryResult result = result_of(kBox, kBox, q, shorter);
            EXPECT_EQ(result.status, QueryStatus::too_many_rechecks);
            EXPECT_EQ(result.proof, Proof::not_proven);
        }
    }
}

TEST(RefusedQueries, ThreadsThatDoNotRoundToNearest) {
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        ASSERT_EQ(std::fesetround(mode), 0);
        const QueryResult result = result_of(kBox, kBox, ten_apart());
        ASSERT_EQ(std::fesetround(FE_TONEAREST), 0);
        EXPECT_EQ(result.status, QueryStatus::bad_rounding) << mode;
        EXPECT_EQ(result.proof, Proof::not_proven);
    }
    expect_status(QueryStatus::ok, ten_apart());
#if defined(__x86_64__)
    const unsigned usual = _mm_getcsr();
    for (const unsigned flush : {0x8000U, 0x0040U}) {  // FTZ, DAZ
        _mm_setcsr(usual | flush);
        const QueryResult result = result_of(kBox, kBox, ten_apart());
        _mm_setcsr(usual);
        EXPECT_EQ(result.status, QueryStatus::bad_rounding) << flush;
    }
#endif
}

}  // namespace
}  // namespace axg::test
