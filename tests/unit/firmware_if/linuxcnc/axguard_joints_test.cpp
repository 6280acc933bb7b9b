// SPDX-License-Identifier: Apache-2.0
// Joints and axes: which joint moves which axis, both sides of the skew that a gantry may have, and
// a ramp that leaves the skew as it is.
#include "firmware_if/linuxcnc/axguard_joints.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace axg {
namespace {

axg_joints joints_from(const char* letters, int count = 0) {
    axg_joints out{};
    EXPECT_TRUE(axg_joints_from(&out, letters, count)) << letters;
    return out;
}

TEST(LinuxCncJoints, EqualLettersAreOneAxis) {
    const axg_joints of = joints_from("XYYZ");
    EXPECT_EQ(of.count, 4);
    EXPECT_EQ(of.axes, 3);
    EXPECT_EQ(std::vector<int>(of.axis, of.axis + 4), (std::vector<int>{0, 1, 1, 2}));
    EXPECT_FALSE(axg_is_gantry(&of, 0));
    EXPECT_TRUE(axg_is_gantry(&of, 1));
    EXPECT_FALSE(axg_is_gantry(&of, 2));
    const axg_joints apart = joints_from("XYZY");
    EXPECT_EQ(std::vector<int>(apart.axis, apart.axis + 4), (std::vector<int>{0, 1, 2, 1}));
    EXPECT_EQ(apart.second[1], 3);
}

TEST(LinuxCncJoints, WithoutLettersEachJointIsAnAxis) {
    const axg_joints of = joints_from("", 9);
    EXPECT_EQ(of.count, 9);
    EXPECT_EQ(of.axes, 9);
    for (int i = 0; i < 9; ++i) {
        EXPECT_EQ(of.axis[i], i);
        EXPECT_FALSE(axg_is_gantry(&of, i));
    }
}

TEST(LinuxCncJoints, OtherNumbersOfJointsAreRefused) {
    axg_joints out{};
    EXPECT_FALSE(axg_joints_from(&out, "", 0));
    EXPECT_FALSE(axg_joints_from(&out, "", -1));
    EXPECT_FALSE(axg_joints_from(&out, "", 10));
    EXPECT_FALSE(axg_joints_from(&out, "XYZABCUVWX", 0));
    EXPECT_FALSE(axg_joints_from(&out, "XYYYZ", 0)) << "three joints of one axis";
    EXPECT_TRUE(axg_joints_from(&out, "XYZABCUVW", 0));
}

TEST(LinuxCncJoints, MoreThanTheSkewIsNamed) {
    const axg_joints of = joints_from("XYYZ");
    const double skew[] = {0, 0.125, 0};
    const auto skewed = [&](double one, double other) {
        const double at[] = {5, one, other, -7};
        return axg_skewed_axis(&of, at, skew);
    };
    EXPECT_EQ(skewed(10, 10), -1);
    EXPECT_EQ(skewed(10, 10.125), -1);
    EXPECT_EQ(skewed(10.125, 10), -1);
    EXPECT_EQ(skewed(10, 10.126), 1);
    EXPECT_EQ(skewed(10.126, 10), 1);
    EXPECT_EQ(skewed(10, std::numeric_limits<double>::quiet_NaN()), 1);
    const double none[] = {0, 0, 0};
    const double at[] = {5, 10, 10.001, -7};
    EXPECT_EQ(axg_skewed_axis(&of, at, none), 1) << "no skew_mm: none is allowed";
}

TEST(LinuxCncJoints, TheGuardGetsTheMiddle) {
    const axg_joints of = joints_from("XYYZ");
    const double at[] = {5, 10, 10.5, -7};
    EXPECT_EQ(axg_mean_of(&of, at, 0), 5);
    EXPECT_EQ(axg_mean_of(&of, at, 1), 10.25);
    EXPECT_EQ(axg_mean_of(&of, at, 2), -7);
}

// Each by its own ramp, the faster joint would stop later: the middle would go farther than a stop
// from its speed, (v1^2 + v2^2) / 4 d in place of (v1 + v2)^2 / 8 d, and the skew would grow.
TEST(LinuxCncJoints, BothJointsOfAnAxisBrakeFromOneSpeed) {
    const axg_joints of = joints_from("XYYZ");
    double speed[] = {3, 40, 60, -2};
    axg_level(&of, speed, false);
    EXPECT_EQ(std::vector<double>(speed, speed + 4), (std::vector<double>{3, 40, 60, -2}))
        << "before homing one joint may search while the other stands";
    axg_level(&of, speed, true);
    EXPECT_EQ(std::vector<double>(speed, speed + 4), (std::vector<double>{3, 50, 50, -2}));
}

}  // namespace
}  // namespace axg
