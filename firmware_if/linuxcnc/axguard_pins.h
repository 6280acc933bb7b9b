// SPDX-License-Identifier: GPL-2.0-or-later
// The HAL pins of axguard_stop: docs/reference/linuxcnc.md.
#ifndef AXG_AXGUARD_PINS_H
#define AXG_AXGUARD_PINS_H

#include <hal.h>
#include <stddef.h>

#include "firmware_if/linuxcnc/axguard_length.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

typedef struct stop_pins {
    hal_float_t* in[AXG_WIRE_JOINTS_MAX];        // joint.N.motor-pos-cmd
    hal_float_t* offset[AXG_WIRE_JOINTS_MAX];    // joint.N.motor-offset
    hal_float_t* out[AXG_WIRE_JOINTS_MAX];       // to the drive
    hal_float_t* position[AXG_WIRE_JOINTS_MAX];  // of the joint, as the guard gets it
    hal_bit_t* homed[AXG_WIRE_JOINTS_MAX];
    hal_bit_t* enable_in[AXG_WIRE_JOINTS_MAX];   // joint.N.amp-enable-out
    hal_bit_t* enable_out[AXG_WIRE_JOINTS_MAX];  // stays on until the ramp has ended
    hal_bit_t *arm, *permit_ok, *feed_inhibit, *estop_ok, *stopping, *spindle_on, *home_unguarded,
        *change_unguarded;
    hal_float_t *adaptive_feed, *length, *length_tolerance;
    hal_bit_t *length_differs, *skewed;
    hal_bit_t *tool_change, *tool_changed, *tool_change_out, *tool_changed_in, *jog, *jog_down;
    hal_s32_t *tool_number, *jog_joint;
    hal_u32_t *mode, *tool, *number, *cause, *refusal, *permits, *left, *simulation_wait_us,
        *unheard, *last_stop, *late;
} stop_pins;

#define NEW_PIN(type, direction, where, ...) \
    (fault = fault ? fault : hal_pin_##type##_newf(direction, where, comp_id, __VA_ARGS__))

// @return  0, or the first fault of HAL
static inline int make_stop_pins(stop_pins* pins, int joints, int comp_id) {
    int fault = 0;
    for (int i = 0; i < joints; ++i) {
        NEW_PIN(float, HAL_IN, &pins->in[i], "axguard-stop.%d.in", i);
        NEW_PIN(float, HAL_IN, &pins->offset[i], "axguard-stop.%d.offset", i);
        NEW_PIN(float, HAL_OUT, &pins->out[i], "axguard-stop.%d.out", i);
        NEW_PIN(float, HAL_OUT, &pins->position[i], "axguard-stop.%d.position", i);
        NEW_PIN(bit, HAL_IN, &pins->homed[i], "axguard-stop.%d.homed", i);
        NEW_PIN(bit, HAL_IN, &pins->enable_in[i], "axguard-stop.%d.enable-in", i);
        NEW_PIN(bit, HAL_OUT, &pins->enable_out[i], "axguard-stop.%d.enable-out", i);
    }
    NEW_PIN(bit, HAL_IN, &pins->arm, "axguard-stop.arm");
    NEW_PIN(bit, HAL_IN, &pins->home_unguarded, "axguard-stop.home-unguarded");
    NEW_PIN(bit, HAL_IN, &pins->spindle_on, "axguard-stop.spindle-on");
    NEW_PIN(bit, HAL_OUT, &pins->permit_ok, "axguard-stop.permit-ok");
    NEW_PIN(bit, HAL_OUT, &pins->feed_inhibit, "axguard-stop.feed-inhibit");
    NEW_PIN(bit, HAL_OUT, &pins->estop_ok, "axguard-stop.estop-ok");
    NEW_PIN(bit, HAL_OUT, &pins->stopping, "axguard-stop.stopping");
    NEW_PIN(float, HAL_OUT, &pins->adaptive_feed, "axguard-stop.adaptive-feed");
    NEW_PIN(bit, HAL_IN, &pins->tool_change, "axguard-stop.tool-change");
    NEW_PIN(bit, HAL_OUT, &pins->tool_changed, "axguard-stop.tool-changed");
    NEW_PIN(bit, HAL_OUT, &pins->tool_change_out, "axguard-stop.tool-change-out");
    NEW_PIN(bit, HAL_IN, &pins->tool_changed_in, "axguard-stop.tool-changed-in");
    NEW_PIN(s32, HAL_IN, &pins->tool_number, "axguard-stop.tool-number");
    NEW_PIN(bit, HAL_IN, &pins->change_unguarded, "axguard-stop.change-unguarded");
    NEW_PIN(float, HAL_IN, &pins->length, "axguard-stop.tool-offset-z");
    NEW_PIN(float, HAL_IN, &pins->length_tolerance, "axguard-stop.tool-length-tolerance");
    NEW_PIN(bit, HAL_OUT, &pins->length_differs, "axguard-stop.tool-length-differs");
    NEW_PIN(bit, HAL_OUT, &pins->skewed, "axguard-stop.skewed");
    NEW_PIN(bit, HAL_IN, &pins->jog, "axguard-stop.jog");
    NEW_PIN(s32, HAL_IN, &pins->jog_joint, "axguard-stop.jog-joint");
    NEW_PIN(bit, HAL_IN, &pins->jog_down, "axguard-stop.jog-down");
    NEW_PIN(u32, HAL_OUT, &pins->mode, "axguard-stop.mode");
    NEW_PIN(u32, HAL_OUT, &pins->tool, "axguard-stop.tool");
    NEW_PIN(u32, HAL_OUT, &pins->number, "axguard-stop.sample");
    NEW_PIN(u32, HAL_OUT, &pins->cause, "axguard-stop.cause");
    NEW_PIN(u32, HAL_OUT, &pins->refusal, "axguard-stop.refusal");
    NEW_PIN(u32, HAL_OUT, &pins->permits, "axguard-stop.permits");
    NEW_PIN(u32, HAL_OUT, &pins->left, "axguard-stop.left-us");
    NEW_PIN(u32, HAL_OUT, &pins->last_stop, "axguard-stop.last-stop-periods");
    NEW_PIN(u32, HAL_OUT, &pins->late, "axguard-stop.late-periods");
    NEW_PIN(u32, HAL_OUT, &pins->unheard, "axguard-stop.simulation-unheard");
    NEW_PIN(u32, HAL_IN, &pins->simulation_wait_us, "axguard-stop.simulation-wait-us");
    if (fault == 0) {
        *pins->length_tolerance = AXG_LENGTH_TOLERANCE_MM;
    }
    return fault;
}

#undef NEW_PIN
#endif
