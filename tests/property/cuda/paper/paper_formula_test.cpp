// SPDX-License-Identifier: Apache-2.0
// The formula of the paper's kernels is the laboratory's paper-6-11, verdict for verdict, on both
// sides of its threshold; the axis it names separates; its boxes hold what is in them; and every
// pair of triangles tried one by one finds what the engine finds. AXG_COUNT pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <tuple>
#include <utility>

#include "cuda/paper/brute_cpu.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg::paper {
namespace {

using test::Draw;

std::uint32_t count_of(std::uint32_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

Vec3f random_point(Draw& draw, double size_mm) {
    const double x = draw.between(-size_mm, size_mm), y = draw.between(-size_mm, size_mm);
    return {static_cast<float>(x), static_cast<float>(y),
            static_cast<float>(draw.between(-size_mm, size_mm))};
}

Triangle random_triangle(Draw& draw) {
    const Vec3f at = random_point(draw, 30);
    return {at + random_point(draw, 20), at + random_point(draw, 20), at + random_point(draw, 20)};
}

/// Two triangles across one plane whose normals enclose an angle about the threshold's, or none.
std::pair<Triangle, Triangle> parallel_triangles(Draw& draw) {
    const auto tilt = static_cast<float>(draw.below(2) * draw.between(0, 2e-3));
    const auto flat = [&](float slope) {
        const Vec3f at = random_point(draw, 20);
        const auto corner = [&] {
            const Vec3f v = at + random_point(draw, 20);
            return Vec3f{v.x, v.y, slope * v.y};
        };
        return Triangle{corner(), corner(), corner()};
    };
    const Triangle a = flat(0);
    return {a, flat(tilt)};
}

TEST(PaperFormula, IsTheLaboratorys) {
    const lab::Method* const method = lab::find_method("paper-6-11-f32");
    ASSERT_NE(method, nullptr);
    Draw draw(test::printed_seed(7));
    const std::uint32_t count = count_of(200'000);
    lab::PairSet pairs;
    std::vector<unsigned> axes;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto [a, b] = i % 2 == 0 ? std::pair(random_triangle(draw), random_triangle(draw))
                                       : parallel_triangles(draw);
        pairs.add(lab::Pair<float>{{a.a, a.b, a.c}, {b.a, b.b, b.c}});
        const EdgedPair s = edged(a, b);
        axes.push_back(separating_axis<true>(s));
        ASSERT_EQ(axes.back(), separating_axis<false>(s));
        ASSERT_TRUE(axes.back() == kNoAxis || apart_along_axis(s, axes.back())) << axes.back();
    }
    const lab::Judged judged = lab::judge(*method, pairs, false);
    std::uint32_t seen[kAxes] = {}, touching = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_EQ(axes[i] == kNoAxis, judged.verdicts[i] == lab::Verdict::intersecting) << i;
        touching += axes[i] == kNoAxis ? 1 : 0;
        seen[axes[i] % kAxes] += axes[i] == kNoAxis ? 0 : 1;
    }
    // Both branches and every axis had their say.
    EXPECT_GT(touching, 0U);
    for (unsigned axis = 0; axis < kAxes; ++axis) {
        EXPECT_TRUE(seen[axis] > 0 || count < 100'000) << "axis " << axis << " never separated";
    }
}

void expect_inside(const Body& body, const SubBox& box) {
    for (std::uint32_t i = box.first; i < box.first + box.count; ++i) {
        const Triangle& t = body.triangles[i];
        EXPECT_FALSE(triangle_apart(t, box));
        for (const Vec3f& v : {t.a, t.b, t.c}) {
            const double p[3] = {v.x, v.y, v.z};
            for (int k = 0; k < 3; ++k) {
                EXPECT_LE(std::fabs(p[k] - double(box.c[k])), double(box.h[k]));
                EXPECT_LE(std::fabs(p[k]), double(body.reach_mm));
            }
        }
    }
}

TEST(PaperBody, KeepsEveryTriangleOnceInBothOrders) {
    Draw draw(test::printed_seed(8));
    for (const Mesh& mesh : test::random_surfaces(draw)) {
        const Body body = make_body(mesh.triangles);
        const auto key = [](const Triangle& t) {
            return std::tuple(t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z);
        };
        const auto less = [&](const Triangle& x, const Triangle& y) { return key(x) < key(y); };
        std::vector<Triangle> given = mesh.triangles, kept = body.triangles;
        std::sort(given.begin(), given.end(), less);
        std::sort(kept.begin(), kept.end(), less);
        EXPECT_EQ(given, kept);
        for (const std::vector<SubBox>* const list : {&body.boxes, &body.tiles}) {
            std::uint32_t next = 0;
            for (const SubBox& box : *list) {
                EXPECT_EQ(box.first, next);
                EXPECT_LE(box.count, kNodeWidth);
                expect_inside(body, box);
                next += box.count;
            }
            EXPECT_EQ(next, mesh.triangles.size());
        }
        expect_inside(body, body.whole);
    }
}

/// Every pair of triangles one by one, against the engine with its tree. A quarter of the poses are
/// shifts by whole millimetres, where touches are exact and a vertex moved wrongly shows.
TEST(PaperBrute, FindsWhatTheEngineFinds) {
    Draw draw(test::printed_seed(9));
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    const Capacities room{
        .node_pairs = 1U << 16U, .triangle_pairs = 1U << 22U, .rechecks = 1U << 22U};
    std::optional<CpuEngine> engine = test::engine_over(meshes, room);
    ASSERT_TRUE(engine);
    std::vector<Body> bodies;
    for (const Mesh& mesh : meshes) {
        bodies.push_back(make_body(mesh.triangles));
    }
    std::uint32_t touching = 0, naive_differs = 0;
    const std::uint32_t count = std::min(200U, count_of(200));
    for (std::uint32_t i = 0; i < count; ++i) {
        Query query;
        query.kind = QueryKind::touching;
        query.mesh_a = draw.below(static_cast<std::uint32_t>(meshes.size()));
        query.mesh_b = draw.below(static_cast<std::uint32_t>(meshes.size()));
        const bool is_shift = i % 4 == 0;
        if (!is_shift) {
            query.pose = test::random_rotation(draw);
        }
        const Pose direction = test::random_rotation(draw);
        const double away = draw.between(0, 130);
        for (int k = 0; k < 3; ++k) {
            query.pose.t[k] = is_shift ? 8.0 * (draw.below(17) - 8.0) : away * direction.r[k][0];
        }
        const QueryResult result = test::run_query(*engine, query);
        ASSERT_EQ(result.status, QueryStatus::ok);
        const Body &a = bodies[query.mesh_a], &b = bodies[query.mesh_b];
        const Found certified = test_certified(*lane_kernels(LaneSet::widest), a, b, query.pose);
        const Found naive = test_naively(a, b, query.pose);
        EXPECT_EQ(certified.touching, result.touching) << "question " << i;
        EXPECT_EQ(certified.tested, a.triangles.size() * b.triangles.size());
        EXPECT_EQ(naive.tested, certified.tested);
        naive_differs += !is_shift && (naive.touching == 0) != (result.touching == 0) ? 1 : 0;
        touching += result.touching != 0 ? 1 : 0;
    }
    std::printf("%u questions, %u touching; the uncertified test differs at %u\n", count, touching,
                naive_differs);
    EXPECT_TRUE(touching > 0 || count < 50);
    EXPECT_LT(touching, count);
    EXPECT_LE(naive_differs, count / 100 + 1);  // it proves nothing, and is seldom wrong
}

}  // namespace
}  // namespace axg::paper
