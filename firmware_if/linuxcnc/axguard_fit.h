// SPDX-License-Identifier: GPL-2.0-or-later
// Whether a machine file is that of a machine under LinuxCNC. This file does not use HAL.
#ifndef AXG_AXGUARD_FIT_H
#define AXG_AXGUARD_FIT_H

#include <axguard.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "firmware_if/linuxcnc/axguard_units.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

// @param angle  the unit of rotary joints, as the HAL file states it
// @return       false after a message
static inline bool axg_is_fit(const axg_terms* terms, const char* file, const char* angle) {
    if (terms->takes_samples == 0 || terms->is_independent == 0 || terms->permit_version != 2 ||
        terms->axis_count > AXG_WIRE_JOINTS_MAX) {
        fprintf(stderr,
                "axguard-hal: %s: needs can.format classical or fd, no can.ahead, can.permit 2, "
                "guard.stop_promise independent, and at most %d axes.\n",
                file, AXG_WIRE_JOINTS_MAX);
        return false;
    }
    for (uint32_t i = 0; i < terms->axis_count; ++i) {
        if (terms->axes[i].is_rotary != 0 && axg_unit_deg(angle) == 0) {
            fprintf(stderr, AXG_ANGLES_WORDS, angle);
            return false;
        }
    }
    return true;
}

#endif
