// SPDX-License-Identifier: GPL-2.0-or-later
// HAL component, realtime, between joint.N.motor-pos-cmd and the drives. While the board library
// permits the axes to move, each joint's command passes. When the permit has ended, each joint is
// brought to rest by its own ramp, even if no other process runs, and the E-stop chain is
// opened. Time is counted in servo periods, so that nothing but this function moves the end.
// Pins and promises: docs/reference/linuxcnc.md.
#include <hal.h>
#include <math.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include "firmware_if/board/axguard_board.h"
#include "firmware_if/linuxcnc/axguard_home.h"
#include "firmware_if/linuxcnc/axguard_jog.h"
#include "firmware_if/linuxcnc/axguard_joints.h"
#include "firmware_if/linuxcnc/axguard_length.h"
#include "firmware_if/linuxcnc/axguard_options.h"
#include "firmware_if/linuxcnc/axguard_period.h"
#include "firmware_if/linuxcnc/axguard_pins.h"
#include "firmware_if/linuxcnc/axguard_ramp.h"
#include "firmware_if/linuxcnc/axguard_tool.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

MODULE_AUTHOR("axguard");
MODULE_DESCRIPTION("Stops each joint by its own ramp when the permit of the guard has ended");
MODULE_LICENSE("GPL");

static int joints = 3;
RTAPI_MP_INT(joints, "number of joints, as the axes of the machine file");
static char* coordinates = "";
RTAPI_MP_STRING(coordinates, "a letter for each joint, equal ones for a gantry: replaces joints");

#define STILL_PERIODS 20  // a hold shorter than this is reported as motion
#define STILL_STEP 1e-8   // mm or degrees a period: what kinematics may add to a position
#define ALIGNED 1e-4      // mm or degrees: LinuxCNC commands the place where the joint is
#define MESSAGES_A_PERIOD 64
#define ARM_PERIODS 5000U  // so long a person's arming waits for rest and for the guard
#define WAIT_STEP_NS 20000

typedef struct stop_state {
    axg_board board;
    double option[AXG_WIRE_OPTIONS];
    uint8_t options_seen[AXG_WIRE_OPTIONS];
    bool has_begun;
    uint64_t count;                      // servo periods: the number of the sample
    uint64_t period_us;                  // as the thread runs
    double at[AXG_WIRE_JOINTS_MAX];      // where the motor was sent: joint and motor offset, in the
                                         // unit of the pins
    double speed[AXG_WIRE_JOINTS_MAX];   // per second
    double before[AXG_WIRE_JOINTS_MAX];  // speed of the period before
    bool has_at, has_places, has_tool;
    uint32_t off;         // periods since the drives were switched off; 0: they are on
    bool levels;          // what passed last passed by a permit
    bool is_synchronous;  // what is commanded passes without a jump
    bool is_ramping, is_latched;
    uint32_t still, ramp_periods;
    bool arm_before;
    uint32_t arms, arm_left, nonce;
    bool guard_is_ready;  // it sends no stop frame any more: a board armed before would stop again
    uint8_t hashes_wanted;
    axg_home home;
    axg_tool tool;
    axg_length length;
    bool is_jog, jogs_down;  // as the samples report it
    int jog_joint;
    uint64_t done;     // last sample with all replies received
    bool waits;        // simulation-wait-us: a guard replies
    int64_t clock_ns;  // of the host, when this period began
    axg_period period;
    char text[AXG_WIRE_TEXT_BYTES + 1];  // for the operator
} stop_state;

static int comp_id;
static stop_pins* pins;
static stop_state state;
static axg_joints map;
static hal_stream_t samples_out, frames_in;

static uint64_t now_us(void) {
    return state.count * state.period_us;
}

// A distance in mm or degrees, in the unit of the joint's pins.
static double in_pins(double distance, int joint) {
    const double unit = state.option[AXG_WIRE_UNIT + map.axis[joint]];
    return unit > 0 ? distance / unit : distance;  // before the guard states it: as if it were mm
}

// --- What comes from the guard ----------------------------------------------------------------

