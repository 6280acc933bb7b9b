// SPDX-License-Identifier: GPL-2.0-or-later
// HAL component, userspace: passes the sample of every servo period from axguard_stop to the guard
// (libaxguard) in this process, and the guard's frames back. If it is killed, no later permit
// arrives: the realtime component counts the last one down by itself.
// With --bus the guard is axguardd on another computer. Options: axguard-hal.1.
#include <axguard.h>
#include <hal.h>
#include <inttypes.h>
#include <rtapi.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "firmware_if/linuxcnc/axguard_bus.h"
#include "firmware_if/linuxcnc/axguard_fit.h"
#include "firmware_if/linuxcnc/axguard_record.h"
#include "firmware_if/linuxcnc/axguard_show.h"
#include "firmware_if/linuxcnc/axguard_units.h"
#include "firmware_if/linuxcnc/axguard_wire.h"

#define IDLE_NS 50000   // between two looks at an empty stream
#define ARM_US 5000000  // so long a person's arming waits for the guard to be ready
#define TEXT_BYTES 8192
#define SAMPLES_A_CYCLE 16  // after a delay: the guard's queue has room for their frames

typedef struct hal_pins {
    hal_s32_t* phase;
    hal_u32_t *level, *samples, *cap, *pair;
    hal_u32_t *permits, *stops, *late, *samples_lost;
    hal_float_t *clearance, *needed;
    hal_bit_t *armed, *proven;
    hal_s32_t* program_line;
} hal_pins;

// How much of the stop in force was explained; rest may add a way out.
typedef enum explained { EXPLAINED_NOTHING = 0, EXPLAINED_STOP, EXPLAINED_REST } explained;

typedef struct host {
    int comp_id;
    hal_pins* pins;
    hal_stream_t samples, frames;
    axg_guard* guard;
    axg_terms terms;
    axg_state state;
    axg_phase phase_said;
    bool has_said;
    explained explained;
    axg_stop stop;             // in force
    double unit_mm, unit_deg;  // the units of LinuxCNC's pins
    uint16_t tool;             // whose length was sent
    bool has_tool;
    uint32_t lines_said;
    int32_t program_line;  // of the stop
    bool was_armed;        // before the stop
    int64_t sample_us;     // the machine's time: of the newest sample
    int64_t arrived_ns;    // the host's time when it came
    int64_t now_us;
    uint32_t arms;
    bool has_arms, wants_reset;
    bool is_simulation;  // no time passes between two samples: the servo thread waits for the guard
    int64_t arm_until_us;   // 0: nobody arms
    const char* interface;  // of the bus to the guard; null: it is in this process
    axg_bus bus;
    bool is_lost, is_refused;  // a frame was not sent; the last sample was none of this machine
    FILE* record;              // of the samples; null: none
} host;

static volatile sig_atomic_t ends;

static void end(int signal_number) {
    (void)signal_number;
    ends = 1;
}

