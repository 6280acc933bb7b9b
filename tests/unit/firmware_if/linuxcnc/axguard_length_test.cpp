// SPDX-License-Identifier: Apache-2.0
// The length of the tool in the spindle: both sides of the tolerance, and no comparison with an
// offset that may be another tool's.
#include "firmware_if/linuxcnc/axguard_length.h"

#include <gtest/gtest.h>

#include <limits>

namespace axg {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

axg_length known(std::uint16_t tool, double file_mm) {
    axg_length length{};
    axg_length_begin(&length, tool);
    length.file_mm = file_mm;
    length.file_tool = tool;
    length.is_known = true;
    return length;
}

TEST(ToolLength, MoreThanTheToleranceDiffers) {
    axg_length length = known(1, 140);
    EXPECT_FALSE(axg_length_compare(&length, 1, 140, 0.125));
    EXPECT_FALSE(axg_length_compare(&length, 1, 140.125, 0.125));
    EXPECT_FALSE(axg_length_compare(&length, 1, 139.875, 0.125));
    EXPECT_TRUE(axg_length_compare(&length, 1, 140.126, 0.125));
    EXPECT_TRUE(axg_length_compare(&length, 1, 139.874, 0.125));
    EXPECT_TRUE(axg_length_compare(&length, 1, -140, 0.125));
    EXPECT_TRUE(length.differs);
    EXPECT_FALSE(axg_length_compare(&length, 1, 140, 0.125)) << "corrected";
    EXPECT_FALSE(length.differs);
}

TEST(ToolLength, WhatIsNoNumberDiffers) {
    axg_length length = known(1, 140);
    EXPECT_TRUE(axg_length_compare(&length, 1, kNan, 0.125));
    EXPECT_TRUE(axg_length_compare(&length, 1, 140, kNan));
    EXPECT_TRUE(axg_length_compare(&length, 1, 140, -1));
}

TEST(ToolLength, WithoutAnOffsetOrALengthNothingIsCompared) {
    axg_length length = known(1, 140);
    EXPECT_FALSE(axg_length_compare(&length, 1, 0, 0.125)) << "G49";
    EXPECT_TRUE(axg_length_compare(&length, 1, 160, 0.125));
    length.is_known = false;
    EXPECT_FALSE(axg_length_compare(&length, 1, 160, 0.125));
    length.is_known = true;
    length.file_tool = 2;
    EXPECT_FALSE(axg_length_compare(&length, 1, 160, 0.125)) << "the length of another tool";
}

// M6 comes before G43: until then LinuxCNC has the offset of the tool before.
TEST(ToolLength, AfterAChangeTheOldOffsetIsNotCompared) {
    axg_length length = known(1, 140);
    EXPECT_FALSE(axg_length_compare(&length, 1, 140, 0.125));
    length.file_tool = 2;
    length.file_mm = 220;
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(axg_length_compare(&length, 2, 140, 0.125));
    }
    EXPECT_TRUE(axg_length_compare(&length, 2, 200, 0.125));
    EXPECT_TRUE(axg_length_compare(&length, 2, 140, 0.125)) << "set since: it is this tool's";
    EXPECT_FALSE(axg_length_compare(&length, 2, 220, 0.125));
}

}  // namespace
}  // namespace axg
