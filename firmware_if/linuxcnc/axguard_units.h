// SPDX-License-Identifier: GPL-2.0-or-later
// Pins of LinuxCNC have the length of the machine's unit, the guard has mm: axguard-hal converts
// both ways, and axguard_stop has values of its pins alone. This file does not use HAL.
#ifndef AXG_AXGUARD_UNITS_H
#define AXG_AXGUARD_UNITS_H

#include <stdbool.h>
#include <stdlib.h>
#include <strings.h>

#define AXG_UNITS_WORDS                                                                          \
    "axguard-hal: --linear-units: found '%s', expected mm or inch. Give it the machine's unit: " \
    "--linear-units [TRAJ]LINEAR_UNITS\n"

static inline bool axg_is_one_of(const char* text, const char* const* names) {
    for (; *names != NULL; ++names) {
        if (strcasecmp(text, *names) == 0) {
            return true;
        }
    }
    return false;
}

// The length of [TRAJ]LINEAR_UNITS in mm, in the words of LinuxCNC 2.9; it also accepts how many
// units a mm has.
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
    char* end = NULL;
    const double per_mm = strtod(text, &end);
    const double unit_mm = per_mm > 0 ? 1 / per_mm : 0;
    return end != text && *end == '\0' && unit_mm >= 1e-3 && unit_mm <= 1e3 ? unit_mm : 0;
}

#endif
