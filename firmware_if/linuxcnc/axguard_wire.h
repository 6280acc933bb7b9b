// SPDX-License-Identifier: GPL-2.0-or-later
// Messages between the realtime and the userspace component, in two HAL streams: a sample of every
// servo period one way, frames of the guard the other way.
#ifndef AXG_AXGUARD_WIRE_H
#define AXG_AXGUARD_WIRE_H

#define AXG_WIRE_JOINTS_MAX 9
#define AXG_WIRE_SAMPLES_KEY 0x41584701
#define AXG_WIRE_FRAMES_KEY 0x41584702
#define AXG_WIRE_SAMPLES_DEPTH 1024
#define AXG_WIRE_FRAMES_DEPTH 512

// A sample: eight words, then a position of each axis in the unit of its pins. Words: number (low,
// high), nonce, mode | flags << 8 | tool << 16, times that a person armed, 1 if a hash follows, its
// bytes.
#define AXG_WIRE_SAMPLE_WORDS 8
#define AXG_WIRE_SAMPLE_TYPES "uuuuuuuufffffffff"

// To the realtime component: kind | length << 8 | id << 16, two words of data, a value.
#define AXG_WIRE_FRAME_TYPES "uuuf"
enum {
    AXG_WIRE_FRAME = 1,   // a frame of the guard
    AXG_WIRE_OPTION = 2,  // `length` names the option, the value is its value
    AXG_WIRE_BEGIN = 3,   // all options were sent: power up
    AXG_WIRE_DONE = 4,    // all replies to the sample with this number were sent; `length`
                          // is 1 when the guard may be armed, or is
    AXG_WIRE_TEXT = 5,    // eight bytes for the operator, at 8 * `length`
    AXG_WIRE_SHOW = 6,    // the text is whole
    AXG_WIRE_LENGTH = 7   // the value is length_mm of the tool of the first word; negative: none
};
#define AXG_WIRE_TEXT_BYTES 512

// Options, in the order of axg_board_options. The last five are the first of AXG_WIRE_JOINTS_MAX
// each, one an axis: mm or degrees in a unit of its pins; then values in that unit, without jogs
// or a gantry 0.
enum {
    AXG_WIRE_PERIOD_US = 0,
    AXG_WIRE_JITTER_US,
    AXG_WIRE_REACTION_US,
    AXG_WIRE_SAMPLES_MAX,
    AXG_WIRE_AXES,
    AXG_WIRE_PERMIT_ID,
    AXG_WIRE_STOP_ID,
    AXG_WIRE_HASHES_ID,
    AXG_WIRE_HASHES_IN_ID,
    AXG_WIRE_HASH,
    AXG_WIRE_TOOL = AXG_WIRE_HASH + 4,
    AXG_WIRE_LENGTH_UNIT,  // mm in a unit of the pins of lengths
    AXG_WIRE_UNIT,
    AXG_WIRE_STOPPING = AXG_WIRE_UNIT + AXG_WIRE_JOINTS_MAX,
    AXG_WIRE_JOG_SPEED = AXG_WIRE_STOPPING + AXG_WIRE_JOINTS_MAX,
    AXG_WIRE_JOG_ACCELERATION = AXG_WIRE_JOG_SPEED + AXG_WIRE_JOINTS_MAX,
    AXG_WIRE_SKEW = AXG_WIRE_JOG_ACCELERATION + AXG_WIRE_JOINTS_MAX,
    AXG_WIRE_OPTIONS = AXG_WIRE_SKEW + AXG_WIRE_JOINTS_MAX
};

#endif
