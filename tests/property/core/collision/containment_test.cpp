// SPDX-License-Identifier: Apache-2.0
// Winding numbers and containment against other ways to know them: counting boxes, and summing
// solid angles (van Oosterom and Strackee, 1983) at points that are not too near. Scale: AXG_COUNT.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/winding.hpp"
#include "core/mesh/mesh_check.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::Draw;
using test::SolidBody;
using test::Triangles;

#ifdef NDEBUG
constexpr std::uint32_t kSlower = 1;
#else
constexpr std::uint32_t kSlower = 8;  // unoptimised, and perhaps under sanitizers
#endif

std::uint32_t count_of(std::uint32_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual / kSlower
                           : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

/// Turns around p, as solid angles; near a whole number unless p is on the surface.
double turns_by_angles(const Triangles& triangles, const Vec3d& p) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const Vec3d a = widen(t.a) - p, b = widen(t.b) - p, c = widen(t.c) - p;
        const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)),
                     lc = std::sqrt(dot(c, c));
        const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        sum += 2 * std::atan2(dot(a, cross(b, c)), below);
    }
    return sum / (4 * 3.14159265358979323846);
}

/// Distance of p from a triangle, roughly from below: from its plane, or its corners' box.
double box_distance_mm(const Triangle& t, const Vec3d& p) {
    const auto gap = [](double a, double b, double c, double x) {
        return std::max({std::min({a, b, c}) - x, x - std::max({a, b, c}), 0.0});
    };
    const Vec3d a = widen(t.a), b = widen(t.b), c = widen(t.c);
    const Vec3d n = cross(b - a, c - a);
    const double plane = std::fabs(dot(n, p - a)) / std::sqrt(dot(n, n));
    return std::max(
        {gap(a.x, b.x, c.x, p.x), gap(a.y, b.y, c.y, p.y), gap(a.z, b.z, c.z, p.z), plane});
}

double away_mm(const Triangles& triangles, const Vec3d& p) {
    double least = HUGE_VAL;
    for (const Triangle& t : triangles) {
        least = std::min(least, box_distance_mm(t, p));
    }
    return least;
}

struct RandomBox {
    std::array<int, 3> low, high;
    int sign;

    /// 2: on its surface; else how often it winds around p, whose coordinates are halves.
    [[nodiscard]] int around(const std::array<int, 3>& p_halves) const {
        bool is_in = true, is_on = true;
        for (std::size_t k = 0; k < 3; ++k) {
            is_in = is_in && 2 * low[k] < p_halves[k] && p_halves[k] < 2 * high[k];
            is_on = is_on && 2 * low[k] <= p_halves[k] && p_halves[k] <= 2 * high[k];
        }
        return is_in ? sign : is_on ? 2 : 0;
    }
};

RandomBox random_box(Draw& draw) {
    RandomBox out{};
    for (std::size_t k = 0; k < 3; ++k) {
        out.low[k] = static_cast<int>(draw.below(15)) - 8;
        out.high[k] = out.low[k] + 1 + static_cast<int>(draw.below(9));
    }
    out.sign = draw.below(4) == 0 ? -1 : 1;
    return out;
}

// On whole and half coordinates almost every ray meets corners, runs along edges or lies in sides.
TEST(Winding, CountsTheBoxesAroundAPoint) {
    Draw draw(test::printed_seed(11));
    const std::uint32_t bodies = count_of(400);
    std::uint32_t judged = 0, inside = 0;
    for (std::uint32_t i = 0; i < bodies; ++i) {
        std::vector<RandomBox> boxes(1 + draw.below(12));
        Triangles triangles;
        for (RandomBox& one : boxes) {
            one = random_box(draw);
            const auto corner = [](const std::array<int, 3>& p) {
                return Vec3f{static_cast<float>(p[0]), static_cast<float>(p[1]),
                             static_cast<float>(p[2])};
            };
            const Triangles box = test::box(corner(one.low), corner(one.high));
            triangles = test::together(triangles, one.sign > 0 ? box : test::turned_over(box));
        }
        if (!check_mesh(triangles).is_closed()) {
            continue;  // two boxes share an edge: of four facets, which counts as open
        }
        const SolidBody body(triangles);
        for (int j = 0; j < 60; ++j) {
            std::array<int, 3> p{};
            for (int& x : p) {
                x = static_cast<int>(draw.below(37)) - 18;
            }
            int wanted = 0;
            bool is_on = false;
            for (const RandomBox& one : boxes) {
                const int turns = one.around(p);
                is_on = is_on || turns == 2;
                wanted += turns;
            }
            if (is_on) {
                continue;
            }
            ++judged;
            inside += wanted != 0 ? 1 : 0;
            ASSERT_EQ(body.at({p[0] / 2.0, p[1] / 2.0, p[2] / 2.0}), wanted)
                << "body " << i << ", point " << p[0] << ' ' << p[1] << ' ' << p[2] << " halves";
        }
    }
    EXPECT_GT(judged, bodies * 20);
    EXPECT_GT(inside, bodies);
}

Triangles random_round(Draw& draw) {
    const double size = draw.between(20, 60);
    switch (draw.below(4)) {
        case 0:
            return test::ball(1 + draw.below(10), size);
        case 1:
            return test::ball(2 + draw.below(8), size, 8);  // on a coarse grid: flat spots, slivers
        case 2:
            return test::ring(3 + draw.below(30), 3 + draw.below(12), size, size / 3);
        default:
            return test::together(test::ball(6, size),
                                  test::turned_over(test::ball(5, size * 0.6)));
    }
}

