// SPDX-License-Identifier: Apache-2.0
// What must not matter does not matter. The same two triangles in other words: swapped, their
// vertices in another order, mirrored, turned by quarter turns, scaled by powers of two.
//
// Equal bits, already of the float test: mirroring (every operation rounds symmetrically) and
// scaling while nothing leaves the range (the test is homogeneous but for the constants 2^-100 and
// 2^-90). Not of the float test: swap, order of vertices, quarter turns; they change which edges
// make a normal, the order of a sum, and which product of a difference is rounded first. There a
// pair may be told apart in one form and left undecided in another, never told apart where it
// meets. After the recheck in double what is left of that is a band of some 1e-15 of the
// coordinates: outside it the verdict is the truth in every form, so it is the same in all.
// AXG_COUNT: pairs a category.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

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

std::uint64_t count_a_category(std::uint64_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
#if defined(AXG_EXACT_SLOW) || !defined(NDEBUG)
    usual = std::max<std::uint64_t>(1, usual / 50);
#endif
    return text == nullptr ? usual : std::strtoull(text, nullptr, 10);
}

/// Less a's first vertex: which one that is depends on the form, as in the engine.
template <class T>
sat::TrianglePair<T> local_pair(const Pair<T>& pair) {
    sat::V3<T> a[3], b[3];
    const Vec3<T> o = pair.a[0];
    for (int i = 0; i < 3; ++i) {
        a[i] = {pair.a[i].x - o.x, pair.a[i].y - o.y, pair.a[i].z - o.z};
        b[i] = {pair.b[i].x - o.x, pair.b[i].y - o.y, pair.b[i].z - o.z};
    }
    return sat::scaled_pair(a, b, sizeof(T) == sizeof(float) ? static_cast<T>(0x1p-90) : T{0});
}

bool apart_in_float(const Pair<float>& pair) {
    const sat::TrianglePair<float> p = local_pair(pair);
    return sat::apart<false>(p.a, p.b, {0x1p-90F, 0.0F, 0.0F});
}

bool apart_after_recheck(const Pair<float>& pair) {
    return apart_in_float(pair) ||
           sat::apart_in_double<false>(local_pair(lab::in_double(pair)), 0.0);
}

/// Both triangles, each coordinate multiplied: exact for powers of two of either sign.
Pair<float> multiplied(Pair<float> p, Vec3f by) {
    for (int i = 0; i < 3; ++i) {
        for (Vec3f* const v : {&p.a[i], &p.b[i]}) {
            *v = {v->x * by.x, v->y * by.y, v->z * by.z};
        }
    }
    return p;
}

/// x, y, z become the coordinates of these numbers.
Pair<float> reordered(Pair<float> p, const int (&axes)[3]) {
    for (int i = 0; i < 3; ++i) {
        for (Vec3f* const v : {&p.a[i], &p.b[i]}) {
            const float c[3] = {v->x, v->y, v->z};
            *v = {c[axes[0]], c[axes[1]], c[axes[2]]};
        }
    }
    return p;
}

constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

Pair<float> with_vertices(const Pair<float>& p, const int (&a)[3], const int (&b)[3]) {
    return {{p.a[a[0]], p.a[a[1]], p.a[a[2]]}, {p.b[b[0]], p.b[b[1]], p.b[b[2]]}};
}

std::string named(std::size_t category, std::uint64_t index, const Pair<float>& pair) {
    return std::string(": ") + lab::pair_category_name(category) + ", index " +
           std::to_string(index) + "\n" + in_hexadecimal(pair);
}

bool is_mid_sized(const Pair<float>& p) {
    for (int i = 0; i < 3; ++i) {
        for (const Vec3f& v : {p.a[i], p.b[i]}) {
            for (const float x : {v.x, v.y, v.z}) {
                if (x != 0 && (std::fabs(x) < 0x1p-20F || std::fabs(x) > 0x1p18F)) {
                    return false;
                }
            }
        }
    }
    return true;
}

