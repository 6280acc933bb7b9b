// SPDX-License-Identifier: Apache-2.0
// What holds for any surfaces, any poses and any query: equal bits on every lane set, more
// margin never proves more, the three kinds of query agree, and so do the two ways round.
#include "core/collision/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::run_query;

constexpr double kToleranceMm = 1.0e-3;  // what the certified bounds may lose, and much more

std::uint32_t query_count(std::uint32_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

struct Fixture {
    test::Draw draw{test::printed_seed(2026)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    CpuEngine engine = *test::engine_over(meshes);

    Query query() { return test::random_query(draw, static_cast<std::uint32_t>(meshes.size())); }
};

std::uint64_t hash_of(CpuEngine& engine, Query query) {
    std::vector<TriangleIds> list(64);
    query.list = list;
    const QueryResult result = run_query(engine, query);
    test::Hash hash;
    hash.add(result, list);
    return hash.value();
}

TEST(EngineProperty, EveryLaneSetGivesEqualBits) {
    Fixture fixture;
    std::vector<CpuEngine> engines;
    for (const LaneSet set : test::lane_sets()) {
        engines.push_back(*test::engine_over(fixture.meshes, {}, set));
    }
    if (engines.size() < 2) {
        GTEST_SKIP() << "this processor runs one lane set only";
    }
    // Few places: overflow must come at the same place as well.
    const Capacities few{200, 2000, 20};
    std::vector<CpuEngine> small;
    for (const LaneSet set : test::lane_sets()) {
        small.push_back(*test::engine_over(fixture.meshes, few, set));
    }
    std::uint32_t far = 0, overflows = 0;
    const std::uint32_t count = query_count(20000);
    for (std::uint32_t i = 0; i < count; ++i) {
        Query q = fixture.query();
        q.is_float_only = i % 4 == 1;
        const std::uint64_t wanted = hash_of(engines[0], q), wanted_few = hash_of(small[0], q);
        for (std::size_t e = 1; e < engines.size(); ++e) {
            ASSERT_EQ(hash_of(engines[e], q), wanted) << engines[e].lanes() << " question " << i;
            ASSERT_EQ(hash_of(small[e], q), wanted_few) << engines[e].lanes() << " question " << i;
        }
        const QueryResult result = run_query(small[0], q);
        far += result.proof == Proof::far ? 1 : 0;
        overflows += result.status != QueryStatus::ok ? 1 : 0;
    }
    EXPECT_GT(far, count / 10);
    EXPECT_LT(far, count - count / 10);
    EXPECT_GT(overflows, count / 100) << "the small capacities were met";
}

TEST(EngineProperty, MoreMarginNeverProvesMore) {
    Fixture fixture;
    const std::uint32_t count = query_count(4000);
    std::uint32_t changes = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Query q = fixture.query();
        q.kind = i % 2 == 0 ? QueryKind::farther : QueryKind::touching;
        Proof before = Proof::far;
        std::uint32_t touching = 0;
        for (const double r : {1e-6, 0.001, 0.1, 1.0, 1.0001, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
            q.r_mm = r;
            const QueryResult result = run_query(fixture.engine, q);
            if (result.status != QueryStatus::ok) {
                break;  // near from here on: wider margins are more work
            }
            ASSERT_TRUE(before == Proof::far || result.proof == Proof::not_proven)
                << "question " << i << " r " << r;
            changes += before != result.proof ? 1 : 0;
            before = result.proof;
            if (q.kind == QueryKind::touching) {
                ASSERT_GE(result.touching, touching) << "question " << i << " r " << r;
                touching = result.touching;
            }
        }
    }
    EXPECT_GT(changes, count / 2) << "most questions met both answers";
}

TEST(EngineProperty, TheThreeKindsOfQueryAgree) {
    Fixture fixture;
    const std::uint32_t count = query_count(8000);
    std::uint32_t near = 0, between = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Query q = fixture.query();
        q.r_mm = 0;
        q.kind = QueryKind::farther;
        const QueryResult contact = run_query(fixture.engine, q);
        q.kind = QueryKind::touching;
        const QueryResult touching = run_query(fixture.engine, q);
        q.kind = QueryKind::clearance;
        q.r_mm = 50;
        const QueryResult clearance = run_query(fixture.engine, q);
        ASSERT_EQ(contact.proof, touching.proof) << i;
        ASSERT_EQ(touching.touching == 0, touching.proof == Proof::far) << i;
        ASSERT_EQ(clearance.proof == Proof::far, clearance.clearance_mm > 0) << i;
        ASSERT_LE(clearance.clearance_mm, 50) << i;
        if (clearance.status != QueryStatus::ok) {
            continue;
        }
        ASSERT_EQ(clearance.proof, contact.proof) << i << " " << clearance.clearance_mm;
        near += contact.proof == Proof::far ? 0 : 1;
        if (clearance.clearance_mm < 2 * kToleranceMm || clearance.clearance_mm >= 50) {
            continue;
        }
        ++between;
        // The certified bound is near the distance: the margin's proof ends just beyond it. The
        // error of a pose is allowed for with up to an eighth more on one of the two ways.
        const double slack = kToleranceMm + q.pose_error_mm;
        q.kind = QueryKind::farther;
        q.r_mm = std::max(1e-6, clearance.clearance_mm - slack);
        ASSERT_EQ(run_query(fixture.engine, q).proof, Proof::far)
            << i << " " << clearance.clearance_mm;
        q.r_mm = clearance.clearance_mm + slack;
        ASSERT_EQ(run_query(fixture.engine, q).proof, Proof::not_proven) << i;
    }
    EXPECT_GT(near, count / 10);
    EXPECT_GT(between, count / 10);
}

TEST(EngineProperty, ANamedPairIsAsNearAsTheClearanceSays) {
    Fixture fixture;
    const std::uint32_t count = query_count(3000);
    std::uint32_t checked = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Query q = fixture.query();
        q.kind = QueryKind::clearance;
        q.r_mm = 40;
        const QueryResult whole = run_query(fixture.engine, q);
        if (whole.status != QueryStatus::ok || whole.clearance_mm >= 40) {
            continue;
        }
        const Mesh a{"a", {fixture.meshes[q.mesh_a].triangles.at(whole.nearest.a)}};
        const Mesh b{"b", {fixture.meshes[q.mesh_b].triangles.at(whole.nearest.b)}};
        CpuEngine two = *test::engine_over({a, b});
        q.mesh_a = 0;
        q.mesh_b = 1;
        const QueryResult alone = run_query(two, q);
        ASSERT_NEAR(alone.clearance_mm, whole.clearance_mm, kToleranceMm + q.pose_error_mm) << i;
        ++checked;
    }
    EXPECT_GT(checked, count / 4);
}

