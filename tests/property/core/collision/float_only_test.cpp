// SPDX-License-Identifier: Apache-2.0
// Queries in float alone, as boxes have them with `rechecks: 0`: what they lose is about the band
// of docs/theory/accuracy.md, section 7, and nothing that touches is ever far. AXG_COUNT: queries;
// the record is of 1e6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr double kUnit = 0x1p-24;
// Float finds the direction between near-parallel edges badly now and then.
constexpr double kBandsMost = 64;

/// What float alone leaves undecided, as a rule: twice 9u <|L|, M + d> of a vector of length 1,
/// where no coordinate exceeds C; what the pose error counts for; and what a margin is rounded up
/// by.
double query_band_mm(const Query& query, double reach_a_mm, double reach_b_mm) {
    double t = 0;
    for (const double x : query.pose.t) {
        t = std::max(t, std::fabs(x));
    }
    const double coordinate_mm = t + 3 * reach_a_mm + 2 * reach_b_mm;
    return 18 * kUnit * std::sqrt(3.0) * coordinate_mm + 6 * query.pose_error_mm +
           0x1p-18 * query.r_mm;
}

Capacities with_rechecks(std::uint32_t rechecks) {
    return {.node_pairs = 1U << 18U, .triangle_pairs = 1U << 24U, .rechecks = rechecks};
}

class FloatOnly : public testing::Test {
  protected:
    /// Without the last body: its triangles of 5 um have edges that are mostly rounding.
    Query query() {
        Query q = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()) - 1);
        q.kind = QueryKind::clearance;
        q.r_mm = 100;
        q.pose_error_mm = kPlacementErrorMm;
        return q;
    }
    [[nodiscard]] double band_of(const Query& q) const {
        return query_band_mm(q, engine->trees()[q.mesh_a].reach_mm,
                             engine->trees()[q.mesh_b].reach_mm);
    }
    /// Of a box: nothing is tested in double, whatever the capacity.
    QueryResult in_float(Query q, double r_mm) {
        q.kind = QueryKind::farther;
        q.r_mm = r_mm;
        q.is_float_only = true;
        const QueryResult result = test::run_query(*engine, q);
        EXPECT_EQ(result.status, QueryStatus::ok);
        EXPECT_EQ(result.rechecks, 0U);
        return result;
    }
    Proof in_double(Query q, double r_mm) {
        q.kind = QueryKind::farther;
        q.r_mm = r_mm;
        return test::run_query(*rechecking, q).proof;
    }

    test::Draw draw{test::printed_seed(20261123)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::optional<CpuEngine> engine = test::engine_over(meshes, with_rechecks(0));
    std::optional<CpuEngine> rechecking = test::engine_over(meshes, with_rechecks(1U << 20U));
};

TEST_F(FloatOnly, NothingIsLostThatIsFartherThanTheBandAndNothingNearerIsFar) {
    const char* const text = std::getenv("AXG_COUNT");
    const std::uint32_t count =
        text == nullptr ? 20000 : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
    std::uint32_t apart = 0, undecided = 0, beyond = 0, touching = 0, asked = 0;
    while (asked < count && !HasFailure()) {
        Query q = query();
        const double clearance_mm = test::run_query(*rechecking, q).clearance_mm;
        if (clearance_mm == 0) {
            ++asked;
            ++touching;
            EXPECT_EQ(in_float(q, 0).proof, Proof::not_proven) << "query " << asked;
            EXPECT_EQ(in_float(q, draw.between(0, 5)).proof, Proof::not_proven);
            continue;
        }
        q.r_mm = clearance_mm;
        const double band = band_of(q);
        for (const double share : {kBandsMost, 1.0, 0.1, 0.01}) {
            const double r_mm = clearance_mm - share * band;
            if (r_mm < 0 || clearance_mm == 100) {
                continue;
            }
            ++asked;
            ++apart;
            const Proof proof = in_float(q, r_mm).proof;
            beyond += proof != Proof::far && share >= 1 ? 1 : 0;
            EXPECT_TRUE(proof == Proof::far || share < kBandsMost)
                << "query " << asked << ": lost at " << r_mm << " mm of " << clearance_mm;
            if (proof != Proof::far) {
                ++undecided;
            } else {
                EXPECT_EQ(in_double(q, r_mm), Proof::far) << "float alone proves no more";
            }
        }
        if (clearance_mm < 100) {  // short of the distance by 1e-8 of the bodies at most
            EXPECT_EQ(in_float(q, clearance_mm + 1e-5).proof, Proof::not_proven);
        }
    }
    std::printf("%u queries apart, %u of them undecided, %u beyond the band; %u touching\n", apart,
                undecided, beyond, touching);
    EXPECT_LE(beyond, 8 + count / 2000) << "seldom";
    EXPECT_GT(touching, count / 50);
    EXPECT_GT(undecided, count / 100) << "the queries are too easy to tell";
}

}  // namespace
}  // namespace axg
