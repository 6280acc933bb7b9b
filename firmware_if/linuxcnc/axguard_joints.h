// SPDX-License-Identifier: GPL-2.0-or-later
// Which axis of the machine file each joint moves. A gantry has two joints on one axis: the guard
// gets their mean, and a skew beyond skew_mm withholds the permit. This file does not use HAL.
#ifndef AXG_AXGUARD_JOINTS_H
#define AXG_AXGUARD_JOINTS_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "firmware_if/linuxcnc/axguard_wire.h"

#define AXG_SKEW_WORDS                                                                            \
    "axguard: joints %d and %d of one axis are %.4f apart, skew_mm allows %.4f: no permit. Home " \
    "both again.\n"

typedef struct axg_joints {
    int count, axes;
    int axis[AXG_WIRE_JOINTS_MAX];    // of each joint
    int first[AXG_WIRE_JOINTS_MAX];   // joint of each axis
    int second[AXG_WIRE_JOINTS_MAX];  // of each axis, its other joint; of one joint the first again
} axg_joints;

// A letter for each joint, as LinuxCNC's trivkins has them: equal letters are one axis, and axes
// have the order in which their letters come. No letters: as many axes as joints.
// @return  false: no joint, too many, or three of one axis
static inline bool axg_joints_from(axg_joints* out, const char* letters, int joints) {
    const bool has_letters = letters[0] != '\0';
    const size_t count = has_letters ? strlen(letters) : (size_t)(joints > 0 ? joints : 0);
    if (count < 1 || count > AXG_WIRE_JOINTS_MAX) {
        return false;
    }
    letters = has_letters ? letters : "012345678";
    out->count = (int)count;
    out->axes = 0;
    for (int joint = 0; joint < out->count; ++joint) {
        int axis = 0;
        while (axis < out->axes && letters[out->first[axis]] != letters[joint]) {
            ++axis;
        }
        if (axis == out->axes) {
            out->first[out->axes++] = joint;
        } else if (out->second[axis] != out->first[axis]) {
            return false;
        }
        out->second[axis] = joint;
        out->axis[joint] = axis;
    }
    return true;
}

static inline bool axg_is_gantry(const axg_joints* joints, int axis) {
    return joints->first[axis] != joints->second[axis];
}

static inline double axg_mean_of(const axg_joints* joints, const double of[], int axis) {
    return 0.5 * (of[joints->first[axis]] + of[joints->second[axis]]);
}

// How far the two joints of an axis are apart.
static inline double axg_skew_of(const axg_joints* joints, const double position[], int axis) {
    return fabs(position[joints->first[axis]] - position[joints->second[axis]]);
}

// @param skew  of each axis the largest one, in the unit of the positions
// @return      the first axis with more, or whose skew is no number; -1: none
static inline int axg_skewed_axis(const axg_joints* joints, const double position[],
                                  const double skew[]) {
    for (int axis = 0; axis < joints->axes; ++axis) {
        if (axg_is_gantry(joints, axis) && !(axg_skew_of(joints, position, axis) <= skew[axis])) {
            return axis;
        }
    }
    return -1;
}

// Both joints of an axis get their mean: a stop then leaves the skew as it is, and the mean, which
// the guard proves, brakes as the machine file states. Before they are homed one may move alone.
static inline void axg_level(const axg_joints* joints, double speed[], bool are_homed) {
    for (int axis = 0; are_homed && axis < joints->axes; ++axis) {
        const double mean = axg_mean_of(joints, speed, axis);
        speed[joints->first[axis]] = speed[joints->second[axis]] = mean;
    }
}

#endif
