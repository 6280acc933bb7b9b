// SPDX-License-Identifier: Apache-2.0
// A jog by permit: both sides of each limit that the machine file states, the axes that stay, and a
// gantry of which both joints move or neither. And what a ramp needs to know of each axis.
#include "firmware_if/linuxcnc/axguard_jog.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "firmware_if/linuxcnc/axguard_options.h"

namespace axg {
namespace {

constexpr double kServoS = 0.001;

class LinuxCncJog : public ::testing::Test {
  protected:
    LinuxCncJog() {
        (void)axg_joints_from(&map, "XYYZ", 0);
        jog.joint = 1;
        jog.speed = 5;
        jog.acceleration = 1000;
        std::fill(std::begin(jog.aligned), std::end(jog.aligned), 1e-4);
    }

    /// Steps of X, both of Y, and Z in one period, from a speed of Y.
    bool keeps(const std::vector<double>& steps, double speed_of_y = 5) {
        const double at[4] = {};
        const double speed[4] = {0, speed_of_y, speed_of_y, 0};
        return axg_jog_keeps(&jog, &map, steps.data(), at, speed, kServoS);
    }

    axg_joints map{};
    axg_jog jog{};
};

TEST_F(LinuxCncJog, KeepsItsSpeedItsAccelerationAndItsWay) {
    EXPECT_TRUE(keeps({0, 0.005, 0.005, 0}));
    EXPECT_FALSE(keeps({0, 0.0051, 0.0051, 0})) << "faster than stated";
    EXPECT_TRUE(keeps({0, 0.001, 0.001, 0}, 0));
    EXPECT_FALSE(keeps({0, 0.0011, 0.0011, 0}, 0)) << "harder than stated";
    EXPECT_FALSE(keeps({0, -0.001, -0.001, 0}, 0)) << "the other way";
    jog.goes_down = true;
    EXPECT_TRUE(keeps({0, -0.005, -0.005, 0}));
    EXPECT_FALSE(keeps({0, 0.001, 0.001, 0}, 0)) << "the other way";
}

TEST_F(LinuxCncJog, NoOtherAxisMoves) {
    EXPECT_TRUE(keeps({1e-4, 0.005, 0.005, -1e-4}));
    EXPECT_FALSE(keeps({2e-4, 0.005, 0.005, 0}));
    EXPECT_FALSE(keeps({0, 0.005, 0.005, -2e-4}));
}

TEST_F(LinuxCncJog, SendsBothJointsOfAGantryOrNeither) {
    const double wanted[4] = {9, 0.003, 0.005, 9};
    double at[4] = {}, speed[4] = {};
    EXPECT_TRUE(axg_jog_pass(&jog, &map, 1e-8, wanted, at, speed, kServoS));
    EXPECT_EQ(std::vector<double>(at, at + 4), (std::vector<double>{0, 0.003, 0.005, 0}));
    EXPECT_NEAR(speed[2], 5, 1e-12);
    EXPECT_FALSE(axg_jog_pass(&jog, &map, 1e-8, wanted, at, speed, kServoS)) << "it is there";
    const double back[4] = {0, 0.001, 0.001, 0};
    EXPECT_FALSE(axg_jog_pass(&jog, &map, 1e-8, back, at, speed, kServoS));
    EXPECT_EQ(at[1], 0.003);
}

TEST(LinuxCncOptions, EachAxisHasADecelerationAUnitAndAGantryItsSkew) {
    axg_joints map{};
    ASSERT_TRUE(axg_joints_from(&map, "XYY", 0));
    double option[AXG_WIRE_OPTIONS] = {};
    for (int axis = 0; axis < map.axes; ++axis) {
        option[AXG_WIRE_STOPPING + axis] = 400;
        option[AXG_WIRE_UNIT + axis] = 1;
    }
    option[AXG_WIRE_SKEW + 1] = 0.1;
    EXPECT_TRUE(axg_brakes(&map, option));
    for (const int needed : {AXG_WIRE_STOPPING + 1, AXG_WIRE_UNIT + 0, AXG_WIRE_SKEW + 1}) {
        const double stated = option[needed];
        option[needed] = 0;
        EXPECT_FALSE(axg_brakes(&map, option)) << needed;
        option[needed] = stated;
    }
}

}  // namespace
}  // namespace axg