template <class Body>
void every_pair(std::uint64_t seed, std::uint64_t count, Body body) {
    for (std::size_t c = 0; c < lab::pair_category_count(); ++c) {
        for (std::uint64_t i = 0; i < count && !testing::Test::HasFailure(); ++i) {
            body(c, i, lab::make_pair_case<float>(c, seed, i));
        }
    }
}

TEST(Metamorphic, MirroringKeepsEveryBit) {
    const std::uint64_t seed = printed_seed(20261201);
    std::uint64_t undecided = 0, pairs = 0;
    every_pair(seed, count_a_category(400), [&](std::size_t c, std::uint64_t i, const auto& pair) {
        const bool in_float = apart_in_float(pair), after = apart_after_recheck(pair);
        for (unsigned signs = 1; signs < 8; ++signs) {
            const Pair<float> mirrored = multiplied(
                pair, {(signs & 1U) != 0 ? -1.0F : 1.0F, (signs & 2U) != 0 ? -1.0F : 1.0F,
                       (signs & 4U) != 0 ? -1.0F : 1.0F});
            EXPECT_EQ(apart_in_float(mirrored), in_float) << signs << named(c, i, pair);
            EXPECT_EQ(apart_after_recheck(mirrored), after) << signs << named(c, i, pair);
        }
        undecided += in_float ? 0 : 1;
        ++pairs;
    });
    EXPECT_GT(undecided, pairs / 5);
    EXPECT_GT(pairs - undecided, pairs / 5);
}

TEST(Metamorphic, PowersOfTwoKeepEveryBit) {
    const std::uint64_t seed = printed_seed(20261202);
    std::uint64_t pairs = 0;
    every_pair(seed, count_a_category(400), [&](std::size_t c, std::uint64_t i, const auto& pair) {
        if (!is_mid_sized(pair)) {
            return;
        }
        const bool in_float = apart_in_float(pair), after = apart_after_recheck(pair);
        for (const float by : {0x1p-9F, 0.5F, 2.0F, 0x1p2F}) {
            const Pair<float> scaled = multiplied(pair, {by, by, by});
            EXPECT_EQ(apart_in_float(scaled), in_float) << by << named(c, i, pair);
            EXPECT_EQ(apart_after_recheck(scaled), after) << by << named(c, i, pair);
        }
        ++pairs;
    });
    EXPECT_GT(pairs, 20 * count_a_category(400)) << "too few pairs of middle size";
}

/// The forms whose float verdict may differ: counts, and what must hold of each.
struct Forms {
    std::uint64_t forms = 0, float_flips = 0, flips = 0;
    double widest_flip = 0;  // distance as a share of the largest coordinate

    void compare(const Pair<float>& form, bool in_float, bool after, bool meets, double distance_mm,
                 const std::string& name) {
        ++forms;
        const bool now_float = apart_in_float(form), now = apart_after_recheck(form);
        EXPECT_FALSE(meets && now) << "a contradiction" << name;
        float_flips += now_float != in_float ? 1 : 0;
        if (now != after) {
            ++flips;
            double most = 0;
            for (int i = 0; i < 3; ++i) {
                for (const Vec3f& v : {form.a[i], form.b[i]}) {
                    most = std::max(most, std::fabs(double(v.x)));
                    most = std::max(most, std::fabs(double(v.y)));
                    most = std::max(most, std::fabs(double(v.z)));
                }
            }
            widest_flip = std::max(widest_flip, distance_mm / most);
        }
    }
    void print(const char* what) const {
        std::printf(
            "%s: %llu forms; float verdict another in %llu, after the recheck in %llu; "
            "widest of these %.3g of the coordinates\n",
            what, static_cast<unsigned long long>(forms),
            static_cast<unsigned long long>(float_flips), static_cast<unsigned long long>(flips),
            widest_flip);
    }
};

// Distances that only double could tell, and does in one form and not in another: sqrt(2^-53) where
// neither triangle has an area (docs/theory/accuracy.md, section 6).
constexpr double kBand = 0x1p-26;