static void begin(void) {
    const bool is_complete = memchr(state.options_seen, 0, sizeof state.options_seen) == NULL;
    memset(state.options_seen, 0, sizeof state.options_seen);
    const axg_board_options options = axg_options_from(state.option);
    const bool brakes = axg_brakes(&map, state.option);
    const bool is_ours = options.period_us == state.period_us && options.axis_count == map.axes;
    state.nonce = (uint32_t)((uint64_t)rtapi_get_time() >> 4) & AXG_BOARD_NONCE_MAX;
    const bool is_up = axg_board_power_up(&state.board, &options, state.nonce, now_us());
    axg_board_moves(&state.board, state.still < STILL_PERIODS, now_us());
    state.has_begun = is_complete && brakes && is_ours && is_up;
    if (!state.has_tool) {  // a guard that starts again changes no tool
        state.tool.number = (uint16_t)state.option[AXG_WIRE_TOOL];
        state.has_tool = is_complete;
    }
    state.tool.step = AXG_TOOL_NONE;
    axg_length_begin(&state.length, state.tool.number);
    state.hashes_wanted = 0;
    state.arm_left = 0;
    state.guard_is_ready = false;
    state.is_jog = false;
    if (!state.has_begun) {
        rtapi_print_msg(RTAPI_MSG_ERR, AXG_FIT_WORDS, options.axis_count, options.period_us,
                        map.axes, (unsigned)state.period_us);
    }
}

static void take_frame(uint32_t head, uint32_t low, uint32_t high) {
    axg_board_can_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.id = head >> 16;
    frame.length = (uint8_t)((head >> 8) & 0xFFU);
    memcpy(&frame.data[0], &low, 4);
    memcpy(&frame.data[4], &high, 4);
    const axg_board_heard heard = axg_board_frame(&state.board, &frame, now_us());
    if (heard == AXG_BOARD_HEARD_HASH || heard == AXG_BOARD_HEARD_HASH_DIFFERS) {
        state.hashes_wanted |= (uint8_t)(1U << frame.data[0]);
    }
}

static void take_message(const union hal_stream_data* message) {
    const uint32_t head = message[0].u;
    const uint32_t index = (head >> 8) & 0xFFU;
    switch (head & 0xFFU) {
        case AXG_WIRE_FRAME:
            if (state.has_begun) {
                take_frame(head, message[1].u, message[2].u);
            }
            break;
        case AXG_WIRE_OPTION:
            if (index < AXG_WIRE_OPTIONS) {
                state.option[index] = message[3].f;
                state.options_seen[index] = 1;
            }
            break;
        case AXG_WIRE_BEGIN:
            begin();
            break;
        case AXG_WIRE_DONE:
            state.done = message[1].u | (uint64_t)message[2].u << 32;
            state.waits = true;
            state.guard_is_ready = index != 0;
            break;
        case AXG_WIRE_LENGTH:
            axg_length_take(&state.length, message[1].u, message[3].f);
            break;
        case AXG_WIRE_TEXT:
            if (index < AXG_WIRE_TEXT_BYTES / 8) {
                memcpy(&state.text[8 * index], &message[1].u, 4);
                memcpy(&state.text[8 * index + 4], &message[2].u, 4);
            }
            break;
        case AXG_WIRE_SHOW:  // motmod passes messages of this level on to LinuxCNC's operator
            rtapi_print_msg(RTAPI_MSG_ERR, "axguard: %s\n", state.text);
            break;
        default:
            break;
    }
}

static bool take_messages(void) {
    union hal_stream_data message[HAL_STREAM_MAX_PINS];
    unsigned number = 0;
    int taken = 0;
    while (taken < MESSAGES_A_PERIOD && hal_stream_readable(&frames_in) &&
           hal_stream_read(&frames_in, message, &number) == 0) {
        take_message(message);
        ++taken;
    }
    return taken != 0;
}

// In a simulation no time passes while the guard computes: the servo thread of a host without real
// time would run on without it. Never in a machine: the pin is 0 then, and nothing waits.
static void wait_for_the_guard(void) {
    const int64_t limit_ns = (int64_t)*pins->simulation_wait_us * 1000;
    int64_t waited_ns = 0;
    while (state.waits && state.count > 1 && state.done + 1 < state.count && waited_ns < limit_ns) {
        if (!take_messages()) {
            const struct timespec step = {0, WAIT_STEP_NS};
            nanosleep(&step, NULL);
            waited_ns += WAIT_STEP_NS;
        }
    }
    if (limit_ns != 0 && waited_ns >= limit_ns) {
        state.waits = false;  // no guard replies: wait again after a reply
        ++*pins->unheard;
    }
}

// --- Arming, and a tool change ----------------------------------------------------------------

