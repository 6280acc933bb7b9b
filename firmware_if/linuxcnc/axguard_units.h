// SPDX-License-Identifier: GPL-2.0-or-later
// Pins of LinuxCNC have the machine's units, the guard has mm and degrees: axguard-hal converts
// both ways, and axguard_stop has values of its pins alone. This file does not use HAL.
#ifndef AXG_AXGUARD_UNITS_H
#define AXG_AXGUARD_UNITS_H

#include <stdbool.h>
#include <stdlib.h>
#include <strings.h>

#define AXG_UNITS_WORDS                                                                          \
    "axguard-hal: --linear-units: found '%s', expected mm or inch. Give it the machine's unit: " \
    "--linear-units [TRAJ]LINEAR_UNITS\n"
#define AXG_ANGLES_WORDS                                                                           \
    "axguard-hal: --angular-units: found '%s', expected degree, rad or grad. Give it the unit of " \
    "the rotary axes: --angular-units [TRAJ]ANGULAR_UNITS\n"

static inline bool axg_is_one_of(const char* text, const char* const* names) {
    for (; *names != NULL; ++names) {
        if (strcasecmp(text, *names) == 0) {
            return true;
        }
    }
    return false;
}

// A unit stated by how many of it one mm or degree has.
// @return  0: no unit
static inline double axg_unit_per(const char* text) {
    char* end = NULL;
    const double count = strtod(text, &end);
    const double unit = count > 0 ? 1 / count : 0;
    return end != text && *end == '\0' && unit >= 1e-3 && unit <= 1e3 ? unit : 0;
}

// The length of [TRAJ]LINEAR_UNITS in mm, in the words of LinuxCNC 2.9.
// @return  0: no unit
static inline double axg_unit_mm(const char* text) {
    static const char* const mm[] = {"mm", "metric", NULL};
    static const char* const inch[] = {"inch", "in", "imperial", NULL};
    if (axg_is_one_of(text, mm)) {
        return 1;
    }
    if (axg_is_one_of(text, inch)) {
        return 25.4;
    }
    return axg_unit_per(text);
}

// The same of [TRAJ]ANGULAR_UNITS, in degrees.
static inline double axg_unit_deg(const char* text) {
    static const char* const deg[] = {"deg", "degree", NULL};
    static const char* const rad[] = {"rad", "radian", NULL};
    static const char* const grad[] = {"grad", "gon", NULL};
    return axg_is_one_of(text, deg)    ? 1
           : axg_is_one_of(text, rad)  ? 57.29577951308232
           : axg_is_one_of(text, grad) ? 0.9
                                       : axg_unit_per(text);
}

#endif