static int64_t host_ns(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

// The clock of the guard is that of the servo thread: between two samples it goes on with the host,
// and never beyond the next sample.
static int64_t now_us(host* host) {
    const int64_t since_us = (host_ns() - host->arrived_ns) / 1000;
    const int64_t most_us = host->is_simulation ? 0 : (int64_t)host->terms.period_us - 1;
    const int64_t now = host->sample_us + (since_us < most_us ? since_us : most_us);
    host->now_us = now > host->now_us ? now : host->now_us;
    return host->now_us;
}

// --- To the realtime component ----------------------------------------------------------------

static bool send(host* host, uint32_t kind, uint32_t length, uint32_t id, const uint8_t data[8],
                 double value) {
    union hal_stream_data message[HAL_STREAM_MAX_PINS];
    memset(message, 0, sizeof message);
    message[0].u = kind | length << 8 | id << 16;
    memcpy(&message[1].u, data, 4);
    memcpy(&message[2].u, data + 4, 4);
    message[3].f = value;
    return hal_stream_write(&host->frames, message) == 0;
}

static void send_done(host* host, uint64_t number) {
    uint8_t data[8];
    memcpy(data, &number, sizeof data);
    const bool is_ready =
        host->state.phase == AXG_PHASE_READY || host->state.phase == AXG_PHASE_ARMED;
    send(host, AXG_WIRE_DONE, is_ready ? 1 : 0, 0, data, 0);
}

// mm or degrees of the guard in one unit of the joint's pins.
static double unit_of(const host* host, uint32_t joint) {
    return host->terms.axes[joint].is_rotary != 0 ? host->unit_deg : host->unit_mm;
}

static bool send_options(host* host) {
    const axg_terms* const terms = &host->terms;
    const uint8_t none[8] = {0};
    double option[AXG_WIRE_OPTIONS];
    memset(option, 0, sizeof option);
    option[AXG_WIRE_PERIOD_US] = terms->period_us;
    option[AXG_WIRE_JITTER_US] = terms->jitter_us;
    option[AXG_WIRE_REACTION_US] = terms->reaction_us;
    option[AXG_WIRE_SAMPLES_MAX] = terms->permit_samples_max;
    option[AXG_WIRE_AXES] = terms->axis_count;
    option[AXG_WIRE_PERMIT_ID] = terms->permit_id;
    option[AXG_WIRE_STOP_ID] = terms->stop_id;
    option[AXG_WIRE_HASHES_ID] = terms->hashes_out_id;
    option[AXG_WIRE_HASHES_IN_ID] = terms->hashes_in_id;
    option[AXG_WIRE_TOOL] = terms->first_tool;
    option[AXG_WIRE_LENGTH_UNIT] = host->unit_mm;
    for (uint32_t i = 0; i < AXG_HASH_PARTS; ++i) {
        option[AXG_WIRE_HASH + i] = terms->hashes[i];
    }
    for (uint32_t i = 0; i < terms->axis_count; ++i) {
        const double unit = unit_of(host, i);
        option[AXG_WIRE_UNIT + i] = unit;
        option[AXG_WIRE_STOPPING + i] = terms->axes[i].stopping / unit;
        option[AXG_WIRE_JOG_SPEED + i] = terms->axes[i].jog_speed / unit;
        option[AXG_WIRE_JOG_ACCELERATION + i] = terms->axes[i].jog_acceleration / unit;
        option[AXG_WIRE_SKEW + i] = (double)terms->axes[i].skew_mm / unit;
    }
    bool is_sent = true;
    for (uint32_t i = 0; i < AXG_WIRE_OPTIONS; ++i) {
        is_sent = is_sent && send(host, AXG_WIRE_OPTION, i, 0, none, option[i]);
    }
    return is_sent && send(host, AXG_WIRE_BEGIN, 0, 0, none, 0);
}

// --- The guard --------------------------------------------------------------------------------

static const char* phase_name(axg_phase phase) {
    static const char* const names[] = {"stopped", "init", "selftest", "ready", "armed"};
    return names[phase];
}

// To LinuxCNC's operator, by the realtime component: a display shows what motmod passes on.
static void show_operator(host* host, const char* text) {
    uint8_t data[AXG_WIRE_TEXT_BYTES] = {0};
    memcpy(data, text, strnlen(text, sizeof data - 1));
    for (uint32_t i = 0; i < AXG_WIRE_TEXT_BYTES / 8 && (i == 0 || data[8 * i - 1] != 0); ++i) {
        send(host, AXG_WIRE_TEXT, i, 0, &data[8 * i], 0);
    }
    send(host, AXG_WIRE_SHOW, 0, 0, data, 0);
}

// Prints the lines of the stop that were not printed yet; `head` is before the first.
static void print_stop(host* host, const char* head, bool is_for_operator) {
    const char* line = host->stop.text;
    for (uint32_t i = 0; i < host->lines_said; ++i) {
        line += strcspn(line, "\n");
        line += *line != '\0' ? 1 : 0;
    }
    if (is_for_operator && *line != '\0') {
        show_operator(host, line);
    }
    for (; *line != '\0'; head = "  ") {
        const size_t length = strcspn(line, "\n");
        fprintf(stderr, "%s%.*s\n", head, (int)length, line);
        line += length + (line[length] != '\0' ? 1 : 0);
    }
    host->lines_said = host->stop.line_count;
}

// Explains a stop when it comes, and once more at rest, where a way out may be known.
static void explain(host* host, const char* head) {
    const axg_state* const state = &host->state;
    if (state->phase != AXG_PHASE_STOPPED || host->interface != NULL) {
        host->explained = EXPLAINED_NOTHING;
        host->lines_said = 0;
        host->stop.pair = AXG_NO_PAIR;
        host->was_armed = state->phase == AXG_PHASE_ARMED;
        return;
    }
    const explained wanted = state->is_confirmed != 0 ? EXPLAINED_REST : EXPLAINED_STOP;
    if (host->explained >= wanted) {
        return;
    }
    if (host->explained == EXPLAINED_NOTHING) {
        host->program_line = *host->pins->program_line;
    }
    host->explained = wanted;
    if (axg_guard_explain(host->guard, host->program_line, &host->stop) == AXG_STATUS_OK) {
        // A guard that was not armed stops at each start, before the joints are homed.
        print_stop(host, head, host->was_armed || host->stop.line_count > 1);
    }
}

static void say(host* host) {
    const axg_state* const state = &host->state;
    char head[64];
    snprintf(head, sizeof head, "axguard-hal: %" PRId64 " us: ", host->now_us);
    const bool is_new = !host->has_said || state->phase != host->phase_said;
    host->has_said = true;
    host->phase_said = state->phase;
    if (is_new && (state->phase != AXG_PHASE_STOPPED || host->interface != NULL)) {
        fprintf(stderr, "%s%s\n", head, phase_name(state->phase));
    }
    explain(host, head);
}

static void show(host* host) {
    const axg_state* const state = &host->state;
    hal_pins* const pins = host->pins;
    *pins->phase = (int32_t)state->phase;
    *pins->armed = state->phase == AXG_PHASE_ARMED;
    *pins->proven = state->proof.is_proven != 0;
    *pins->level = state->proof.level;
    *pins->samples = state->proof.samples;
    *pins->cap = state->proof.cap;
    *pins->permits = (uint32_t)state->permits;
    *pins->stops = (uint32_t)state->stops;
    *pins->late = (uint32_t)state->late;
    *pins->samples_lost = (uint32_t)state->samples_lost;
    say(host);
    const bool is_stop = host->stop.pair != AXG_NO_PAIR;  // of its pair, until the reset
    *pins->pair = is_stop ? host->stop.pair : state->proof.pair;
    *pins->clearance = is_stop ? host->stop.clearance_mm : state->proof.clearance_mm;
    *pins->needed = is_stop ? host->stop.needed_mm : state->proof.needed_mm;
}

// A person's arming had no effect: why, and what leads out of a stop.
static void refuse(host* host) {
    char text[TEXT_BYTES];
    const axg_state* const state = &host->state;
    axg_guard_explain(host->guard, host->program_line, &host->stop);
    if (state->refused[0] == '\0' && state->proof.is_proven == 0) {
        const char* const pair = axg_guard_pair_name(host->guard, state->proof.pair);
        snprintf(text, sizeof text,
                 "not armed: no permit here: %s (%s%s%s); jog another way, or move by hand\n",
                 state->proof.withheld, state->proof.reason, pair[0] != '\0' ? ": " : "", pair);
    } else {
        snprintf(text, sizeof text, "not armed: %s\n%s%s", state->refused, host->stop.text,
                 host->stop.line_count != 0 ? "\n" : "");
    }
    show_operator(host, text);
    fprintf(stderr, "axguard-hal: %s", text);
    host->lines_said = host->stop.line_count;
}

// A person's one act resets a stop, where there is one, and arms when the guard is ready.
static void arm(host* host) {
    if (host->arm_until_us == 0) {
        return;
    }
    if (host->state.phase == AXG_PHASE_STOPPED && host->wants_reset) {
        axg_guard_notify(host->guard, AXG_EVENT_RESET, now_us(host));
    } else if (host->state.phase == AXG_PHASE_READY) {
        axg_guard_notify(host->guard, AXG_EVENT_ARM, now_us(host));
    } else {
        host->wants_reset = host->wants_reset && host->state.phase == AXG_PHASE_STOPPED;
    }
    if (host->state.phase == AXG_PHASE_ARMED || host->now_us >= host->arm_until_us) {
        if (host->state.phase != AXG_PHASE_ARMED) {
            refuse(host);
        }
        host->arm_until_us = 0;
    }
}

// Everything that is due.
static axg_status cycle(host* host) {
    bool has_sent = true;
    while (has_sent) {
        axg_status status = axg_guard_process(host->guard, now_us(host), &host->state);
        if (status == AXG_STATUS_OK && host->state.has_query) {
            status = axg_guard_evaluate(host->guard);
            if (status == AXG_STATUS_OK) {
                status = axg_guard_process(host->guard, now_us(host), &host->state);
            }
        }
        if (status != AXG_STATUS_OK) {
            return status;
        }
        axg_frame frame;
        for (has_sent = false; axg_guard_next_tx_frame(host->guard, &frame) == AXG_STATUS_OK;
             has_sent = true) {
            if (send(host, AXG_WIRE_FRAME, frame.length_bytes, frame.id, frame.data, 0)) {
                frame.flags |= AXG_FRAME_OWN;  // one that did not get through stops the guard
                axg_guard_receive(host->guard, &frame);
            }
        }
    }
    arm(host);
    return AXG_STATUS_OK;
}

// Forwards the guard's frames from the bus, sends a person's orders, and updates the phase.
static void exchange(host* host) {
    const int64_t host_us = host_ns() / 1000;
    axg_frame frame;
    while (axg_bus_receive(&host->bus, host_us, &frame)) {
        send(host, AXG_WIRE_FRAME, frame.length_bytes, frame.id, frame.data, 0);
    }
    axg_bus_arm(&host->bus, host_us);
    host->state.phase = axg_bus_phase(&host->bus, host_us);
}

static void put_on_bus(host* host, const axg_frame* frame) {
    if (!axg_bus_send(&host->bus, frame) && !host->is_lost) {
        host->is_lost = true;
        fprintf(stderr, "axguard-hal: %s: a frame was not sent\n", host->interface);
    }
}

// False: not a sample of this machine.
static bool give(host* host, const axg_sample* sample) {
    if (host->interface == NULL && host->record == NULL) {
        return axg_guard_put_sample(host->guard, sample, now_us(host)) == AXG_STATUS_OK;
    }
    axg_frame frames[AXG_SAMPLE_FRAMES_MAX];
    uint32_t count = 0;
    if (axg_guard_encode_sample(host->guard, sample, frames, AXG_SAMPLE_FRAMES_MAX, &count) !=
        AXG_STATUS_OK) {
        return false;
    }
    bool is_given = true;
    for (uint32_t i = 0; i < count; ++i) {
        axg_record_frame(host->record, sample, &frames[i]);
        if (host->interface != NULL) {
            put_on_bus(host, &frames[i]);
        } else {  // as axg_guard_put_sample, which encodes no sample twice
            frames[i].time_us = i == 0 ? frames[i].time_us : now_us(host);
            is_given = axg_guard_receive(host->guard, &frames[i]) == AXG_STATUS_OK && is_given;
        }
    }
    return is_given;
}

static void take_hash(host* host, const union hal_stream_data record[]) {
    if (record[5].u == 0) {
        return;
    }
    axg_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.time_us = host->now_us;
    frame.id = host->terms.hashes_in_id;
    frame.length_bytes = 8;
    memcpy(frame.data, &record[6].u, 4);
    memcpy(frame.data + 4, &record[7].u, 4);
    if (host->interface != NULL) {
        put_on_bus(host, &frame);
    } else {
        axg_guard_receive(host->guard, &frame);
    }
}

static uint64_t number_of(const union hal_stream_data record[]) {
    return record[0].u | (uint64_t)record[1].u << 32;
}

static void take_sample(host* host, const union hal_stream_data record[]) {
    axg_sample sample;
    memset(&sample, 0, sizeof sample);
    sample.number = number_of(record);
    sample.latched_us = (int64_t)(sample.number * host->terms.period_us);
    sample.axis_count = host->terms.axis_count;
    sample.nonce = record[2].u;
    sample.mode = (uint8_t)(record[3].u & 0xFFU);
    sample.flags = (uint8_t)(record[3].u >> 8 & 0xFFU);
    sample.tool = (uint16_t)(record[3].u >> 16);
    for (uint32_t i = 0; i < sample.axis_count; ++i) {
        sample.position[i] = record[AXG_WIRE_SAMPLE_WORDS + i].f * unit_of(host, i);
    }
    host->sample_us = sample.latched_us;
    host->arrived_ns = host_ns();
    const bool is_refused = !give(host, &sample);
    if (is_refused && host->interface == NULL) {
        axg_guard_notify(host->guard, AXG_EVENT_FRAMES_LOST, host->now_us);
    }
    if (is_refused && !host->is_refused) {
        fprintf(stderr,
                "axguard-hal: a sample does not fit can.format: tool %u (classical: at most 255), "
                "or a position. Load another tool, or state can.format: fd.\n",
                (unsigned)sample.tool);
    }
    host->is_refused = is_refused;
    if (!host->has_tool || sample.tool != host->tool) {
        uint8_t data[8] = {(uint8_t)sample.tool, (uint8_t)(sample.tool >> 8)};
        host->tool = sample.tool;
        host->has_tool = send(host, AXG_WIRE_LENGTH, 0, 0, data,
                              axg_guard_tool_length_mm(host->guard, sample.tool));
    }
    take_hash(host, record);
    if (host->has_arms && record[4].u != host->arms) {
        axg_bus_press(&host->bus, host_ns() / 1000);
        host->arm_until_us = host->now_us + ARM_US;
        host->wants_reset = true;
    }
    host->arms = record[4].u;
    host->has_arms = true;
}

// --- Start and end ----------------------------------------------------------------------------

static bool make_guard(host* host, int count, char** words) {
    static char text[TEXT_BYTES];
    axg_options options = {0};
    axg_show show = {0};
    options.version = AXG_INTERFACE_VERSION;
    options.engine = AXG_ENGINE_OF_MACHINE_FILE;
    options.mode = AXG_MODE_STOPPABLE;
    const char *unit = "nothing", *angle = "nothing";
    for (int i = 1; i < count; ++i) {
        if (strcmp(words[i], "--linear-units") == 0 && i + 1 < count) {
            unit = words[++i];
        } else if (strcmp(words[i], "--angular-units") == 0 && i + 1 < count) {
            angle = words[++i];
        } else if (strcmp(words[i], "--mesh-root") == 0 && i + 1 < count) {
            options.mesh_root = words[++i];
        } else if (strcmp(words[i], "--contact") == 0) {
            options.mode = AXG_MODE_CONTACT;
        } else if (strcmp(words[i], "--simulation") == 0) {
            host->is_simulation = true;
        } else if (strcmp(words[i], "--bus") == 0 && i + 1 < count) {
            host->interface = words[++i];
            options.engine = AXG_ENGINE_CPU;  // only returns the values of the machine file
        } else if (strcmp(words[i], "--record") == 0 && i + 1 < count) {
            host->record = axg_record_open(words[++i]);
        } else if (words[i][0] != '-' && options.machine_file == NULL) {
            options.machine_file = words[i];
        } else if (!axg_show_take(&show, count, words, &i)) {
            fprintf(stderr, "axguard-hal: unknown argument: %s\n", words[i]);
            return false;
        }
    }
    if (options.machine_file == NULL) {
        fprintf(stderr,
                "usage: axguard-hal MACHINE.yaml --linear-units [TRAJ]LINEAR_UNITS "
                "--angular-units [TRAJ]ANGULAR_UNITS [--mesh-root DIR] [--contact] [--simulation] "
                "[--bus CAN] [--record FILE] " AXG_SHOW_USAGE "\n");
        return false;
    }
    host->unit_mm = axg_unit_mm(unit);
    if (host->unit_mm == 0) {
        fprintf(stderr, AXG_UNITS_WORDS, unit);
        return false;
    }
    const axg_status status = axg_guard_create(&options, &host->guard, text, sizeof text);
    if (text[0] != '\0' || status != AXG_STATUS_OK) {
        fprintf(stderr, "axguard-hal: %s\n%s\n", axg_status_text(status), text);
    }
    if (status != AXG_STATUS_OK || axg_guard_terms(host->guard, &host->terms) != AXG_STATUS_OK) {
        return false;
    }
    host->unit_deg = axg_unit_deg(angle);
    if (!axg_is_fit(&host->terms, options.machine_file, angle)) {
        return false;
    }
    if (host->interface != NULL && host->is_simulation) {
        fprintf(stderr, "axguard-hal: --bus without --simulation: another computer has its time\n");
        return false;
    }
    if (host->interface != NULL &&
        !axg_bus_open(&host->bus, host->interface, &host->terms, text, sizeof text)) {
        fprintf(stderr, "axguard-hal: %s\n", text);
        return false;
    }
    return axg_show_open(host->guard, &show, host->interface != NULL);
}

#define NEW_PIN(type, where, name) \
    (fault = fault ? fault : hal_pin_##type##_newf(HAL_OUT, where, host->comp_id, "axguard." name))

static int make_pins(host* host) {
    host->pins = hal_malloc(sizeof *host->pins);
    if (host->pins == NULL) {
        return -1;
    }
    int fault = 0;
    NEW_PIN(s32, &host->pins->phase, "phase");
    NEW_PIN(bit, &host->pins->armed, "armed");
    NEW_PIN(bit, &host->pins->proven, "proven");
    NEW_PIN(float, &host->pins->clearance, "clearance-mm");
    NEW_PIN(float, &host->pins->needed, "needed-mm");
    NEW_PIN(u32, &host->pins->pair, "pair");
    NEW_PIN(u32, &host->pins->level, "level");
    NEW_PIN(u32, &host->pins->samples, "permit-samples");
    NEW_PIN(u32, &host->pins->cap, "cap");
    NEW_PIN(u32, &host->pins->permits, "permits");
    NEW_PIN(u32, &host->pins->stops, "stops");
    NEW_PIN(u32, &host->pins->late, "late");
    NEW_PIN(u32, &host->pins->samples_lost, "samples-lost");
    return fault ? fault
                 : hal_pin_s32_newf(HAL_IN, &host->pins->program_line, host->comp_id,
                                    "axguard.program-line");
}

static int attach(host* host) {
    host->comp_id = hal_init("axguard-hal");
    if (host->comp_id < 0) {
        return host->comp_id;
    }
    int fault = make_pins(host);
    fault = fault ? fault
                  : hal_stream_attach(&host->samples, host->comp_id, AXG_WIRE_SAMPLES_KEY,
                                      AXG_WIRE_SAMPLE_TYPES);
    fault = fault ? fault
                  : hal_stream_attach(&host->frames, host->comp_id, AXG_WIRE_FRAMES_KEY,
                                      AXG_WIRE_FRAME_TYPES);
    if (fault != 0) {
        fprintf(stderr, "axguard-hal: no streams (error %d): loadrt axguard_stop first\n", fault);
    }
    return fault;
}

static axg_status run(host* host) {
    union hal_stream_data record[HAL_STREAM_MAX_PINS];
    unsigned unused = 0;
    axg_status status = AXG_STATUS_OK;
    bool has_started = false;
    const struct timespec idle = {0, IDLE_NS};
    while (!ends && status == AXG_STATUS_OK) {
        uint64_t newest = 0;
        for (int i = 0; i < SAMPLES_A_CYCLE && hal_stream_readable(&host->samples) &&
                        hal_stream_read(&host->samples, record, &unused) == 0;
             ++i) {
            newest = number_of(record);
            if (has_started) {
                take_sample(host, record);
            }
        }
        if (!has_started && newest != 0) {  // those before belong to nobody
            host->now_us = host->sample_us = (int64_t)(newest * host->terms.period_us);
            host->arrived_ns = host_ns();
            status = host->interface != NULL ? AXG_STATUS_OK
                                             : axg_guard_start(host->guard, host->now_us);
            has_started = send_options(host);
        } else if (has_started && host->interface != NULL) {
            exchange(host);
            show(host);
        } else if (has_started && (newest != 0 || now_us(host) >= host->state.next_due_us)) {
            status = cycle(host);
            show(host);
        }
        if (newest != 0) {
            send_done(host, newest);
        } else {
            nanosleep(&idle, NULL);
        }
    }
    return status;
}

int main(int count, char** words) {
    static host host;
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = end;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    host.bus.socket = -1;
    host.state.proof.clearance_mm = host.state.proof.needed_mm = -1;  // no frame of the bus has it
    host.stop.pair = AXG_NO_PAIR;
    if (!make_guard(&host, count, words)) {
        return 1;
    }
    int result = 1;
    if (attach(&host) == 0) {
        hal_ready(host.comp_id);
        const axg_status status = run(&host);
        if (status != AXG_STATUS_OK) {
            fprintf(stderr, "axguard-hal: %s\n", axg_status_text(status));
        }
        result = status == AXG_STATUS_OK ? 0 : 1;
        hal_stream_detach(&host.samples);
        hal_stream_detach(&host.frames);
    }
    if (host.comp_id > 0) {
        hal_exit(host.comp_id);
    }
    axg_bus_close(&host.bus);
    axg_record_close(host.record);
    axg_guard_destroy(host.guard);
    return result;
}