static void arm(void) {
    const bool is_asked = *pins->arm && !state.arm_before;
    state.arm_before = *pins->arm;
    if (is_asked && state.has_begun) {
        ++state.arms;
        state.arm_left = ARM_PERIODS;
    }
    if (state.arm_left == 0) {
        return;
    }
    --state.arm_left;
    if (!state.guard_is_ready || !state.period.is_shown || axg_tool_is_unguarded(&state.tool)) {
        return;
    }
    const uint32_t step = (uint32_t)(rtapi_get_time() & 0xFFFF) | 1U;
    state.nonce = (state.nonce + step) & AXG_BOARD_NONCE_MAX;
    if (axg_board_arm(&state.board, state.nonce, now_us()) == AXG_BOARD_ARMING_DONE) {
        state.arm_left = 0;
        state.is_latched = false;
        axg_tool_on_armed(&state.tool);
    }
}

// A person selects one joint and one way, at rest. In motion another selection is a stop, and has
// an effect from the next rest on. Without the promise of the machine file it changes nothing.
static void select_jog(void) {
    const int joint = *pins->jog_joint;
    const bool is_one = joint >= 0 && joint < joints && state.has_begun &&
                        state.option[AXG_WIRE_JOG_SPEED + map.axis[joint]] > 0;
    const bool is_jog = *pins->jog && is_one && state.tool.step == AXG_TOOL_NONE;
    const bool is_other =
        is_jog && (joint != state.jog_joint || *pins->jog_down != state.jogs_down);
    if (is_jog == state.is_jog && !is_other) {
        return;
    }
    axg_board_change(&state.board, is_jog, now_us());
    if (state.still >= STILL_PERIODS) {
        state.is_jog = is_jog;
        state.jog_joint = is_one ? joint : 0;
        state.jogs_down = *pins->jog_down;
    }
}

// The key leads out of a stop that forbids the change, and of an E-stop in that stop: LinuxCNC is
// switched on for its tool change, and a command that moves a joint opens the chain again.
static void change_tool(bool may_move) {
    const bool rests = state.has_begun && state.still >= STILL_PERIODS;
    if (axg_tool_turn_key(&state.tool, &state.board, *pins->change_unguarded, rests)) {
        state.is_latched = false;
    }
    if (state.is_jog) {
        return;
    }
    const axg_tool_pins change = {*pins->tool_change, *pins->tool_changed_in, *pins->tool_number};
    axg_tool_advance(&state.tool, &state.board, &change, may_move, now_us());
    *pins->tool_change_out = axg_tool_is_out(&state.tool);
    *pins->tool_changed = state.tool.step == AXG_TOOL_DONE;
}

// --- Motion -----------------------------------------------------------------------------------

// @param bits  a pin of each joint
static bool are_set(hal_bit_t* const bits[]) {
    int count = 0;
    while (count < joints && *bits[count]) {
        ++count;
    }
    return count == joints;
}

static bool is_homed(void) {
    return are_set(pins->homed);
}

// Reads LinuxCNC's commands. True: they agree with the places of the joints. Switched off, LinuxCNC
// commands what it measures: from there the joints go on when it is switched on after a rest.
static bool read_commands(double wanted[]) {
    const bool is_on = are_set(pins->enable_in);
    const bool is_on_again = is_on && state.off >= STILL_PERIODS && !state.is_ramping;
    const bool is_new = !state.has_at || is_on_again;
    bool is_aligned = true;
    state.has_places = true;
    for (int i = 0; i < joints; ++i) {
        const bool is_place = axg_ramp_is_place(*pins->in[i]);
        wanted[i] = is_place ? *pins->in[i] : state.at[i];
        if (is_new) {
            state.at[i] = wanted[i];
        }
        state.has_places = state.has_places && is_place;
        is_aligned = is_aligned && fabs(wanted[i] - state.at[i]) <= in_pins(ALIGNED, i);
    }
    state.has_at = true;
    state.off = is_on ? 0 : (state.off < STILL_PERIODS ? state.off + 1 : state.off);
    return is_aligned && state.has_places;
}

static void turn_home_key(void) {
    const bool wants = state.has_begun && !is_homed() && !axg_tool_is_unguarded(&state.tool);
    const bool opens = axg_home_turn_key(&state.home, &state.board, *pins->home_unguarded, wants,
                                         state.still >= STILL_PERIODS, now_us());
    state.is_latched = state.is_latched && !opens;
}