TEST(Winding, AgreesWithSolidAngles) {
    Draw draw(test::printed_seed(12));
    const std::uint32_t bodies = count_of(300);
    std::uint32_t judged = 0, inside = 0;
    for (std::uint32_t i = 0; i < bodies; ++i) {
        const Triangles triangles = random_round(draw);
        const bool on_grid = draw.below(2) == 0;
        const bool is_closed = check_mesh(triangles).is_closed();
        const SolidBody body(triangles);
        for (int j = 0; j < 30; ++j) {
            Vec3d p{draw.between(-70, 70), draw.between(-70, 70), draw.between(-70, 70)};
            if (on_grid) {
                p = {std::nearbyint(p.x / 4) * 4, std::nearbyint(p.y / 4) * 4,
                     std::nearbyint(p.z / 4) * 4};
            }
            p = on_point_grid(p);
            if (!is_closed || away_mm(triangles, p) < 0.01) {
                continue;
            }
            const double turns = turns_by_angles(triangles, p);
            ASSERT_NEAR(turns, std::nearbyint(turns), 1e-3);
            ++judged;
            inside += std::nearbyint(turns) != 0 ? 1 : 0;
            ASSERT_EQ(body.at(p), static_cast<int>(std::nearbyint(turns)))
                << "body " << i << ", point " << p.x << ' ' << p.y << ' ' << p.z;
        }
    }
    EXPECT_GT(judged, bodies * 10);
    EXPECT_GT(inside, bodies);
}

// The ray leaves by the nearest side, so a turned body is queried along another axis.
TEST(Winding, DoesNotDependOnWhichWayTheAxesPoint) {
    Draw draw(test::printed_seed(13));
    for (std::uint32_t i = 0; i < count_of(100); ++i) {
        const Triangles triangles = random_round(draw);
        const SolidBody bodies[] = {SolidBody(triangles),
                                    SolidBody(test::turned_axes(triangles, 1)),
                                    SolidBody(test::turned_axes(triangles, 2))};
        for (int j = 0; j < 30; ++j) {
            const Vec3f p{static_cast<float>(draw.below(129)) - 64,
                          static_cast<float>(draw.below(129)) - 64,
                          static_cast<float>(draw.below(129)) - 64};
            if (away_mm(triangles, widen(p)) == 0) {
                continue;
            }
            const int turns = bodies[0].at(widen(p));
            ASSERT_EQ(bodies[1].at(widen(test::turned_axes(p, 1))), turns);
            ASSERT_EQ(bodies[2].at(widen(test::turned_axes(p, 2))), turns);
        }
    }
}

/// Containment by angles alone: every part's corners, all of them, not too near the other body.
struct ByAngles {
    bool is_sure = true, a_in_b = false, b_in_a = false;
};

ByAngles judge_by_angles(const Triangles& a, const Triangles& b, const Pose& pose) {
    ByAngles out;
    const auto look = [&out](const Triangles& inner, const Triangles& outer, const Pose& to) {
        bool is_inside = false;
        for (const Triangle& t : inner) {
            const Vec3d p = apply(to, widen(t.a));
            out.is_sure = out.is_sure && away_mm(outer, p) > 0.01;
            is_inside = is_inside || std::fabs(turns_by_angles(outer, p)) > 0.5;
        }
        return is_inside;
    };
    out.a_in_b = look(a, b, pose);
    out.b_in_a = look(b, a, inverse(pose));
    return out;
}

TEST(Containment, AgreesWithSolidAnglesOfEveryCorner) {
    Draw draw(test::printed_seed(14));
    std::uint32_t kinds[3] = {0, 0, 0};
    const std::uint32_t scenes = count_of(48);
    for (std::uint32_t i = 0; i < scenes; ++i) {
        Triangles small = random_round(draw);
        const double shrink = draw.between(0.03, 0.5);
        for (Triangle& t : small) {
            for (Vec3f* p : {&t.a, &t.b, &t.c}) {
                *p = static_cast<float>(shrink) * *p;
            }
        }
        const Triangles large = random_round(draw);
        if (!check_mesh(small).is_closed() || !check_mesh(large).is_closed()) {
            continue;
        }
        test::ContainmentScene scene({{"small", small}, {"large", large}});
        for (int j = 0; j < 8; ++j) {
            Pose pose = test::random_rotation(draw);
            for (double& t : pose.t) {
                t = draw.between(-50, 50);
            }
            const bool is_swapped = draw.below(2) == 0;
            Query query = test::ContainmentScene::about(is_swapped ? inverse(pose) : pose,
                                                        is_swapped ? 1 : 0, is_swapped ? 0 : 1);
            const ContainmentResult result = scene.run(query);
            if (result.status == QueryStatus::not_run) {
                continue;  // they touch
            }
            ASSERT_EQ(result.status, QueryStatus::ok);
            ByAngles wanted = judge_by_angles(small, large, pose);
            if (!wanted.is_sure) {
                continue;
            }
            if (is_swapped) {
                std::swap(wanted.a_in_b, wanted.b_in_a);
            }
            const Containment expected = wanted.a_in_b   ? Containment::a_in_b
                                         : wanted.b_in_a ? Containment::b_in_a
                                                         : Containment::none;
            ASSERT_EQ(result.containment, expected) << "scene " << i << ", pose " << j;
            ++kinds[static_cast<int>(result.containment) - 1];
        }
    }
    if (scenes >= 48) {  // a few scenes may well have none of a kind
        EXPECT_GT(std::min(kinds[0], kinds[1] + kinds[2]), scenes / 4);
        EXPECT_GT(std::min(kinds[1], kinds[2]), scenes / 16);
    }
}

}  // namespace
}  // namespace axg