TEST(Metamorphic, SwapAndOrderOfVerticesContradictNothing) {
    const std::uint64_t seed = printed_seed(20261203);
    Forms all;
    every_pair(seed, count_a_category(60), [&](std::size_t c, std::uint64_t i, const auto& pair) {
        const bool in_float = apart_in_float(pair), after = apart_after_recheck(pair);
        const bool meets = lab::intersect(lab::in_double(pair));
        const double distance_mm = lab::distance_mm(lab::squared_distance(lab::in_double(pair)));
        const std::string name = named(c, i, pair);
        for (const auto& a : kOrders) {
            for (const auto& b : kOrders) {
                Pair<float> form = with_vertices(pair, a, b);
                all.compare(form, in_float, after, meets, distance_mm, name);
                std::swap(form.a, form.b);
                all.compare(form, in_float, after, meets, distance_mm, name);
            }
        }
    });
    all.print("swap and order of vertices");
    EXPECT_LE(all.widest_flip, kBand);
    if (count_a_category(60) >= 20) {
        EXPECT_GT(all.float_flips, 0U) << "these pairs are too easy to tell anything";
    }
}

TEST(Metamorphic, QuarterTurnsContradictNothing) {
    const std::uint64_t seed = printed_seed(20261204);
    Forms all;
    every_pair(seed, count_a_category(80), [&](std::size_t c, std::uint64_t i, const auto& pair) {
        const bool in_float = apart_in_float(pair), after = apart_after_recheck(pair);
        const bool meets = lab::intersect(lab::in_double(pair));
        const double distance_mm = lab::distance_mm(lab::squared_distance(lab::in_double(pair)));
        for (const auto& order : kOrders) {
            for (unsigned signs = 0; signs < 8; ++signs) {
                const Pair<float> form =
                    multiplied(reordered(pair, order),
                               {(signs & 1U) != 0 ? -1.0F : 1.0F, (signs & 2U) != 0 ? -1.0F : 1.0F,
                                (signs & 4U) != 0 ? -1.0F : 1.0F});
                all.compare(form, in_float, after, meets, distance_mm, named(c, i, pair));
            }
        }
    });
    all.print("quarter turns and mirrors");
    EXPECT_LE(all.widest_flip, kBand);
    if (count_a_category(80) >= 20) {
        EXPECT_GT(all.float_flips, 0U) << "these pairs are too easy to tell anything";
    }
}

// Two triangles that approach: once they count as near, they stay near until they truly part.
TEST(Metamorphic, ClosingIsMonotone) {
    const std::uint64_t seed = printed_seed(20261205);
    std::uint64_t closings = 0, contacts = 0, parted = 0;
    double widest = 0;
    for (std::size_t c = 0; c < lab::pair_category_count(); ++c) {
        for (std::uint64_t i = 0; i < count_a_category(12) && !HasFailure(); ++i) {
            const Pair<float> from = lab::make_pair_case<float>(c, seed, i);
            const Vec3f step = 0x1p-10F * (from.a[static_cast<int>(i % 3)] - from.b[0]);
            Pair<float> now = from;
            for (Vec3f& v : now.b) {
                v = v - 20.0F * step;
            }
            bool was_near = false;
            mpq_class before = 0;
            for (unsigned k = 0; k < 40; ++k) {
                for (Vec3f& v : now.b) {
                    v = v + step;  // rounds: the exact distance is that of what was rounded
                }
                const mpq_class square = lab::squared_distance(lab::in_double(now));
                const bool near = !apart_after_recheck(now);
                if (was_near && square <= before && !near) {
                    ++parted;
                    widest = std::max(widest, lab::distance_mm(square));
                }
                EXPECT_TRUE(near || square != 0) << named(c, i, now);
                contacts += near && !was_near ? 1 : 0;
                was_near = near;
                before = square;
            }
            ++closings;
        }
    }
    std::printf("%llu closings, %llu contacts; told apart again while closing: %llu\n",
                static_cast<unsigned long long>(closings),
                static_cast<unsigned long long>(contacts), static_cast<unsigned long long>(parted));
    EXPECT_EQ(parted, 0U) << "at most " << widest << " mm apart";
    EXPECT_GT(contacts, closings / 4);
}

}  // namespace
}  // namespace axg::test
#else
TEST(Metamorphic, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