static bool pass(const double wanted[], double period_s) {
    bool moves = false;
    for (int i = 0; i < joints; ++i) {
        const double step = wanted[i] - state.at[i];
        state.speed[i] = step / period_s;
        state.at[i] = wanted[i];
        moves = moves || fabs(step) > in_pins(STILL_STEP, i);
    }
    return moves;
}

static axg_jog jog_of(void) {
    const int axis = map.axis[state.jog_joint];
    axg_jog jog = {.joint = state.jog_joint,
                   .goes_down = state.jogs_down,
                   .speed = state.option[AXG_WIRE_JOG_SPEED + axis],
                   .acceleration = state.option[AXG_WIRE_JOG_ACCELERATION + axis]};
    for (int i = 0; i < joints; ++i) {
        jog.aligned[i] = in_pins(ALIGNED, i);
    }
    return jog;
}

// Whether two joints of one axis are farther apart than the proof allows, as LinuxCNC commands them
// or as they were sent. Before both are homed nobody knows.
static bool is_skewed(void) {
    double commanded[AXG_WIRE_JOINTS_MAX], at[AXG_WIRE_JOINTS_MAX];
    for (int i = 0; i < joints; ++i) {
        commanded[i] = *pins->in[i] - *pins->offset[i];
        at[i] = state.at[i] - *pins->offset[i];
    }
    const double* const skew = &state.option[AXG_WIRE_SKEW];
    const int first = state.has_at ? axg_skewed_axis(&map, at, skew) : -1;
    const int axis = first >= 0 ? first : axg_skewed_axis(&map, commanded, skew);
    const bool was = *pins->skewed;
    *pins->skewed = axis >= 0 && state.has_begun && is_homed();
    if (*pins->skewed && !was) {
        rtapi_print_msg(RTAPI_MSG_ERR, AXG_SKEW_WORDS, map.first[axis], map.second[axis],
                        axg_skew_of(&map, first >= 0 ? at : commanded, axis), skew[axis]);
    }
    return *pins->skewed;
}

// Whether axes may move: the board's permit, for the tool that LinuxCNC has too. In motion a wrong
// length or a skew is a stop; at rest it withholds the permit until it is corrected.
static axg_board_motion may_move(void) {
    const bool differed = state.length.differs;
    const double unit_mm = state.option[AXG_WIRE_LENGTH_UNIT];
    const double offset_mm = *pins->length * unit_mm;
    const double tolerance_mm = *pins->length_tolerance;
    const bool differs =
        axg_length_compare(&state.length, state.tool.number, offset_mm, tolerance_mm);
    if (differs && !differed) {
        rtapi_print_msg(RTAPI_MSG_ERR, AXG_LENGTH_WORDS, (unsigned)state.tool.number, offset_mm,
                        state.length.file_mm, tolerance_mm);
    }
    const bool skewed = is_skewed();
    if ((differs || skewed) && axg_ramp_is_fast(&map, state.speed)) {
        axg_board_stop(&state.board, now_us());
    }
    axg_board_motion motion = axg_board_may_move(&state.board, now_us());
    motion.may_move = motion.may_move && !differs && !skewed;
    return motion;
}

// One period of a stop.
static bool ramp(double period_s) {
    if (!state.is_ramping) {
        axg_ramp_begin(&map, state.speed, state.before, state.levels && is_homed());
    }
    state.ramp_periods = state.is_ramping ? state.ramp_periods + 1 : 1;
    state.is_ramping =
        axg_ramp_step(&map, state.at, state.speed, &state.option[AXG_WIRE_STOPPING], period_s);
    state.is_latched = true;
    state.is_synchronous = false;
    state.arm_left = 0;  // a person arms after it
    *pins->last_stop = state.ramp_periods;
    return state.is_ramping;
}

