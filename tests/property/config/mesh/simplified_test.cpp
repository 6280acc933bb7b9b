// SPDX-License-Identifier: Apache-2.0
// Simplified surfaces against the whole ones: no point of the whole surface is farther from the
// simplified one than was certified, and what an engine proves with the deviation as an error of
// the pose holds for the whole surfaces. The oracle measures surfaces on its own
// (tests/support/surface_distance.hpp). AXG_COUNT: points a surface; a hundredth of it, poses.
#include "config/mesh/simplify_meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/surface_distance.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

constexpr double kDistanceErrorMm = 1e-9;

struct Case {
    std::string name;
    Mesh whole;
    double most_mm;
    SimplifiedMesh simple;
};

/// Bumps of up to `height_mm`, the same for every corner at the same place.
Triangles with_bumps(Triangles triangles, double height_mm) {
    const auto bump = [=](Vec3f& v) {
        const Vec3d p = widen(v);
        const double h = height_mm * std::sin(0.7 * p.x) * std::cos(0.9 * p.y + 0.4 * p.z);
        const double scale = 1 + h / std::sqrt(dot(p, p));
        v = {static_cast<float>(scale * p.x), static_cast<float>(scale * p.y),
             static_cast<float>(scale * p.z)};
    };
    for (Triangle& t : triangles) {
        bump(t.a);
        bump(t.b);
        bump(t.c);
    }
    return triangles;
}

std::vector<Case> cases() {
    std::vector<Case> out{{"ball, 0.05 mm", {"ball", ball(20, 40)}, 0.05, {}},
                          {"ball, 0.4 mm", {"ball", ball(20, 40)}, 0.4, {}},
                          {"ring, 0.2 mm", {"ring", ring(64, 32, 40, 9)}, 0.2, {}},
                          {"bumps, 0.3 mm", {"bumps", with_bumps(ball(20, 30), 0.2)}, 0.3, {}},
                          {"fine block, 0.01 mm", {"block", ball(1, 20)}, 0.01, {}}};
    for (Case& c : out) {
        c.simple = simplify(c.whole, c.most_mm);
    }
    return out;
}

Triangle point_of(const Triangle& t, Random& random) {
    double u = between(random, 0, 1), v = between(random, 0, 1);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const Vec3d a = widen(t.a), p = a + u * (widen(t.b) - a) + v * (widen(t.c) - a);
    const Vec3f f{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    return {f, f, f};
}

TEST(Simplified, NoPointIsFartherThanCertified) {
    Random random(printed_seed(20261180));
    const std::uint64_t count = count_from_environment(20'000);
    double tightest = 0;
    for (const Case& c : cases()) {
        const DistanceTree simple(c.simple.mesh.triangles);
        double farthest = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const Triangle& t = c.whole.triangles[random() % c.whole.triangles.size()];
            const DistanceTree point({point_of(t, random)});
            farthest = std::max(farthest, surface_distance(point, simple, Pose{}, 1.0));
        }
        std::printf("%-20s %5zu triangles of %5zu, certified %.4f mm, sampled %.4f mm\n",
                    c.name.c_str(), c.simple.mesh.triangles.size(), c.whole.triangles.size(),
                    c.simple.deviation_mm, farthest);
        // The points themselves are rounded to float.
        EXPECT_LE(farthest, c.simple.deviation_mm + 1e-5) << c.name;
        EXPECT_LE(c.simple.deviation_mm, c.most_mm) << c.name;
        tightest = c.simple.deviation_mm == 0
                       ? tightest
                       : std::max(tightest, farthest / c.simple.deviation_mm);
    }
    EXPECT_GT(tightest, 0.8);  // else the bound is too loose for this to tell anything
}

TEST(Simplified, ProofsHoldForTheWholeSurfaces) {
    Random random(printed_seed(20261181));
    const std::uint64_t count = count_from_environment(20'000) / 100;
    const std::vector<Case> all = cases();
    std::vector<Mesh> meshes;
    std::vector<DistanceTree> whole;
    for (const Case& c : all) {
        meshes.push_back(c.simple.mesh);
        whole.emplace_back(c.whole.triangles);
    }
    auto engine = engine_over(meshes);
    ASSERT_TRUE(engine);
    unsigned far = 0, wrong_without = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::size_t a = random() % all.size(), b = random() % all.size();
        Query q;
        q.kind = QueryKind::clearance;
        q.mesh_a = static_cast<std::uint32_t>(a);
        q.mesh_b = static_cast<std::uint32_t>(b);
        q.r_mm = 50;
        q.pose = random_turn(random);
        const Pose turn = random_turn(random);
        const double distance = between(random, 20, 95);
        for (int k = 0; k < 3; ++k) {
            q.pose.t[k] = distance * turn.r[k][0];
        }
        const double true_mm = surface_distance(whole[a], whole[b], q.pose, 60);
        wrong_without += run_query(*engine, q).clearance_mm > true_mm + kDistanceErrorMm ? 1 : 0;
        q.pose_error_mm = all[a].simple.deviation_mm + all[b].simple.deviation_mm;
        const QueryResult result = run_query(*engine, q);
        ASSERT_LE(result.clearance_mm, true_mm + kDistanceErrorMm) << i;
        q.kind = QueryKind::farther;
        q.r_mm = between(random, 0, 1) * true_mm;
        const bool is_far = run_query(*engine, q).proof == Proof::far;
        ASSERT_FALSE(is_far && q.r_mm > true_mm) << i;
        far += is_far ? 1 : 0;
    }
    std::printf("%llu poses: %u proven far; without the deviation %u clearances were too large\n",
                static_cast<unsigned long long>(count), far, wrong_without);
    EXPECT_GT(far, 0U);
    EXPECT_TRUE(wrong_without > 0 || count < 200);  // else this is too weak to tell anything
}

}  // namespace
}  // namespace axg::test
