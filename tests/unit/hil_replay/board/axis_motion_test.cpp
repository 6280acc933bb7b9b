// SPDX-License-Identifier: Apache-2.0
// The simulated axis: stops worked out by hand, on every side of every phase.
#include "hil_replay/board/axis_motion.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

constexpr Brake kHow{.deceleration = 1000, .jerk = 100000};

AxisMotion axis(double speed, double acceleration) {
    return {.position = 5, .speed = speed, .acceleration = acceleration, .jerk = 0};
}

TEST(AxisMotion, ConstantJerkIsItsPolynomial) {
    const AxisMotion on = moved_on({1, 2, 3, 6}, 2);  // 1 + 2t + 3t^2/2 + t^3, and derivatives
    EXPECT_DOUBLE_EQ(on.position, 1 + 4 + 6 + 8);
    EXPECT_DOUBLE_EQ(on.speed, 2 + 6 + 12);
    EXPECT_DOUBLE_EQ(on.acceleration, 3 + 12);
}

// 100 mm/s, no acceleration. Ramp of 10 ms: 1 mm - 1/60 mm, 95 mm/s left; then 95^2 / 2000.
TEST(AxisMotion, StopsAfterARampAndTheGuaranteedDeceleration) {
    AxisMotion a = axis(100, 0);
    brake(a, kHow, 0.104);
    EXPECT_NEAR(a.speed, 1, 1e-9);  // 95 - 1000 * 0.094
    EXPECT_DOUBLE_EQ(a.acceleration, -1000);
    brake(a, kHow, 1);
    EXPECT_NEAR(a.position, 5 + 1 - 1.0 / 60 + 95 * 95 / 2000.0, 1e-12);
    EXPECT_TRUE(is_resting(a));
}

// The same from full acceleration: the ramp takes 20 ms and ends at the speed it began with.
TEST(AxisMotion, RampsFromTheAccelerationItHas) {
    AxisMotion a = axis(100, 1000);
    brake(a, kHow, 0.02);
    EXPECT_NEAR(a.speed, 100, 1e-9);
    EXPECT_NEAR(a.position, 5 + 0.02 * (100 + 0.02 * (500 - 0.02 * 100000 / 6)), 1e-12);
    brake(a, kHow, 1);
    EXPECT_NEAR(a.position, 5 + 0.02 * (100 + 0.02 * (500 - 0.02 * 100000 / 6)) + 5, 1e-12);
}

// 1 mm/s with 100 mm/s2: at rest within the ramp, at t = (100 + sqrt(100^2 + 2 * 100000)) / 100000.
TEST(AxisMotion, MayComeToRestWithinTheRamp) {
    AxisMotion a = axis(1, 100);
    const double t = 0.0055825756949558;
    brake(a, kHow, 0.999 * t);
    EXPECT_GT(a.speed, 0);
    brake(a, kHow, 1);
    EXPECT_TRUE(is_resting(a));
    EXPECT_NEAR(a.position, 5 + t + 50 * t * t - 100000 * t * t * t / 6, 1e-12);
}

TEST(AxisMotion, ADirectionMirrorsTheOther) {
    for (const double acceleration : {-1500.0, -300.0, 0.0, 700.0}) {
        AxisMotion forwards = axis(80, acceleration), backwards = axis(-80, -acceleration);
        for (int i = 0; i < 300; ++i) {
            brake(forwards, kHow, 7e-4);
            brake(backwards, kHow, 7e-4);
            ASSERT_DOUBLE_EQ(forwards.position - 5, 5 - backwards.position);
            ASSERT_DOUBLE_EQ(forwards.speed, -backwards.speed);
            ASSERT_GE(forwards.speed, 0) << "an axis turned round";
        }
        EXPECT_TRUE(is_resting(forwards));
    }
}

// Braking harder than promised when the stop comes: the promise is enough from there on.
TEST(AxisMotion, KeepsThePromiseWhereItBrakedHarder) {
    AxisMotion a = axis(100, -2500);
    brake(a, kHow, 1);
    EXPECT_NEAR(a.position, 5 + 100 * 100 / 2000.0, 1e-12);
}

TEST(AxisMotion, StepsDoNotMatter) {
    AxisMotion one = axis(150, 800), many = one;
    brake(one, kHow, 0.05);
    for (int i = 0; i < 5000; ++i) {
        brake(many, kHow, 1e-5);
    }
    EXPECT_NEAR(one.position, many.position, 1e-9);
    EXPECT_NEAR(one.speed, many.speed, 1e-9);
}

TEST(AxisMotion, AnAxisAtRestStays) {
    AxisMotion a = axis(0, 0);
    brake(a, kHow, 10);
    EXPECT_EQ(a.position, 5);
    EXPECT_TRUE(is_resting(a));
}

// Just set in motion: it has an acceleration and no speed yet.
TEST(AxisMotion, WhatIsAboutToMoveStopsToo) {
    for (const double side : {1.0, -1.0}) {
        AxisMotion a = axis(0, side * 500);
        brake(a, kHow, 1);
        EXPECT_TRUE(is_resting(a));
        const double t = 0.01;  // 2 * 500 / 100000
        EXPECT_NEAR(a.position - 5, side * (250 * t * t - 100000 * t * t * t / 6), 1e-12);
    }
}

}  // namespace
}  // namespace axg