// Moves the joints for one period. Without permission a joint in motion is brought to rest, and
// one at rest stays; a command that leaves it then opens the E-stop chain. Where LinuxCNC has
// switched the drives off, they stop the joints.
static void move(bool may_pass, const double wanted[], bool is_aligned, double period_s) {
    bool moves = false;
    if (state.off != 0 && !state.is_ramping) {
        may_pass = false;
        memset(state.speed, 0, sizeof state.speed);
        is_aligned = true;
    }
    const axg_jog jog = jog_of();
    if (may_pass && state.is_synchronous && state.is_jog &&
        !axg_jog_keeps(&jog, &map, wanted, state.at, state.speed, period_s)) {
        axg_board_stop(&state.board, now_us());
        may_pass = false;
        state.is_latched = true;
    }
    if (may_pass && state.is_synchronous) {
        memcpy(state.before, state.speed, sizeof state.before);
        state.levels = !state.home.is_open;
        if (state.is_jog) {
            memset(state.speed, 0, sizeof state.speed);
            moves = axg_jog_pass(&jog, &map, in_pins(STILL_STEP, jog.joint), wanted, state.at,
                                 state.speed, period_s);
        } else {
            moves = pass(wanted, period_s);
        }
    } else if (state.is_ramping || axg_ramp_is_fast(&map, state.speed)) {
        moves = ramp(period_s);
    } else {
        state.is_latched = state.is_latched || !is_aligned;
        state.is_synchronous = is_aligned;
    }
    if (!moves) {
        memset(state.speed, 0, sizeof state.speed);
    }
    state.still = moves ? 0 : (state.still < STILL_PERIODS ? state.still + 1 : state.still);
}

// --- One servo period -------------------------------------------------------------------------

static void send_sample(void) {
    union hal_stream_data record[HAL_STREAM_MAX_PINS];
    memset(record, 0, sizeof record);
    axg_board_says says;
    memset(&says, 0, sizeof says);
    says.mode = state.is_jog ? 3 : (state.still < STILL_PERIODS ? 1 : 0);
    says.jogs_down = state.jogs_down;
    says.jog_axis = (uint8_t)map.axis[state.jog_joint];
    if (axg_tool_is_announced(&state.tool)) {
        says.mode = 2;
    }
    says.tool = state.tool.number;
    says.is_homed = is_homed();
    says.is_spindle_on = *pins->spindle_on;
    const uint8_t flags = axg_board_flags(&state.board, &says);
    *pins->mode = says.mode;
    *pins->tool = says.tool;
    record[0].u = (uint32_t)state.count;
    record[1].u = (uint32_t)(state.count >> 32);
    record[2].u = state.board.nonce;
    record[3].u = says.mode | (uint32_t)flags << 8 | (uint32_t)says.tool << 16;
    record[4].u = state.arms;
    for (uint8_t part = 0; part < 4 && record[5].u == 0; ++part) {
        axg_board_can_frame frame;
        const uint32_t id = (uint32_t)state.option[AXG_WIRE_HASHES_IN_ID];
        if ((state.hashes_wanted & (1U << part)) != 0 &&
            axg_board_encode_hash(&state.board, id, part, &frame)) {
            state.hashes_wanted &= (uint8_t) ~(1U << part);
            record[5].u = 1;
            memcpy(&record[6].u, &frame.data[0], 4);
            memcpy(&record[7].u, &frame.data[4], 4);
        }
    }
    double position[AXG_WIRE_JOINTS_MAX];
    for (int i = 0; i < joints; ++i) {
        *pins->position[i] = position[i] = state.at[i] - *pins->offset[i];
    }
    for (int axis = 0; axis < map.axes; ++axis) {
        record[AXG_WIRE_SAMPLE_WORDS + axis].f = axg_mean_of(&map, position, axis);
    }
    hal_stream_write(&samples_out, record);  // a full stream loses the sample: its number shows it
}

static void show(const axg_board_motion* motion) {
    const bool may_pass = motion->may_move && !state.is_latched;
    *pins->permit_ok = may_pass;
    *pins->feed_inhibit = !may_pass || state.is_jog;  // a program does not run in a jog
    *pins->adaptive_feed =
        motion->may_move ? motion->ordered.of[0] / (double)AXG_BOARD_CAP_NONE : 1;
    *pins->length_differs = state.length.differs;
    *pins->stopping = state.is_ramping;
    *pins->estop_ok = !state.is_latched || state.is_ramping;
    *pins->number = (uint32_t)state.count;
    *pins->cause = state.board.phase == AXG_BOARD_STOPPED ? (uint32_t)state.board.cause : 0;
    *pins->refusal = (uint32_t)state.board.last_refusal;
    *pins->permits = state.board.permits;
    *pins->left = motion->may_move ? (uint32_t)(motion->end_us - now_us()) : 0;
    for (int i = 0; i < joints; ++i) {
        *pins->out[i] = state.at[i];
        *pins->enable_out[i] = *pins->enable_in[i] || state.is_ramping;
    }
}

