// SPDX-License-Identifier: Apache-2.0
// Which reaction, deceleration and jerk a stop fits. The stops are those of the simulated axis,
// which has a formula of its own.
#include "firmware_if/board_test/stop_fit.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/board/axis_motion.hpp"

namespace axg {
namespace {

constexpr double kPeriodS = 1e-3;

/// An axis at this speed goes on for the reaction, and then brakes by these figures.
AxisStop stop_of(double speed, const StopFigures& figures) {
    AxisStop stop{.axis = 0, .speed = speed, .tolerance = 1e-9, .points = {}};
    for (int i = 0; i < 400; ++i) {
        const double seconds = i * kPeriodS;
        AxisMotion axis{.position = 0, .speed = speed, .acceleration = 0, .jerk = 0};
        const double free_s = std::min(seconds, figures.reaction_s);
        axis = moved_on(axis, free_s);
        brake(axis, {.deceleration = figures.deceleration, .jerk = figures.jerk}, seconds - free_s);
        stop.points.push_back({seconds, axis.position});
    }
    return stop;
}

TEST(StopFit, TheLongestTravelIsThatOfTheSimulatedAxis) {
    for (const double speed : {1.0, 20.0, 100.0, 500.0}) {
        const StopFigures figures{1.7e-3, 1500, 50'000};
        for (const AxisStop::Point& point : stop_of(speed, figures).points) {
            EXPECT_NEAR(longest_travel(figures, speed, point.seconds), point.travel, 1e-9) << speed;
        }
    }
}

TEST(StopFit, WithoutAJerkTheDecelerationIsThereAtOnce) {
    const StopFigures figures{0, 1000, kNoJerkLimit};
    EXPECT_DOUBLE_EQ(longest_travel(figures, 100, 0.05), 100 * 0.05 - 0.5 * 1000 * 0.05 * 0.05);
    EXPECT_DOUBLE_EQ(longest_travel(figures, 100, 9), 5);
}

TEST(StopFit, EachFigureIsFoundWithTheOthersKnown) {
    const StopFigures figures{2.5e-3, 1500, 50'000};
    const std::vector<AxisStop> stops{stop_of(100, figures), stop_of(160, figures)};
    EXPECT_NEAR(fitted_reaction_s(stops[0], 1500, 50'000), 2.5e-3, 1e-6);
    EXPECT_NEAR(fitted_deceleration(stops, 0, {2.5e-3, 700, 50'000}).value_or(0), 1500, 0.1);
    EXPECT_NEAR(fitted_jerk(stops, 0, {2.5e-3, 1500, 20'000}).value_or(0), 50'000, 10);
}

TEST(StopFit, BothSidesOfAReaction) {
    const AxisStop stop = stop_of(100, {2e-3, 1500, 50'000});
    EXPECT_TRUE(fits(stop, {2e-3, 1500, 50'000}));
    EXPECT_FALSE(fits(stop, {1.99e-3, 1500, 50'000}));
}

TEST(StopFit, AnAxisThatGoesOnFitsNoReaction) {
    AxisStop stop{.axis = 0, .speed = 100, .tolerance = 0, .points = {}};
    for (int i = 0; i < 20'000; ++i) {
        stop.points.push_back({i * kPeriodS, 100 * i * kPeriodS});
    }
    EXPECT_EQ(fitted_reaction_s(stop, 1500, 50'000), kNoReaction);
}

// From 20 mm/s the axis rests before it brakes at 1500: that figure shows in no position.
TEST(StopFit, AFigureThatNoStopReachedIsNotKnown) {
    const std::vector<AxisStop> stops{stop_of(20, {0, 1500, 50'000})};
    EXPECT_FALSE(fitted_deceleration(stops, 0, {0, 1500, 50'000}));
    EXPECT_TRUE(fitted_jerk(stops, 0, {0, 1500, 50'000}));
    EXPECT_FALSE(fitted_jerk(stops, 1, {0, 1500, 50'000})) << "no stop of that axis";
}

}  // namespace
}  // namespace axg
