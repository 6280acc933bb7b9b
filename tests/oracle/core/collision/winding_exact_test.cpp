// SPDX-License-Identifier: Apache-2.0
// Winding numbers at points placed to hurt: on a facet's plane or a corner's level, a few steps of
// the point grid from facets, edges and corners, judged in exact arithmetic with rays of their own.
// Then containment of posed bodies near contact, judged by every corner's exact place. Scale:
// AXG_COUNT.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/exact_sign.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/winding.hpp"
#include "core/mesh/mesh_check.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

#ifdef AXG_EXACT_SLOW
constexpr std::uint32_t kSlower = 20;
#else
constexpr std::uint32_t kSlower = 1;
#endif

std::uint32_t count_of(std::uint32_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual / kSlower
                           : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

ExactPoint minus(const ExactPoint& a, const ExactPoint& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Sign of the volume of the tetrahedron a, b, c, d.
int volume_sign(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c,
                const ExactPoint& d) {
    const ExactPoint u = minus(a, d), v = minus(b, d), w = minus(c, d);
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
            u[2] * (v[0] * w[1] - v[1] * w[0]))
        .sign();
}

ExactPoint exact_point(const Vec3d& p) {
    return {Dyadic(p.x), Dyadic(p.y), Dyadic(p.z)};
}

/// Signed passages of the way from p to q through the triangle; empty where it grazes an edge, or
/// an end is in its plane and the line meets it.
std::optional<int> passages(const ExactTriangle& t, const ExactPoint& p, const ExactPoint& q) {
    const int from = volume_sign(t[0], t[1], t[2], p), to = volume_sign(t[0], t[1], t[2], q);
    int side[3];
    for (std::size_t i = 0; i < 3; ++i) {
        side[i] = volume_sign(t[i], t[(i + 1) % 3], p, q);
    }
    const auto [least, most] = std::minmax({side[0], side[1], side[2]});
    if (least * most < 0 || (from == to && from != 0)) {
        return 0;
    }
    if (from == 0 || to == 0 || side[0] == 0 || side[1] == 0 || side[2] == 0) {
        return std::nullopt;
    }
    return from > 0 ? 1 : -1;  // from below, seen from outside: out of the body
}

/// How often the facets wind around p, by a way to a far point drawn anew until it grazes nothing.
int exact_turns(const std::vector<ExactTriangle>& facets, const ExactPoint& p, Draw& draw) {
    for (int i = 0; i < 100; ++i) {
        const Pose far = random_rotation(draw);
        const ExactPoint q = exact_point({1e6 * far.r[0][0], 1e6 * far.r[0][1], 1e6 * far.r[0][2]});
        int sum = 0;
        bool is_clean = true;
        for (const ExactTriangle& t : facets) {
            const std::optional<int> one = passages(t, p, q);
            is_clean = is_clean && one.has_value();
            sum += one.value_or(0);
        }
        if (is_clean) {
            return sum;
        }
    }
    ADD_FAILURE() << "no clean way out";
    return 0;
}

std::vector<ExactTriangle> exact_facets(const Triangles& triangles) {
    std::vector<ExactTriangle> out;
    for (const Triangle& t : triangles) {
        out.push_back(exact(t));
    }
    return out;
}

bool is_on(const std::vector<ExactTriangle>& facets, const ExactPoint& p) {
    return std::any_of(facets.begin(), facets.end(), [&p](const ExactTriangle& t) {
        return squared_distance({p, p, p}, t).is_zero();
    });
}

/// Corners moved by a few last bits, and some coordinates to next to nothing.
void disturb(Triangles& triangles, float by) {
    const auto moved = [by](const Vec3f& p) {
        // The same corner moves the same way wherever it occurs.
        Draw own(__builtin_bit_cast(std::uint32_t, p.x) * 0x9e3779b97f4a7c15U ^
                 __builtin_bit_cast(std::uint32_t, p.y) * 0xbf58476d1ce4e5b9U ^
                 __builtin_bit_cast(std::uint32_t, p.z));
        const auto one = [&own, by](float x) {
            const float step = static_cast<float>(own.between(-1, 1)) * by;
            return x == 0 ? step * 0x1p-60F : x + step * x;
        };
        return Vec3f{one(p.x), one(p.y), one(p.z)};
    };
    for (Triangle& t : triangles) {
        t = {moved(t.a), moved(t.b), moved(t.c)};
    }
}

Triangles random_body(Draw& draw) {
    Triangles out;
    switch (draw.below(4)) {
        case 0:
            out = together(box({-8, -8, -8}, {8, 8, 8}), turned_over(box({-4, -2, -6}, {4, 2, 6})));
            break;
        case 1:
            out = ball(1 + draw.below(3), 20, 4);
            break;
        case 2:
            out = ring(3 + draw.below(5), 3 + draw.below(3), 20, 8);
            break;
        default:
            out = ball(2, 20);
            break;
    }
    switch (draw.below(5)) {
        case 0:
            disturb(out, 0x1p-20F);
            break;
        case 1:
            out = moved(out, {static_cast<float>(draw.between(-9e4, 9e4)), 0, 77777});
            break;
        case 2:
            for (Triangle& t : out) {  // so large that double cannot tell one step of the grid
                t = {2500.0F * t.a, 2500.0F * t.b, 2500.0F * t.c};
            }
            disturb(out, 0x1p-10F);
            break;
        case 3:
            for (Triangle& t : out) {  // a thin plate: slivers beside one another
                t = {{t.a.x, t.a.y, t.a.z * 0x1p-16F},
                     {t.b.x, t.b.y, t.b.z * 0x1p-16F},
                     {t.c.x, t.c.y, t.c.z * 0x1p-16F}};
            }
            break;
        default:
            break;
    }
    return out;
}

/// Coordinates of corners, mixed, or a point of a facet; then a few steps of the grid away.
Vec3d hurting_point(Draw& draw, const Triangles& triangles) {
    const auto any = [&] {
        return triangles[draw.below(static_cast<std::uint32_t>(triangles.size()))];
    };
    Vec3d p{};
    if (draw.below(2) == 0) {
        p = {double(any().a.x), double(any().b.y), double(any().c.z)};
    } else {
        const Triangle t = any();
        const double u = draw.below(5) / 4.0, v = (1 - u) * draw.below(5) / 4.0;
        p = u * widen(t.a) + v * widen(t.b) + (1 - u - v) * widen(t.c);
    }
    p = on_point_grid(p);
    const double scale = kPointGridMm * (draw.below(2) == 0 ? 1 : std::exp2(draw.below(34)));
    const auto step = [&] { return scale * (static_cast<double>(draw.below(5)) - 2); };
    return {p.x + step(), p.y + step(), p.z + step()};
}

TEST(WindingExact, AgreesWithExactRaysOfAnyDirection) {
    Draw draw(printed_seed(21));
    const std::uint32_t bodies = count_of(100);
    std::uint32_t judged = 0, inside = 0, on = 0, exact_signs = 0;
    for (std::uint32_t i = 0; i < bodies; ++i) {
        const Triangles triangles = random_body(draw);
        if (!check_mesh(triangles).is_closed()) {
            continue;
        }
        const SolidBody body(triangles);
        const std::vector<ExactTriangle> facets = exact_facets(triangles);
        for (int j = 0; j < 25; ++j) {
            const Vec3d p = hurting_point(draw, triangles);
            if (is_on(facets, exact_point(p))) {
                ++on;
                continue;
            }
            RayWork work;
            const Winding out = body.wound(p, work);
            ASSERT_TRUE(out.is_known);
            const int wanted = exact_turns(facets, exact_point(p), draw);
            ASSERT_EQ(out.number, wanted) << "body " << i << ", point " << j;
            ++judged;
            inside += wanted != 0 ? 1 : 0;
            exact_signs += work.exact_signs;
        }
    }
    std::printf("%u points, %u inside, %u more on a facet, %u exact signs\n", judged, inside, on,
                exact_signs);
    EXPECT_GT(judged, bodies * 6);
    EXPECT_GT(inside, bodies / 2);
    EXPECT_GT(exact_signs, bodies);
}

Dyadic whole(const TwoTerms& t) {
    return Dyadic(t.high) + Dyadic(t.low);
}

/// The difference of a float and a point of the grid, both of any size that occurs.
TwoTerms random_entry(Draw& draw) {
    const auto corner = static_cast<float>(
        draw.between(-1, 1) * std::exp2(draw.between(draw.below(4) == 0 ? -149 : -20, 16)));
    const Vec3d p = on_point_grid({draw.between(-1, 1) * std::exp2(draw.between(-30, 16)), 0, 0});
    return two_sum(corner, draw.below(4) == 0 ? 0 : -p.x);
}

/// f times an entry, as a float less a grid point could be it; off by its own rounding.
TwoTerms multiple(const TwoTerms& of, double f) {
    const double x = f * of.high;
    return two_sum(x, f * of.low);
}

// Rows that are almost, or exactly, multiples and sums of one another: where double has no sign.
TEST(ExactSignTest, OfDeterminantsNextToZero) {
    Draw draw(printed_seed(23));
    constexpr double kFactors[] = {0.5, 1, -2, 1.0 / 3, 0.7, 1e-3};
    const auto factor = [&] { return kFactors[draw.below(6)]; };
    std::uint32_t summed = 0, zeros = 0, wrong_in_double = 0;
    const std::uint32_t count = count_of(50'000);
    for (std::uint32_t i = 0; i < count; ++i) {
        std::array<std::array<TwoTerms, 3>, 3> m;
        for (auto& row : m) {
            row = {random_entry(draw), random_entry(draw), random_entry(draw)};
        }
        const double f = factor(), g = factor();
        for (std::size_t k = 0; k < 3; ++k) {
            const TwoTerms x = multiple(m[0][k], f), y = multiple(m[1][k], g);
            m[2][k] = two_sum(x.high, y.high);
            if (draw.below(6) == 0) {
                m[1][k] = multiple(m[0][k], f);
            }
            if (draw.below(2) == 0) {  // as much as a low term may be
                m[2][k].low = 0x1p-54 * draw.between(-1, 1) * m[2][k].high;
            }
        }
        if (draw.below(4) == 0) {
            m[2] = {m[2][0], multiple(m[1][1], f), multiple(m[1][2], f)};
            m[2][2].low = 0x1p-54 * draw.between(-1, 1) * m[2][2].high;
        }
        const auto e = [&m](std::size_t r, std::size_t c) { return whole(m[r][c]); };
        const Dyadic minor = e(1, 1) * e(2, 2) - e(1, 2) * e(2, 1);
        const ExactSign turn = sign_of_turn({m[1][1], m[1][2]}, {m[2][1], m[2][2]});
        ASSERT_EQ(turn.sign, minor.sign()) << i;
        const ExactSign volume = sign_of_volume(m);
        const Dyadic exact = e(0, 0) * minor + e(1, 0) * (e(2, 1) * e(0, 2) - e(2, 2) * e(0, 1)) +
                             e(2, 0) * (e(0, 1) * e(1, 2) - e(0, 2) * e(1, 1));
        ASSERT_EQ(volume.sign, exact.sign()) << i;
        const double plain = m[1][1].high * m[2][2].high - m[1][2].high * m[2][1].high;
        wrong_in_double += plain != 0 && minor.sign() != (plain > 0 ? 1 : -1) ? 1 : 0;
        summed += (turn.is_summed ? 1 : 0) + (volume.is_summed ? 1 : 0);
        zeros += minor.sign() == 0 || exact.sign() == 0 ? 1 : 0;
    }
    std::printf("%u summed, %u zero, %u wrong in double\n", summed, zeros, wrong_in_double);
    EXPECT_GT(summed, count / 10);
    EXPECT_GT(zeros, count / 1000);
    EXPECT_GE(wrong_in_double, count / 5000) << "of the signs in the plane";
}

// A small body whose corner almost touches a large one, from inside or from outside.
TEST(ContainmentExact, AgreesWithTheExactPlaceOfEveryCorner) {
    Draw draw(printed_seed(22));
    const std::uint32_t scenes = count_of(120);
    std::uint32_t judged = 0, nested = 0;
    for (std::uint32_t i = 0; i < scenes; ++i) {
        Triangles small = ball(1, 2);
        const Triangles large = random_body(draw);
        if (!check_mesh(large).is_closed()) {
            continue;
        }
        ContainmentScene scene({{"small", small}, {"large", large}});
        const std::vector<ExactTriangle> small_facets = exact_facets(small);
        const std::vector<ExactTriangle> large_facets = exact_facets(large);
        for (int j = 0; j < 10; ++j) {
            Pose pose = random_rotation(draw);
            const Vec3d corner = rotate(pose, widen(small[draw.below(12)].a));
            const Vec3d to = hurting_point(draw, large);
            const double gap = std::exp2(-draw.between(1, 36));
            pose.t[0] = to.x - corner.x + gap * (draw.unit() - 0.5);
            pose.t[1] = to.y - corner.y + gap * (draw.unit() - 0.5);
            pose.t[2] = to.z - corner.z + gap * (draw.unit() - 0.5);
            const ContainmentResult result = scene.run(ContainmentScene::about(pose));
            if (result.status == QueryStatus::not_run) {
                continue;
            }
            ASSERT_EQ(result.status, QueryStatus::ok);
            std::vector<ExactTriangle> placed_small;
            for (const Triangle& t : small) {
                placed_small.push_back(placed(pose, t));
            }
            bool a_in_b = false, b_in_a = false;
            for (const ExactTriangle& t : placed_small) {
                a_in_b = a_in_b || exact_turns(large_facets, t[0], draw) != 0;
            }
            for (const ExactTriangle& t : large_facets) {
                b_in_a = b_in_a || exact_turns(placed_small, t[0], draw) != 0;
            }
            ASSERT_EQ(result.containment, a_in_b   ? Containment::a_in_b
                                          : b_in_a ? Containment::b_in_a
                                                   : Containment::none)
                << "scene " << i << ", pose " << j;
            ++judged;
            nested += a_in_b || b_in_a ? 1 : 0;
        }
    }
    std::printf("%u poses proven apart, %u nested\n", judged, nested);
    EXPECT_GT(judged, scenes);
    EXPECT_GT(nested, scenes / 16);
}

}  // namespace
}  // namespace axg::test
#else
TEST(WindingExact, NeedsGmp) {
    GTEST_SKIP() << "built without GMP";
}
#endif
