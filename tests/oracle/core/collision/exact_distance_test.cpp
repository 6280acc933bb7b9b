// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// The judge judged: squared distances without rounding, against distances known by hand and against
// cases made elsewhere, whose answers come from two other exact methods.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/support/exact_distance.hpp"
#include "tests/support/tritri_files.hpp"

namespace axg::test {
namespace {

using Plain = PlainTriangle<double>;
using Pair = std::array<Plain, 2>;

double squared(const Plain& a, const Plain& b) {
    const ExactSquare both[] = {squared_distance(exact(a), exact(b)),
                                squared_distance(exact(b), exact(a))};
    EXPECT_FALSE(both[0].less_than(both[1]) || both[1].less_than(both[0]))
        << "a, b and b, a differ";
    return both[0].above.value().get_d() / both[0].below.value().get_d();
}

constexpr Plain kFlat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(ExactDistance, KnownByHand) {
    struct Known {
        const char* what;
        Plain b;
        double square;
    };
    const Known against_flat[] = {
        {"vertex over face", {{{1, 1, 3}, {1, 1, 5}, {2, 1, 5}}}, 9},
        {"two vertices", {{{-3, -4, 0}, {-9, -9, 0}, {-9, -8, 1}}}, 25},
        {"vertex, edge", {{{1, -2, 0}, {2, -5, 1}, {0, -5, -1}}}, 4},
        {"two edges", {{{1, -2, -1}, {1, -2, 1}, {1, -9, 0}}}, 4},
        {"edge, long side", {{{3, 3, -1}, {3, 3, 1}, {9, 9, 0}}}, 2},
        {"pierced", {{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}}, 0},
        {"one inside the other, one plane", {{{-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}}}, 0},
        {"itself", kFlat, 0},
        {"a point", {{{1, 1, 2}, {1, 1, 2}, {1, 1, 2}}}, 4},
        {"a segment through", {{{1, 1, -2}, {1, 1, 2}, {1, 1, 1}}}, 0},
    };
    for (const Known& known : against_flat) {
        EXPECT_EQ(squared(kFlat, known.b), known.square) << known.what;
    }
    const Plain lying{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}},
        standing{{{3, 1, 0}, {3, 5, 0}, {3, 2, 0}}};
    EXPECT_EQ(squared(lying, standing), 2) << "two segments";
}

TEST(ExactDistance, ComparesWithoutRounding) {
    const double tiny = 0x1p-1000;
    const ExactSquare one =
        squared_distance(exact(kFlat), exact(Plain{{{1, 1, 1}, {1, 1, 2}, {2, 1, 2}}}));
    EXPECT_TRUE(one.at_least(1) && !one.more_than(1));
    EXPECT_TRUE(one.more_than(std::nextafter(1.0, 0)) && !one.at_least(std::nextafter(1.0, 2)));
    const ExactSquare hardly =
        squared_distance(exact(kFlat), exact(Plain{{{1, 1, tiny}, {1, 1, 2}, {2, 1, 2}}}));
    EXPECT_TRUE(!hardly.is_zero() && hardly.at_least(tiny) && !hardly.more_than(tiny));
}

/// Compares one file of pairs; returns how many.
unsigned compare_file(const std::string& name) {
    const TritriAnswers answers = read_tritri_answers(kTritriFolder + "answers.csv");
    Bytes bytes(kTritriFolder + name);
    (void)bytes.take<std::array<char, 4>>();
    const bool is_double = bytes.take<std::uint32_t>() == 8;
    const bool posed = bytes.take<std::uint32_t>() != 0;
    const auto count = bytes.take<std::uint32_t>();
    unsigned compared = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto id = bytes.take<std::uint32_t>();
        ExactTriangle a, b;
        const TritriExpected& expected = answers.at(id);
        if (is_double) {
            const auto v = bytes.take<Pair>();
            if (expected.answer != 'R') {
                a = exact(v[0]);
                b = exact(v[1]);
            }
        } else {
            const Triangle from_a = take_triangle(bytes), from_b = take_triangle(bytes);
            const Pose pose = posed ? take_pose(bytes) : Pose{};
            if (expected.answer != 'R') {
                a = exact(from_a);
                b = placed(pose, from_b);
            }
        }
        if (expected.answer == 'R') {
            continue;
        }
        ++compared;
        const ExactSquare square = squared_distance(a, b);
        EXPECT_EQ(square.is_zero(), expected.answer == '1') << id;
        EXPECT_NEAR(square.mm(), expected.distance_mm, 1e-15 * expected.distance_mm + 0x1p-1074)
            << id;
    }
    EXPECT_TRUE(bytes.at_end());
    return compared;
}

TEST(ExactDistance, CasesMadeElsewhere) {
    if (!std::ifstream(kTritriFolder + "answers.csv")) {
        GTEST_SKIP() << "no " << kTritriFolder
                     << "answers.csv: set the CMake variable AXG_SHARED_DATA";
    }
    EXPECT_GT(compare_file("pairs_f32.bin"), 3000U);
    EXPECT_GT(compare_file("pairs_f64.bin"), 3000U);
    EXPECT_GT(compare_file("pairs_pose.bin"), 800U);
}

}  // namespace
}  // namespace axg::test
#else
TEST(ExactDistance, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
