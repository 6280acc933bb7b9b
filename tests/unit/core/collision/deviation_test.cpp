// SPDX-License-Identifier: Apache-2.0
// How far one surface is proven to stray from another: shapes whose result is known.
#include "core/collision/deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "tests/support/solids.hpp"

namespace axg::test {
namespace {

constexpr double kMostMm = 5;
constexpr double kStepMm = kMostMm / 128;  // bounds are found to that

const Triangles kPlate{{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}},
                       {{100, 0, 0}, {100, 100, 0}, {0, 100, 0}}};

void expect_bound(const Triangles& surface, const Triangles& other, double true_mm) {
    const std::optional<double> bound = bound_deviation(surface, other, kMostMm);
    ASSERT_TRUE(bound);
    EXPECT_GE(*bound, true_mm);
    EXPECT_LE(*bound, true_mm + kStepMm);
}

TEST(Deviation, ASurfaceIsAtItself) {
    expect_bound(kPlate, kPlate, 0);
}

TEST(Deviation, AsFarAsItWasMoved) {
    expect_bound(moved(kPlate, {0, 0, 1.5F}), kPlate, 1.5);
    expect_bound(moved(kPlate, {0, 2, 0}), kPlate, 2);
}

TEST(Deviation, OneSided) {
    const Triangles half{kPlate[0]};
    expect_bound(half, kPlate, 0);
    EXPECT_FALSE(bound_deviation(kPlate, half, kMostMm));  // its corner is 70.7 mm away
}

/// No corner of the roof is nearer to the plate than its foot, but what is between them is: a test
/// of corners alone would call this 0.
TEST(Deviation, TheMiddleCounts) {
    const Triangles pit{{{0, 0, 0}, {100, 0, 0}, {50, 50, -3}},
                        {{100, 0, 0}, {100, 100, 0}, {50, 50, -3}},
                        {{100, 100, 0}, {0, 100, 0}, {50, 50, -3}},
                        {{0, 100, 0}, {0, 0, 0}, {50, 50, -3}}};
    const std::optional<double> bound = bound_deviation(kPlate, pit, kMostMm);
    ASSERT_TRUE(bound);
    const double true_mm = 3 * 50 / std::hypot(50.0, 3.0);  // from the middle to a slope
    EXPECT_GE(*bound, true_mm);
    EXPECT_LE(*bound, true_mm + kStepMm);
}

/// Two triangles cover it together, none alone: it has to be cut.
TEST(Deviation, CoveredByPieces) {
    const Triangles across{{{0, 50, 0.5F}, {100, 50, 0.5F}, {50, 60, 0.5F}}};
    Triangles strips;
    for (int i = 0; i < 10; ++i) {
        const auto x = static_cast<float>(10 * i);
        strips.push_back({{x, 0, 0}, {x + 10, 0, 0}, {x, 100, 0}});
        strips.push_back({{x + 10, 0, 0}, {x + 10, 100, 0}, {x, 100, 0}});
    }
    expect_bound(across, strips, 0.5);
}

TEST(Deviation, ThinTrianglesAndPoints) {
    const Triangles line{{{0, 0, 1}, {50, 0, 1}, {100, 0, 1}}},
        point{{{7, 7, 2}, {7, 7, 2}, {7, 7, 2}}};
    expect_bound(line, kPlate, 1);
    expect_bound(point, kPlate, 2);
    expect_bound(line, line, 0);
}

TEST(Deviation, TooFarIsNoBound) {
    EXPECT_FALSE(bound_deviation(moved(kPlate, {0, 0, 5.01F}), kPlate, kMostMm));
    EXPECT_TRUE(bound_deviation(moved(kPlate, {0, 0, 4.99F}), kPlate, kMostMm));
}

}  // namespace
}  // namespace axg::test
