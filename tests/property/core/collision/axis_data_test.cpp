// SPDX-License-Identifier: Apache-2.0
// Axis data that are worked out once a triangle, and axis loops that are left as loops, give the
// verdicts of the test that works everything out for the pair at hand: bit for bit, with and
// without a margin. AXG_COUNT: pairs of each kind; AXG_SEED: which.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "core/collision/lanes_rolled.hpp"
#include "core/collision/pair_test.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using lanes::RolledFloat;
using Corner = sat::V3<float>;

struct Outcome {
    bool apart;
    float edges_square;
};

template <class V>
struct Local {
    sat::V3<V> a[3], b[3];
};

Local<float> local(const TriangleCase& c) {
    Local<float> out;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto less = [&c](const auto& v) {
            return Corner{static_cast<float>(v[0] - c.a[0][0]),
                          static_cast<float>(v[1] - c.a[0][1]),
                          static_cast<float>(v[2] - c.a[0][2])};
        };
        out.a[i] = less(c.a[i]);
        out.b[i] = less(c.b[i]);
    }
    return out;
}

template <bool kMargin, class V>
Outcome computed(const Local<float>& p, const sat::PairLimits<float>& x) {
    Local<V> q;
    for (int i = 0; i < 3; ++i) {
        q.a[i] = {V{p.a[i].x}, V{p.a[i].y}, V{p.a[i].z}};
        q.b[i] = {V{p.b[i].x}, V{p.b[i].y}, V{p.b[i].z}};
    }
    V square{-1};
    const bool apart = sat::apart<kMargin>(
        q.a, q.b, sat::PairLimits<V>{V{x.d}, V{x.margin}, V{x.r_square}}, &square);
    return {apart, __builtin_bit_cast(float, square)};
}

template <bool kMargin>
Outcome stored(const Local<float>& p, const sat::PairLimits<float>& x) {
    const sat::StoredAxes<float> s{sat::axes_of_triangle(p.a), sat::axes_of_triangle(p.b)};
    const sat::EdgePair<float> edges{
        {s.a.edge[0], s.a.edge[1]}, {s.b.edge[0], s.b.edge[1]}, sat::sub(p.b[0], p.a[0])};
    float square = -1;
    const bool apart = sat::separated_edges<kMargin, true>(edges, p.a[0], s, x.d, x.r_square) ||
                       sat::apart_by_itself<kMargin>(false, p.a, p.b, x, &square);
    return {apart, square};
}

template <bool kMargin>
void compare(const CaseKind& kind, const Local<float>& p, const sat::PairLimits<float>& x,
             std::uint64_t& apart) {
    const Outcome wanted = computed<kMargin, float>(p, x);
    for (const Outcome& found : {computed<kMargin, RolledFloat>(p, x), stored<kMargin>(p, x)}) {
        ASSERT_EQ(wanted.apart, found.apart) << kind.name;
        ASSERT_EQ(__builtin_bit_cast(std::uint32_t, wanted.edges_square),
                  __builtin_bit_cast(std::uint32_t, found.edges_square))
            << kind.name;
    }
    apart += wanted.apart ? 1 : 0;
}

TEST(AxisData, StoredAndRolledGiveTheBitsOfTheComputed) {
    std::mt19937_64 random(printed_seed(241));
    const char* const text = std::getenv("AXG_COUNT");
    const unsigned count =
        text == nullptr ? 2000 : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
    std::uint64_t apart = 0, all = 0;
    for (const CaseKind& kind : kCaseKinds) {
        for (unsigned i = 0; i < count; ++i) {
            const Local<float> p = local(make_case(random, kind, -20));
            const auto r = static_cast<float>(between(random, 0.001, 2.0));
            const sat::PairLimits<float> x{0x1p-20F, r * (1 + 0x1p-20F), r * r * (1 + 0x1p-17F)};
            ASSERT_NO_FATAL_FAILURE(compare<false>(kind, p, x, apart));
            ASSERT_NO_FATAL_FAILURE(compare<true>(kind, p, x, apart));
            all += 2;
        }
    }
    EXPECT_GT(apart, all / 20) << "both verdicts are met";
    EXPECT_LT(apart, all - all / 20);
}

}  // namespace
}  // namespace axg::test
