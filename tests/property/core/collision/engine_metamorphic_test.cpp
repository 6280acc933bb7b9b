// SPDX-License-Identifier: Apache-2.0
// The engine's results do not depend on words that mean the same: both bodies moved together by an
// exact motion (quarter turns and mirrors of the frame), or a and b swapped where the inverse of
// the pose is exact. Trees, tight boxes and the order of sums are others then; the proof and the
// number of touching pairs are the same, and the certified clearance within its own rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::run_query;

std::uint32_t compared_count(std::uint32_t usual) {
#if !defined(NDEBUG)
    usual /= 10;
#endif
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

/// x, y, z become the coordinates of these numbers, times 1 or -1: exact.
struct Motion {
    int axes[3];
    int signs[3];
};
constexpr Motion kMotions[] = {{{1, 2, 0}, {1, 1, 1}},
                               {{1, 0, 2}, {-1, 1, 1}},
                               {{0, 2, 1}, {1, 1, 1}},
                               {{2, 1, 0}, {-1, -1, -1}}};

Vec3f moved(const Motion& m, const Vec3f& v) {
    const float c[3] = {v.x, v.y, v.z};
    const auto at = [&](int k) { return static_cast<float>(m.signs[k]) * c[m.axes[k]]; };
    return {at(0), at(1), at(2)};
}

std::vector<Mesh> moved(const Motion& m, std::vector<Mesh> meshes) {
    for (Mesh& mesh : meshes) {
        for (Triangle& t : mesh.triangles) {
            t = {moved(m, t.a), moved(m, t.b), moved(m, t.c)};
        }
    }
    return meshes;
}

/// M P M^-1: the same placement, told in the moved frame.
Pose moved(const Motion& m, const Pose& p) {
    Pose out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[i][j] = m.signs[i] * m.signs[j] * p.r[m.axes[i]][m.axes[j]];
        }
        out.t[i] = m.signs[i] * p.t[m.axes[i]];
    }
    return out;
}

/// Clearances are proven in double: their last bits may differ.
constexpr double kClearanceMm = 1e-9;

struct Compared {
    std::uint32_t far = 0, near = 0, over = 0;
    double widest_mm = 0;

    void one(const QueryResult& is, const QueryResult& was, QueryKind what, std::uint32_t query) {
        if (is.status != QueryStatus::ok || was.status != QueryStatus::ok) {
            ++over;
            return;
        }
        EXPECT_EQ(is.proof, was.proof) << "question " << query;
        if (what == QueryKind::touching) {
            EXPECT_EQ(is.touching, was.touching) << "question " << query;
        }
        const double between_mm = std::fabs(is.clearance_mm - was.clearance_mm);
        widest_mm = std::max(widest_mm, between_mm);
        EXPECT_LE(between_mm, kClearanceMm) << "question " << query;
        ++(was.proof == Proof::far ? far : near);
    }
    void show(const char* what, std::uint32_t count) const {
        std::printf("%s: %u far, %u not, %u over capacity; clearances differ by %.3g um at most\n",
                    what, far, near, over, 1e3 * widest_mm);
        EXPECT_GT(far, count / 10);
        EXPECT_GT(near, count / 10);
        EXPECT_LT(over, count / 10);
    }
};

struct DrawnSurfaces {
    test::Draw draw{test::printed_seed(20261206)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    CpuEngine engine = *test::engine_over(meshes);
};

TEST(EngineMetamorphic, ACommonExactMotionChangesNothing) {
    DrawnSurfaces fixture;
    std::vector<CpuEngine> engines;
    for (const Motion& m : kMotions) {
        engines.push_back(*test::engine_over(moved(m, fixture.meshes)));
    }
    Compared all;
    const std::uint32_t count = compared_count(3000);
    for (std::uint32_t i = 0; i < count && !HasFailure(); ++i) {
        Query q =
            test::random_query(fixture.draw, static_cast<std::uint32_t>(fixture.meshes.size()));
        q.pose_error_mm = 0;
        const QueryResult was = run_query(fixture.engine, q);
        for (std::size_t m = 0; m < engines.size(); ++m) {
            Query again = q;
            again.pose = moved(kMotions[m], q.pose);
            all.one(run_query(engines[m], again), was, q.kind, i);
        }
    }
    all.show("common motion", 4 * count);
}

TEST(EngineMetamorphic, SwappingTheBodiesChangesNothing) {
    DrawnSurfaces fixture;
    Compared all;
    const std::uint32_t count = compared_count(10000);
    for (std::uint32_t i = 0; i < count && !HasFailure(); ++i) {
        Query q =
            test::random_query(fixture.draw, static_cast<std::uint32_t>(fixture.meshes.size()));
        q.pose_error_mm = 0;
        Pose turn;  // a quarter turn, whose inverse is exact
        const Motion& m = kMotions[i % 4];
        for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < 3; ++j) {
                turn.r[k][j] = j == m.axes[k] ? m.signs[k] : 0;
            }
            turn.t[k] = i % 3 == 0 ? std::floor(q.pose.t[k]) : q.pose.t[k];
        }
        q.pose = turn;
        Query back = q;
        std::swap(back.mesh_a, back.mesh_b);
        back.pose = inverse(turn);
        all.one(run_query(fixture.engine, back), run_query(fixture.engine, q), q.kind, i);
    }
    all.show("swap", count);
}

}  // namespace
}  // namespace axg
