// SPDX-License-Identifier: GPL-2.0-or-later
// A jog: one axis moves, one way, within the limits of the machine file, and the others stay. Both
// joints of a gantry move, or neither. This file does not use HAL.
#ifndef AXG_AXGUARD_JOG_H
#define AXG_AXGUARD_JOG_H

#include <math.h>
#include <stdbool.h>

#include "firmware_if/linuxcnc/axguard_joints.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

#define AXG_JOG_ROUNDED 1.000001  // what doubles of positions add to a difference

typedef struct axg_jog {
    int joint;
    bool goes_down;
    double speed, acceleration;           // the most, in the unit of the pins
    double aligned[AXG_WIRE_JOINTS_MAX];  // of each joint: so far off it is still in its place
} axg_jog;

static inline bool axg_jog_keeps(const axg_jog* jog, const axg_joints* map, const double wanted[],
                                 const double at[], const double speed[], double period_s) {
    bool keeps = true;
    for (int i = 0; i < map->count; ++i) {
        const double step = wanted[i] - at[i];
        if (map->axis[i] != map->axis[jog->joint]) {
            keeps = keeps && fabs(step) <= jog->aligned[i];
            continue;
        }
        const double forward = jog->goes_down ? -step : step;
        const double faster = forward > 0 ? forward / period_s : 0;
        const double change = fabs(faster - fabs(speed[i])) / period_s;
        keeps = keeps && forward >= -jog->aligned[i] && faster <= AXG_JOG_ROUNDED * jog->speed &&
                change <= AXG_JOG_ROUNDED * jog->acceleration;
    }
    return keeps;
}

// @param still  what is no motion
// @param speed  all 0
// @return       true: the joints of the axis were sent on
static inline bool axg_jog_pass(const axg_jog* jog, const axg_joints* map, double still,
                                const double wanted[], double at[], double speed[],
                                double period_s) {
    const int axis = map->axis[jog->joint];
    const double step = axg_mean_of(map, wanted, axis) - axg_mean_of(map, at, axis);
    const bool moves = jog->goes_down ? step < -still : step > still;
    for (int i = 0; i < map->count && moves; ++i) {
        if (map->axis[i] == axis) {
            speed[i] = (wanted[i] - at[i]) / period_s;
            at[i] = wanted[i];
        }
    }
    return moves;
}

#endif