// The end of a permit is counted in periods: a period that comes late makes it late by as much.
// Half a period is within the reaction of the machine file; more is a stop.
static void check_clock(long period_ns) {
    const int64_t before_ns = state.clock_ns;
    state.clock_ns = rtapi_get_time();
    const bool is_late = state.clock_ns - before_ns > (int64_t)period_ns + period_ns / 2;
    if (before_ns != 0 && is_late && *pins->simulation_wait_us == 0) {
        ++*pins->late;
        state.period.has_windows = false;
        axg_board_stop(&state.board, now_us());
    }
}

// Periods have no length while the thread waits for the guard (simulation).
static void check_period(void) {
    if (*pins->simulation_wait_us != 0) {
        state.period = (axg_period){.is_shown = true};
    } else if (axg_period_note(&state.period, state.count, state.clock_ns, state.period_us)) {
        rtapi_print_msg(RTAPI_MSG_ERR, AXG_PERIOD_WORDS, (long)state.period.measured_ns,
                        (unsigned)state.period_us);
        axg_board_stop(&state.board, now_us());
    }
}

static void update(void* unused, long period_ns) {
    (void)unused;
    double wanted[AXG_WIRE_JOINTS_MAX];
    ++state.count;
    state.period_us = (uint64_t)(period_ns + 500) / 1000;
    check_clock(period_ns);
    check_period();
    take_messages();
    wait_for_the_guard();
    select_jog();
    arm();
    axg_board_motion motion = may_move();
    change_tool(motion.may_move);
    const bool is_aligned = read_commands(wanted);
    turn_home_key();
    if (!state.has_places) {
        axg_board_stop(&state.board, now_us());
    }
    move((motion.may_move || state.home.is_open) && !state.is_latched && state.has_places, wanted,
         is_aligned, (double)period_ns * 1e-9);
    if (!state.home.is_open) {
        axg_board_moves(&state.board, state.still < STILL_PERIODS, now_us());
    }
    if (state.has_begun) {
        axg_board_sample sample;
        sample.latched_us = now_us();
        sample.sync = (uint8_t)(state.count % AXG_BOARD_SYNC_MAX + 1U);
        sample.lap = (uint16_t)(state.count / AXG_BOARD_SYNC_MAX);
        axg_board_latch(&state.board, &sample);
    }
    send_sample();
    motion = may_move();
    show(&motion);
}

// --- Loading ----------------------------------------------------------------------------------

int rtapi_app_main(void) {
    if (!axg_joints_from(&map, coordinates, joints)) {
        rtapi_print_msg(RTAPI_MSG_ERR,
                        "axguard-stop: expected joints=1 to joints=%d, or coordinates= with a "
                        "letter for each, at most twice the same\n",
                        AXG_WIRE_JOINTS_MAX);
        return -1;
    }
    joints = map.count;
    comp_id = hal_init("axguard_stop");
    if (comp_id < 0) {
        return comp_id;
    }
    memset(&state, 0, sizeof state);
    state.still = STILL_PERIODS;
    state.tool.key_before = state.home.key_before = true;
    pins = hal_malloc(sizeof *pins);
    int fault = pins == NULL ? -1 : make_stop_pins(pins, joints, comp_id);
    fault = fault ? fault : hal_export_funct("axguard-stop", update, NULL, 1, 0, comp_id);
    fault = fault ? fault
                  : hal_stream_create(&samples_out, comp_id, AXG_WIRE_SAMPLES_KEY,
                                      AXG_WIRE_SAMPLES_DEPTH, AXG_WIRE_SAMPLE_TYPES);
    if (fault == 0) {
        fault = hal_stream_create(&frames_in, comp_id, AXG_WIRE_FRAMES_KEY, AXG_WIRE_FRAMES_DEPTH,
                                  AXG_WIRE_FRAME_TYPES);
        if (fault != 0) {
            hal_stream_destroy(&samples_out);
        }
    }
    if (fault != 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "axguard-stop: pins or streams: error %d\n", fault);
        hal_exit(comp_id);
        return fault;
    }
    hal_ready(comp_id);
    return 0;
}

void rtapi_app_exit(void) {
    hal_stream_destroy(&frames_in);
    hal_stream_destroy(&samples_out);
    hal_exit(comp_id);
}
