// SPDX-License-Identifier: GPL-2.0-or-later
// The options of the board library, from those of the wire. This file does not use HAL.
#ifndef AXG_AXGUARD_OPTIONS_H
#define AXG_AXGUARD_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "firmware_if/board/axguard_board.h"
#include "firmware_if/linuxcnc/axguard_joints.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

#define AXG_FIT_WORDS                                                                              \
    "axguard-stop: the machine file has %u axes and %u us (found %d, %u us). Make them equal; an " \
    "axis with two joints needs skew_mm.\n"

static inline axg_board_options axg_options_from(const double option[AXG_WIRE_OPTIONS]) {
    axg_board_options options;
    memset(&options, 0, sizeof options);
    options.period_us = (uint32_t)option[AXG_WIRE_PERIOD_US];
    options.jitter_us = (uint32_t)option[AXG_WIRE_JITTER_US];
    options.reaction_us = (uint32_t)option[AXG_WIRE_REACTION_US];
    options.permit_samples_max = (uint8_t)option[AXG_WIRE_SAMPLES_MAX];
    options.axis_count = (uint8_t)option[AXG_WIRE_AXES];
    options.permit_id = (uint32_t)option[AXG_WIRE_PERMIT_ID];
    options.stop_id = (uint32_t)option[AXG_WIRE_STOP_ID];
    options.hashes_id = (uint32_t)option[AXG_WIRE_HASHES_ID];
    options.cap_kind = AXG_BOARD_CAP_IGNORED;
    for (int i = 0; i < 4; ++i) {
        options.hashes[i] = (uint32_t)option[AXG_WIRE_HASH + i];
    }
    return options;
}

// Whether each axis has what its ramp needs, and each gantry its skew.
static inline bool axg_brakes(const axg_joints* map, const double option[AXG_WIRE_OPTIONS]) {
    bool brakes = true;
    for (int i = 0; i < map->axes; ++i) {
        const bool has_skew = option[AXG_WIRE_SKEW + i] > 0;
        brakes = brakes && option[AXG_WIRE_STOPPING + i] > 0 && option[AXG_WIRE_UNIT + i] > 0 &&
                 (has_skew || !axg_is_gantry(map, i));
    }
    return brakes;
}

#endif