TEST(EngineProperty, TheTwoWaysRoundAgreeOutsideAMicrometre) {
    Fixture fixture;
    const std::uint32_t count = query_count(8000);
    std::uint32_t compared = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Query q = fixture.query();
        q.kind = QueryKind::clearance;
        q.r_mm = 50;
        q.pose_error_mm = 0;
        Query back = q;
        std::swap(back.mesh_a, back.mesh_b);
        back.pose = inverse(q.pose);
        const QueryResult there = run_query(fixture.engine, q),
                          again = run_query(fixture.engine, back);
        if (there.status != QueryStatus::ok || again.status != QueryStatus::ok) {
            continue;
        }
        ASSERT_NEAR(there.clearance_mm, again.clearance_mm, 1e-3) << i;
        const double margin = fixture.draw.between(0, 10);
        if (std::abs(there.clearance_mm - margin) < 1e-3) {
            continue;  // inside the band either result is right
        }
        q.kind = back.kind = QueryKind::farther;
        q.r_mm = back.r_mm = margin;
        const QueryResult one = run_query(fixture.engine, q), two = run_query(fixture.engine, back);
        if (one.status == QueryStatus::ok && two.status == QueryStatus::ok) {
            ASSERT_EQ(one.proof, two.proof) << i;
            ++compared;
        }
    }
    EXPECT_GT(compared, count / 2);
}

TEST(EngineProperty, TheOrderOfQueriesDoesNotMatter) {
    Fixture fixture;
    std::vector<Query> queries(query_count(2000));
    std::generate(queries.begin(), queries.end(), [&fixture] { return fixture.query(); });
    std::vector<QueryResult> first(queries.size()), second(queries.size());
    fixture.engine.run(queries, first);
    for (std::size_t i = queries.size(); i > 1; --i) {
        const std::size_t j = fixture.draw.below(static_cast<std::uint32_t>(i));
        std::swap(queries[i - 1], queries[j]);
        std::swap(first[i - 1], first[j]);
    }
    fixture.engine.run(queries, second);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        test::Hash one, two;
        one.add(first[i], {});
        two.add(second[i], {});
        ASSERT_EQ(one.value(), two.value()) << i;
    }
}

TEST(EngineProperty, FewerPlacesNeverProveMore) {
    Fixture fixture;
    const std::uint32_t count = query_count(4000);
    std::uint32_t lost = 0;
    CpuEngine few = *test::engine_over(fixture.meshes, {40, 100, 4});
    for (std::uint32_t i = 0; i < count; ++i) {
        const Query q = fixture.query();
        const QueryResult full = run_query(fixture.engine, q), less = run_query(few, q);
        ASSERT_TRUE(less.proof == Proof::not_proven || full.proof == Proof::far) << i;
        ASSERT_LE(less.clearance_mm, full.clearance_mm) << i;
        lost += full.proof != less.proof ? 1 : 0;
    }
    EXPECT_GT(lost, count / 50);
}

}  // namespace
}  // namespace axg
