// SPDX-License-Identifier: Apache-2.0
// The guard inside a C program: guard_a_trace MACHINE.yaml TRACE.log [contact|stoppable] plays a
// candump log (candump -L, classical frames) to it, arms it when it is ready, as soon as the axes
// rest, and prints when and why it stopped. A program on a real bus differs in four places, marked
// BUS.
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <axguard.h>

// "(12.345678) can0 181#0011223344556677": false for any other line.
static bool read_frame(const char* line, axg_frame* out) {
    int64_t seconds = 0;
    int64_t micros = 0;
    char bytes[17] = "";
    memset(out, 0, sizeof *out);
    if (sscanf(line, "(%" SCNd64 ".%6" SCNd64 ") %*15s %3" SCNx32 "#%16[0-9A-Fa-f]", &seconds,
               &micros, &out->id, bytes) < 3) {
        return false;
    }
    out->time_us = seconds * 1000000 + micros;
    for (const char* at = bytes; at[0] != '\0' && at[1] != '\0'; at += 2) {
        unsigned value = 0;
        sscanf(at, "%2x", &value);
        out->data[out->length_bytes++] = (uint8_t)value;
    }
    return true;
}

// The board of a trace is not there to reply: sends back the hash of the guard's own request (ids
// of can.hashes: required).
static void answer_hash(axg_guard* guard, const axg_frame* sent) {
    const uint32_t hashes_out = 0x602;
    const uint32_t hashes_in = 0x582;
    if (sent->id == hashes_out) {
        axg_frame answer = *sent;
        answer.id = hashes_in;
        answer.flags = 0;
        axg_guard_receive(guard, &answer);
    }
}

// Everything that is due at this instant: process, the geometry, and what goes out.
static axg_status cycle(axg_guard* guard, int64_t now_us, axg_state* state) {
    bool has_sent = true;
    while (has_sent) {
        axg_status status = axg_guard_process(guard, now_us, state);
        if (status == AXG_STATUS_OK && state->has_query) {
            status = axg_guard_evaluate(guard);  // BUS: or in a thread of its own
            if (status == AXG_STATUS_OK) {
                // BUS: the time when the result is there
                status = axg_guard_process(guard, now_us, state);
            }
        }
        if (status != AXG_STATUS_OK) {
            return status;
        }
        axg_frame frame;
        for (has_sent = false; axg_guard_next_tx_frame(guard, &frame) == AXG_STATUS_OK;
             has_sent = true) {
            frame.flags |= AXG_FRAME_OWN;  // BUS: send it; here it is on the bus at once
            axg_guard_receive(guard, &frame);
            answer_hash(guard, &frame);  // BUS: this is the board's part, with its own hash
        }
        if (state->phase == AXG_PHASE_READY) {
            axg_guard_notify(guard, AXG_EVENT_ARM, now_us);  // BUS: this is a person's part
        }
    }
    return AXG_STATUS_OK;
}

// Until the guard stops, or the trace ends.
static axg_status play(axg_guard* guard, FILE* trace, axg_state* state) {
    char line[512];
    axg_frame frame;
    bool has_started = false;
    while (fgets(line, sizeof line, trace) != NULL) {
        if (!read_frame(line, &frame)) {
            continue;
        }
        axg_status status = AXG_STATUS_OK;
        if (!has_started) {
            has_started = true;
            status = axg_guard_start(guard, frame.time_us);
            state->next_due_us = frame.time_us;
        }
        while (status == AXG_STATUS_OK && state->next_due_us < frame.time_us) {
            status = cycle(guard, state->next_due_us, state);
        }
        if (status == AXG_STATUS_OK) {
            status = axg_guard_receive(guard, &frame);
        }
        if (status == AXG_STATUS_OK) {
            status = cycle(guard, frame.time_us, state);
        }
        if (status != AXG_STATUS_OK) {
            return status;
        }
        if (state->phase == AXG_PHASE_STOPPED) {
            const bool is_input = strcmp(state->cause, "input") == 0;
            printf("stopped at %" PRId64 " us: %s: %s: %s\n", frame.time_us, state->cause,
                   is_input ? state->input_fault : state->reason,
                   axg_guard_pair_name(guard, state->pair));
            break;
        }
    }
    if (state->permits == 0) {
        printf("never armed: at the beginning of a trace the axes have to stand for 100 ms\n");
    }
    printf("%" PRIu64 " samples, %" PRIu64 " permits, %" PRIu64 " stop frames\n", state->snapshots,
           state->permits, state->stops);
    return AXG_STATUS_OK;
}

int main(int argc, char** argv) {
    if (argc < 3) {
        fprintf(stderr, "guard_a_trace MACHINE.yaml TRACE.log [contact|stoppable]\n");
        return 2;
    }
    axg_options options;
    memset(&options, 0, sizeof options);
    options.version = AXG_INTERFACE_VERSION;
    options.machine_file = argv[1];
    options.engine = AXG_ENGINE_CPU;
    options.mode =
        argc > 3 && strcmp(argv[3], "contact") == 0 ? AXG_MODE_CONTACT : AXG_MODE_STOPPABLE;
    axg_guard* guard = NULL;
    char text[4096];
    axg_status status = axg_guard_create(&options, &guard, text, sizeof text);
    if (status != AXG_STATUS_OK) {
        fprintf(stderr, "guard_a_trace: %s\n%s\n", axg_status_text(status), text);
        return 3;
    }
    FILE* trace = fopen(argv[2], "r");
    if (trace == NULL) {
        fprintf(stderr, "guard_a_trace: cannot read %s. Pass a log of candump -L.\n", argv[2]);
        axg_guard_destroy(guard);
        return 3;
    }
    axg_state state;
    memset(&state, 0, sizeof state);
    status = play(guard, trace, &state);
    fclose(trace);
    axg_guard_destroy(guard);
    if (status != AXG_STATUS_OK) {
        fprintf(stderr, "guard_a_trace: %s\n", axg_status_text(status));
        return 1;
    }
    return state.snapshots != 0 && state.phase == AXG_PHASE_STOPPED ? 10 : 0;
}
