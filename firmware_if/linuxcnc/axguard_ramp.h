// SPDX-License-Identifier: GPL-2.0-or-later
// The ramp of a stop: each joint by itself, by the deceleration of the machine file. No joint waits
// for another one, and none turns round. This file does not use HAL.
#ifndef AXG_AXGUARD_RAMP_H
#define AXG_AXGUARD_RAMP_H

#include <math.h>
#include <stdbool.h>

#include "firmware_if/linuxcnc/axguard_joints.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

// What is not a place that a machine has, NaN among it, in the units of the pins.
#define AXG_RAMP_PLACE_MOST 1e9

static inline bool axg_ramp_is_place(double command) {
    return fabs(command) <= AXG_RAMP_PLACE_MOST;
}

static inline bool axg_ramp_is_fast(const axg_joints* map, const double speed[]) {
    int count = 0;
    while (count < map->count && speed[count] == 0) {
        ++count;
    }
    return count < map->count;
}

// Where a ramp begins: the slower of the last two periods' speeds, so that one wrong command is no
// speed of the joint; none where they have different ways.
// @param speed   of each joint, of the last command that passed, per second
// @param before  of the one before
// @param levels  both joints of a gantry get their mean: it was moved by a permit
static inline void axg_ramp_begin(const axg_joints* map, double speed[], const double before[],
                                  bool levels) {
    for (int i = 0; i < map->count; ++i) {
        const bool is_slower = fabs(before[i]) < fabs(speed[i]);
        speed[i] = before[i] * speed[i] > 0 ? (is_slower ? before[i] : speed[i]) : 0;
    }
    axg_level(map, speed, levels);
}

// One period of it. An axis without a deceleration stops at once.
// @param at        where each joint is sent
// @param stopping  of each axis, per second squared
// @return          true: a joint still moves
static inline bool axg_ramp_step(const axg_joints* map, double at[], double speed[],
                                 const double stopping[], double period_s) {
    bool moves = false;
    for (int i = 0; i < map->count; ++i) {
        const double less = stopping[map->axis[i]] * period_s;
        const double slower = less > 0 ? fabs(speed[i]) - less : 0;
        speed[i] = slower > 0 ? copysign(slower, speed[i]) : 0;
        at[i] += speed[i] * period_s;
        moves = moves || speed[i] != 0;
    }
    return moves;
}

#endif
