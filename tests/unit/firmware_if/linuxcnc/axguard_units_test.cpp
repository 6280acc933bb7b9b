// SPDX-License-Identifier: Apache-2.0
// The unit of LinuxCNC's pins: each of its words, a number of units in a mm, and nothing else.
#include "firmware_if/linuxcnc/axguard_units.h"

#include <gtest/gtest.h>

namespace axg {
namespace {

TEST(LinuxCncUnits, WordsAreThoseOfTheIni) {
    for (const char* text : {"mm", "MM", "metric"}) {
        EXPECT_EQ(axg_unit_mm(text), 1) << text;
    }
    for (const char* text : {"inch", "Inch", "in", "imperial"}) {
        EXPECT_EQ(axg_unit_mm(text), 25.4) << text;
    }
}

TEST(LinuxCncUnits, ANumberIsUnitsInAMm) {
    EXPECT_EQ(axg_unit_mm("1"), 1);
    EXPECT_EQ(axg_unit_mm("0.5"), 2);
    EXPECT_NEAR(axg_unit_mm("0.03937007874015748"), 25.4, 1e-12);
}

// A HAL file with a key that the INI lacks passes its name on.
TEST(LinuxCncUnits, AnythingElseIsNoUnit) {
    for (const char* text : {"", "nothing", "[TRAJ]LINEAR_UNITS", "cm", "inches", "0", "-1", "nan",
                             "inf", "1mm", "1e-9", "1e9"}) {
        EXPECT_EQ(axg_unit_mm(text), 0) << text;
    }
}

TEST(LinuxCncUnits, AnglesAreThoseOfTheIniToo) {
    for (const char* text : {"deg", "Degree", "1"}) {
        EXPECT_EQ(axg_unit_deg(text), 1) << text;
    }
    for (const char* text : {"rad", "RADIAN", "0.017453292519943295"}) {
        EXPECT_NEAR(axg_unit_deg(text), 180 / 3.14159265358979312, 1e-12) << text;
    }
    for (const char* text : {"grad", "gon"}) {
        EXPECT_EQ(axg_unit_deg(text), 0.9) << text;
    }
    for (const char* text : {"", "nothing", "[TRAJ]ANGULAR_UNITS", "degrees", "turn", "mm", "0"}) {
        EXPECT_EQ(axg_unit_deg(text), 0) << text;
    }
}

}  // namespace
}  // namespace axg
