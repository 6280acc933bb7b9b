// SPDX-License-Identifier: Apache-2.0
// An adversary against the certified test: climbs from generated pairs, a few representable values
// at a time. First towards a false claim: triangles that truly meet, and the largest computed gap
// as a share of the bound that it would have to exceed. Then towards a wide band: triangles that
// are truly apart, undecided, and as far apart as can be. AXG_COUNT: starts; AXG_SEED: which.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/collision/double_test.hpp"
#include "core/collision/pair_test.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "tests/support/pair_text.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

using lab::Draw;
using lab::Pair;

unsigned starts() {
    const char* const text = std::getenv("AXG_COUNT");
#if defined(AXG_EXACT_SLOW) || !defined(NDEBUG)
    constexpr unsigned kUsual = 2;
#else
    constexpr unsigned kUsual = 24;
#endif
    return text == nullptr ? kUsual : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}
constexpr unsigned kStepsAStart = 20000, kDrawsAStart = 200;
constexpr unsigned kStartsThatTell = 24;  // with fewer, luck decides how near a bound they come

struct LocalPair {
    sat::V3<float> a[3], b[3];
};

/// Less a's first vertex.
LocalPair local_vertices(const Pair<float>& p) {
    LocalPair out;
    const Vec3f o = p.a[0];
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {p.a[i].x - o.x, p.a[i].y - o.y, p.a[i].z - o.z};
        out.b[i] = {p.b[i].x - o.x, p.b[i].y - o.y, p.b[i].z - o.z};
    }
    return out;
}

constexpr float kLeastD = 0x1p-90F;

/// Which bound is attacked.
enum class Bound { one_axis, normals, crosses, in_plane };
constexpr const char* kBoundNames[] = {"each axis by itself", "shared, normals", "shared, crosses",
                                       "shared, in the plane"};

double largest_share(const sat::AxisGap<float>& g) {
    return double(g.gap) / double(g.bound);
}

/// Largest gap that is computed, as a share of the bound.
double share(const Pair<float>& pair, Bound bound) {
    const LocalPair p = local_vertices(pair);
    if (bound == Bound::one_axis) {
        const auto scaled = sat::scaled_pair(p.a, p.b, kLeastD);
        const sat::PairAxes<float> x = sat::axes_of(scaled);
        double most = std::max(largest_share(sat::axis_gap(scaled, x.na)),
                               largest_share(sat::axis_gap(scaled, x.nb)));
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const auto cross = sat::cross3(x.ea[i], x.eb[j]);
                most = std::max(most, largest_share(sat::axis_gap(scaled, cross)));
            }
            const auto in_a = sat::cross3(x.ea[i], x.na), in_b = sat::cross3(x.eb[i], x.nb);
            most = std::max(most, largest_share(sat::axis_gap(scaled, in_a)));
            most = std::max(most, largest_share(sat::axis_gap(scaled, in_b)));
        }
        return most;
    }
    const auto edges = sat::edges_of(p.a, p.b);
    const auto bounds = sat::shared_bounds(edges, p.a[0], kLeastD);
    const auto gaps = sat::gaps_of(edges, sat::normal_products(edges), sat::products_of(edges));
    if (bound == Bound::normals) {
        return std::max(double(gaps.normal_a) / double(bounds.normal_a),
                        double(gaps.normal_b) / double(bounds.normal_b));
    }
    double cross = -HUGE_VAL, plane = -HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            cross = std::max(cross, double(gaps.twice_cross[i][j]));
        }
        plane = std::max(plane, double(gaps.in_plane_a[i]) / double(bounds.in_plane_a));
        plane = std::max(plane, double(gaps.in_plane_b[i]) / double(bounds.in_plane_b));
    }
    return bound == Bound::crosses ? cross / double(bounds.twice_cross) : plane;
}

float* coordinate_of(Pair<float>& p, std::uint32_t i) {
    Vec3f& v = i < 9 ? p.a[i / 3] : p.b[i / 3 - 3];
    return i % 3 == 0 ? &v.x : i % 3 == 1 ? &v.y : &v.z;
}

/// One to three coordinates moved, by one to a few thousand representable values, mostly few.
Pair<float> stepped(Draw& draw, Pair<float> p) {
    for (std::uint32_t n = 1 + draw.below(3); n > 0; --n) {
        float* const x = coordinate_of(p, draw.below(18));
        const double step = std::ldexp(1.0, -24 + static_cast<int>(draw.below(1 + draw.below(14))));
        const float moved = *x + static_cast<float>(draw.sign() * step) * *x;
        *x = moved != *x ? moved : std::nextafter(*x, static_cast<float>(draw.sign() * HUGE_VAL));
    }
    return p;
}

bool is_within(const Pair<float>& p) {
    double most = 0;
    for (int i = 0; i < 3; ++i) {
        for (const Vec3f& v : {p.a[i], p.b[i]}) {
            most = std::max(
                {most, std::fabs(double(v.x)), std::fabs(double(v.y)), std::fabs(double(v.z))});
        }
    }
    return most <= 1e5;
}

