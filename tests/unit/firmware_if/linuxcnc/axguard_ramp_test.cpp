// SPDX-License-Identifier: Apache-2.0
// The ramp of a stop: from a speed that the joint had, never from one wrong command, down to rest
// without turning round, whatever the machine file states.
#include "firmware_if/linuxcnc/axguard_ramp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace axg {
namespace {

constexpr double kPeriodS = 0.001;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

class Ramp : public ::testing::Test {
  protected:
    Ramp() { (void)axg_joints_from(&map, "XYY", 0); }

    void begin(const std::vector<double>& last, const std::vector<double>& before,
               bool levels = false) {
        std::copy(last.begin(), last.end(), speed);
        axg_ramp_begin(&map, speed, before.data(), levels);
    }
    std::vector<double> speeds() const { return {speed, speed + 3}; }
    bool step() { return axg_ramp_step(&map, at, speed, stopping, kPeriodS); }

    axg_joints map{};
    double at[3] = {0, 0, 0};
    double speed[3] = {0, 0, 0};
    double stopping[2] = {400, 800};
};

// Switched off, LinuxCNC commands what it measures: a millimetre back is no speed of 1000 mm/s.
TEST_F(Ramp, OneWrongCommandIsNoSpeed) {
    begin({-840, 1e300, 98}, {250, 0, 100});
    EXPECT_EQ(speeds(), (std::vector<double>{0, 0, 98}));
    begin({kNoNumber, 5, 7}, {100, kNoNumber, 7});
    EXPECT_EQ(speeds(), (std::vector<double>{0, 0, 7}));
}

TEST_F(Ramp, BothJointsOfAGantryBeginWithOneSpeedWhereAPermitMovedThem) {
    begin({0, 40, 60}, {0, 40, 60}, true);
    EXPECT_EQ(speeds(), (std::vector<double>{0, 50, 50}));
    begin({0, 200, -100}, {0, 200, -100}, false);
    EXPECT_EQ(speeds(), (std::vector<double>{0, 200, -100})) << "by a key each goes by itself";
}

TEST_F(Ramp, EachJointBrakesByItselfAndNoneTurnsRound) {
    begin({-20, 40, 40}, {-20, 40, 40});
    int periods = 0;
    for (double last[3] = {-20, 40, 40}; step(); ++periods) {
        for (int i = 0; i < 3; ++i) {
            EXPECT_LE(std::fabs(speed[i]), std::fabs(last[i]));
            EXPECT_GE(speed[i] * last[i], 0);
            last[i] = speed[i];
        }
        ASSERT_LT(periods, 100);
    }
    EXPECT_LE(periods, 50);
    EXPECT_NEAR(at[0], -0.5 * 20 * 20 / 400, 0.02);
    EXPECT_NEAR(at[1], 0.5 * 40 * 40 / 800, 0.04);
    EXPECT_EQ(at[1], at[2]);
}

TEST_F(Ramp, WithoutADecelerationAJointStopsAtOnce) {
    begin({20, 0, 0}, {20, 0, 0});
    for (const double none : {0.0, -1.0, kNoNumber}) {
        stopping[0] = none;
        speed[0] = 20;
        EXPECT_FALSE(step()) << none;
        EXPECT_EQ(at[0], 0);
    }
}

TEST(RampPlace, WhatIsNoNumberOrNoPlaceIsNoCommand) {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    for (const double command : {kNoNumber, kEndless, -kEndless, 1e300, 1.1e9}) {
        EXPECT_FALSE(axg_ramp_is_place(command)) << command;
    }
    for (const double command : {0.0, -250.0, 36'000.0, 1e9}) {
        EXPECT_TRUE(axg_ramp_is_place(command)) << command;
    }
}

}  // namespace
}  // namespace axg