/// Climbs `value` among pairs that `is_allowed` accepts; the best of some draws is the start.
template <class Value, class Allowed>
std::pair<double, Pair<float>> climb(Draw& draw, std::uint64_t seed, unsigned start, Value value,
                                     Allowed is_allowed) {
    Pair<float> best{};
    double most = -HUGE_VAL;
    const auto categories = static_cast<std::uint32_t>(lab::pair_category_count());
    for (unsigned i = 0; i < kDrawsAStart; ++i) {
        const std::size_t category = draw.below(categories);
        const auto p = lab::make_pair_case<float>(category, seed, start * kDrawsAStart + i);
        const double found = value(p);
        if (found > most && is_allowed(p)) {
            most = found;
            best = p;
        }
    }
    for (unsigned i = 0; i < kStepsAStart && most > -HUGE_VAL; ++i) {
        const Pair<float> p = stepped(draw, best);
        const double found = value(p);
        if (found >= most && is_within(p) && is_allowed(p)) {
            most = found;
            best = p;
        }
    }
    return {most, best};
}

TEST(Adversary, NoGapOfTrianglesThatMeetReachesItsBound) {
    const std::uint64_t seed = printed_seed(20261129);
    for (const Bound bound : {Bound::one_axis, Bound::normals, Bound::crosses, Bound::in_plane}) {
        Draw draw(seed);
        double most = -HUGE_VAL;
        Pair<float> worst{};
        for (unsigned start = 0; start < starts(); ++start) {
            const auto [found, pair] = climb(
                draw, seed, start, [bound](const Pair<float>& p) { return share(p, bound); },
                [](const Pair<float>& p) { return lab::intersect(lab::in_double(p)); });
            if (found > most) {
                most = found;
                worst = pair;
            }
        }
        const char* const name = kBoundNames[static_cast<int>(bound)];
        std::printf("%-22s a gap of %.3f of the bound, of triangles that meet:\n  %s\n", name, most,
                    in_hexadecimal(worst).c_str());
        EXPECT_LE(most, 1.0) << name << ": a false claim";
        if (starts() >= kStartsThatTell) {
            EXPECT_GE(most, bound == Bound::one_axis ? 0.1 : 0.01)
                << name << ": this adversary is too weak to tell anything";
        }
    }
}

constexpr double kLeastUnitMm = 1e-12;  // below, the constant 2^-100 of the bound takes over

/// Distance of triangles that are apart, in units of 9u (Mx + My + Mz); below 0: told apart, or so
/// thin that only double is asked to be sharp.
double undecided_width(const Pair<float>& pair) {
    const LocalPair p = local_vertices(pair);
    const auto scaled = sat::scaled_pair(p.a, p.b, kLeastD);
    const double unit_mm = double(scaled.scale.x) + double(scaled.scale.y) + double(scaled.scale.z);
    const sat::V3<float> direction = sat::closest_direction(scaled, sat::axes_of(scaled)).direction;
    if (unit_mm < kLeastUnitMm || sat::apart<false>(p.a, p.b, {kLeastD, 0.0F, 0.0F}) ||
        sat::separates<false>(scaled, direction, 0.0F)) {
        return -1;
    }
    sat::V3<double> a[3], b[3];
    for (int i = 0; i < 3; ++i) {
        const auto wide = [&pair](const Vec3f& v) {
            const Vec3d w = widen(v) - widen(pair.a[0]);
            return sat::V3<double>{w.x, w.y, w.z};
        };
        a[i] = wide(pair.a[i]);
        b[i] = wide(pair.b[i]);
    }
    const auto in_double = sat::scaled_pair(a, b, 0.0);
    const sat::PairAxes<double> x = sat::axes_of(in_double);
    if (sat::thin(x.na, x.ea[0], x.ea[1]) || sat::thin(x.nb, x.eb[0], x.eb[1])) {
        return -1;
    }
    return std::sqrt(sat::closest_direction(in_double, x).square) / unit_mm;
}

TEST(Adversary, WhatFloatLeavesUndecidedIsNarrow) {
    const std::uint64_t seed = printed_seed(20261130);
    Draw draw(seed);
    double most = -1;
    Pair<float> worst{};
    for (unsigned start = 0; start < 4 * starts(); ++start) {
        const auto [found, pair] =
            climb(draw, seed, start, &undecided_width,
                  [](const Pair<float>& p) { return !lab::intersect(lab::in_double(p)); });
        if (found > most) {
            most = found;
            worst = pair;
        }
    }
    const double distance_mm = lab::distance_mm(lab::squared_distance(lab::in_double(worst)));
    std::printf("widest undecided: %.3f of 9u (Mx + My + Mz), %.3g um:\n  %s\n", most,
                1e3 * distance_mm, in_hexadecimal(worst).c_str());
    // A gap that passes is the bound and its own error, less than twice the bound; along the worst
    // direction the bound is one unit.
    EXPECT_LE(most, 2.0);
    EXPECT_GT(most, 0.5) << "this adversary is too weak to tell anything";
}

}  // namespace
}  // namespace axg::test
#else
TEST(Adversary, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
