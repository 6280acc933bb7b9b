// SPDX-License-Identifier: Apache-2.0
// Plays the scripts of permit2.json on the board library, in C99 as firmware is: every step has to
// go as the file says. One step is one line of the file. Exit 0: all did; 1: not; 2: no such file.
// Example: play_permit2 tests/vectors/permit2.json
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware_if/board/axguard_operator.h"

enum { LINE_BYTES = 4096 };

static axg_board board;
static char script[LINE_BYTES];
static unsigned steps, faults;

// What stands after "key": on this line, or null.
static const char* value_of(const char* line, const char* key) {
    char pattern[64];
    snprintf(pattern, sizeof pattern, "\"%s\": ", key);
    const char* const at = strstr(line, pattern);
    return at == NULL ? NULL : at + strlen(pattern);
}
static uint64_t number_of(const char* line, const char* key) {
    const char* const at = value_of(line, key);
    return at == NULL ? 0U : strtoull(at, NULL, 10);
}
static void text_of(const char* line, const char* key, char* out, size_t out_bytes) {
    const char* const at = value_of(line, key);
    size_t length = 0;
    if (at != NULL && *at == '"') {
        length = strcspn(at + 1, "\"");
        length = length < out_bytes ? length : out_bytes - 1;
        memcpy(out, at + 1, length);
    }
    out[length] = '\0';
}
static uint8_t bytes_of(const char* hex, uint8_t out[]) {
    const size_t count = strlen(hex) / 2;
    for (size_t i = 0; i < count && i < 64; ++i) {
        const char digits[3] = {hex[2 * i], hex[2 * i + 1], '\0'};
        out[i] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return (uint8_t)count;
}
static void hex_of(const uint8_t bytes[], unsigned count, char* out) {
    for (unsigned i = 0; i < count; ++i) {
        sprintf(out + 2 * i, "%02X", bytes[i]);
    }
    out[2 * count] = '\0';
}

static void expect(const char* line, const char* what, const char* got, const char* wanted) {
    if (strcmp(got, wanted) != 0) {
        ++faults;
        printf("%s: %s: got %s, wanted %s: %s", script, what, got, wanted, line);
    }
}
static void expect_number(const char* line, const char* what, uint64_t got, uint64_t wanted) {
    char texts[2][32];
    snprintf(texts[0], sizeof texts[0], "%" PRIu64, got);
    snprintf(texts[1], sizeof texts[1], "%" PRIu64, wanted);
    expect(line, what, texts[0], texts[1]);
}

static const char* const heard_names[] = {"nothing", "plain", "permit",       "not_yet",
                                          "stop",    "hash",  "hash_differs", "refused"};
static const char* const refusal_names[] = {
    "nothing", "shape",    "twin_missing", "twin_alone", "twin_late", "twin_differs",
    "word",    "stopped",  "echo",         "answer",     "live",      "value",
    "samples", "old_echo", "late",         "jog",        "cap"};
static const char* const arming_names[] = {"done",  "moves",       "rest",
                                           "nonce", "nonce_again", "no_options"};
static const char* const cause_names[] = {"power_up",     "stop_frame",    "stop_word",
                                          "permit_ended", "not_permitted", "changed",
                                          "latch_order",  "hash_differs",  "person"};
static const char* const phase_names[] = {"stopped", "armed"};

static void power_up(const char* line) {
    const axg_board_options options = {
        .period_us = (uint32_t)number_of(line, "period"),
        .jitter_us = (uint32_t)number_of(line, "jitter"),
        .reaction_us = (uint32_t)number_of(line, "reaction"),
        .permit_samples_max = (uint8_t)number_of(line, "n_max"),
        .axis_count = (uint8_t)number_of(line, "axes"),
        .endless_axes = (uint16_t)number_of(line, "endless"),
        .cap_kind = number_of(line, "caps") != 0 ? AXG_BOARD_CAP_ENFORCED : AXG_BOARD_CAP_IGNORED,
        .permit_id = 0x103,
        .stop_id = 0x001,
        .hashes_id = number_of(line, "hashes") != 0 ? 0x602 : 0,
        .hashes = {0x44332211, 0x45332211, 0x46332211, 0x47332211}};
    const bool is_good = axg_board_power_up(&board, &options, (uint32_t)number_of(line, "nonce"),
                                            number_of(line, "at"));
    expect_number(line, "is good", is_good, number_of(line, "want"));
}

static void frame(const char* line) {
    char data[LINE_BYTES], want[32], why[32];
    axg_board_can_frame heard = {.id = (uint32_t)number_of(line, "id"),
                                 .is_fd = number_of(line, "fd") != 0};
    text_of(line, "data", data, sizeof data);
    text_of(line, "want", want, sizeof want);
    text_of(line, "why", why, sizeof why);
    heard.length = bytes_of(data, heard.data);
    const axg_board_heard got = axg_board_frame(&board, &heard, number_of(line, "at"));
    expect(line, "heard", heard_names[got], want);
    if (got == AXG_BOARD_HEARD_REFUSED) {
        expect(line, "refused", refusal_names[board.last_refusal], why);
    }
}

static void may_move(const char* line) {
    const axg_board_motion motion = axg_board_may_move(&board, number_of(line, "at"));
    const uint64_t end = number_of(line, "end");
    expect_number(line, "may move", motion.may_move, end != 0);
    expect_number(line, "end", motion.end_us, end);
    expect_number(line, "word", (uint64_t)motion.word, number_of(line, "word"));
}

static void keeps(const char* line) {
    char hex[LINE_BYTES], got[64];
    axg_board_caps wanted;
    text_of(line, "wanted", hex, sizeof hex);
    bytes_of(hex, wanted.of);
    const axg_board_caps kept = axg_board_keeps(&board, &wanted, number_of(line, "at"));
    text_of(line, "want", hex, sizeof hex);
    hex_of(kept.of, AXG_BOARD_CAP_GROUPS, got);
    expect(line, "keeps", got, hex);
}

static axg_board_says says_of(const char* line) {
    const axg_board_says says = {.mode = (uint8_t)number_of(line, "mode"),
                                 .tool = (uint16_t)number_of(line, "tool"),
                                 .is_homed = number_of(line, "homed") != 0,
                                 .is_spindle_on = number_of(line, "spindle") != 0,
                                 .is_rapid = number_of(line, "rapid") != 0,
                                 .jogs_down = number_of(line, "down") != 0,
                                 .jog_axis = (uint8_t)number_of(line, "axis")};
    return says;
}

static void axes(const char* line, bool is_fd) {
    static const axg_board_axis_ids ids[3] = {{0x181, 0x181}, {0x281, 0x281}, {0x381, 0x381}};
    char want[LINE_BYTES], got[LINE_BYTES] = "";
    int32_t counts[AXG_BOARD_AXES_MAX] = {0};
    axg_board_can_frame frames[AXG_BOARD_CLASSICAL_FRAMES_MAX];
    const axg_board_says says = says_of(line);
    const char* at = value_of(line, "counts") + 1;
    for (unsigned i = 0; i < 5; ++i) {
        char* end;
        counts[i] = (int32_t)strtol(at, &end, 10);
        at = end + 2;
    }
    const uint8_t count = is_fd ? axg_board_encode_fd(&board, &says, counts, ids[0], frames)
                                : axg_board_encode_classical(&board, &says, counts, ids, frames);
    for (unsigned i = 0; i < count; ++i) {
        strcat(got, i == 0 ? "" : "/");
        hex_of(frames[i].data, frames[i].length, got + strlen(got));
    }
    text_of(line, "want", want, sizeof want);
    expect(line, "frames", got, want);
}

static void session(const char* line) {
    const axg_board_axis_ids ids = {0x583, 0x583};
    char want[64], got[64] = "";
    axg_board_can_frame made;
    if (axg_board_encode_session(&board, ids, number_of(line, "at"), &made)) {
        hex_of(made.data, made.length, got);
    }
    text_of(line, "want", want, sizeof want);
    expect(line, "session", got, want);
}

static void small(const char* line, const char* verb) {
    char want[64], got[64] = "";
    axg_board_can_frame made = {.length = 0};
    if (strcmp(verb, "hash") == 0) {
        (void)axg_board_encode_hash(&board, 0x582, (uint8_t)number_of(line, "part"), &made);
    } else if (strcmp(verb, "sync") == 0) {
        axg_board_encode_sync(0x080, (uint8_t)number_of(line, "sync"), &made);
    } else {
        axg_board_encode_heartbeat(0x701, (uint8_t)number_of(line, "state"), &made);
    }
    hex_of(made.data, made.length, got);
    text_of(line, "want", want, sizeof want);
    expect(line, "frame", got, want);
}

// One frame of an operator both ways; without "want" its bytes are read only.
static void operator_frame(const char* line, bool is_status) {
    const axg_board_axis_ids ids =
        is_status ? (axg_board_axis_ids){0x604, 0x604} : (axg_board_axis_ids){0x584, 0x584};
    char want[64], got[64];
    axg_board_can_frame made = {.length = 0};
    text_of(line, "want", want, sizeof want);
    if (is_status) {
        const axg_operator_status status = {
            .phase = (uint8_t)number_of(line, "phase"),
            .action = (axg_operator_action)number_of(line, "action"),
            .refusal = (axg_operator_refusal)number_of(line, "refusal"),
            .counter = (uint8_t)number_of(line, "counter"),
            .nonce = (uint32_t)number_of(line, "nonce")};
        axg_operator_status read = {.phase = 0};
        axg_operator_encode_status(&status, ids, &made);
        expect_number(line, "reads", axg_operator_decode_status(&made, ids, &read),
                      number_of(line, "reads"));
        expect_number(line, "nonce", read.nonce, number_of(line, "reads") ? status.nonce : 0);
    } else {
        const axg_operator_message message = {
            .action = (axg_operator_action)number_of(line, "action"),
            .step = (axg_operator_step)number_of(line, "step"),
            .stands = number_of(line, "stands") != 0,
            .counter = (uint8_t)number_of(line, "counter"),
            .nonce = (uint32_t)number_of(line, "nonce")};
        axg_operator_message read = {.nonce = 0};
        axg_operator_encode(&message, ids, &made);
        expect_number(line, "reads", axg_operator_decode(&made, ids, &read),
                      number_of(line, "reads"));
        expect_number(line, "nonce", read.nonce, number_of(line, "reads") ? message.nonce : 0);
    }
    hex_of(made.data, made.length, got);
    expect(line, "frame", got, want);
}

static void expect_state(const char* line) {
    char phase[32], cause[32];
    text_of(line, "phase", phase, sizeof phase);
    text_of(line, "want", cause, sizeof cause);
    expect(line, "phase", phase_names[board.phase], phase);
    if (cause[0] != '\0') {
        expect(line, "cause", cause_names[board.cause], cause);
    }
}

static void arm(const char* line) {
    char want[32];
    text_of(line, "want", want, sizeof want);
    expect(line, "armed",
           arming_names[axg_board_arm(&board, (uint32_t)number_of(line, "nonce"),
                                      number_of(line, "at"))],
           want);
}

static void latch(const char* line) {
    const axg_board_sample sample = {.latched_us = number_of(line, "at"),
                                     .lap = (uint16_t)number_of(line, "lap"),
                                     .sync = (uint8_t)number_of(line, "sync")};
    expect_number(line, "latched", axg_board_latch(&board, &sample), number_of(line, "want"));
}

static void play(const char* line, const char* verb) {
    const uint64_t at = number_of(line, "at"), want = number_of(line, "want");
    if (strcmp(verb, "power_up") == 0) {
        power_up(line);
    } else if (strcmp(verb, "arm") == 0) {
        arm(line);
    } else if (strcmp(verb, "latch") == 0) {
        latch(line);
    } else if (strcmp(verb, "frame") == 0) {
        frame(line);
    } else if (strcmp(verb, "may_move") == 0) {
        may_move(line);
    } else if (strcmp(verb, "moves") == 0) {
        axg_board_moves(&board, number_of(line, "moves") != 0, at);
        expect_state(line);
    } else if (strcmp(verb, "keeps") == 0) {
        keeps(line);
    } else if (strcmp(verb, "change") == 0) {
        axg_board_change(&board, number_of(line, "jog") != 0, at);
    } else if (strcmp(verb, "stop") == 0) {
        axg_board_stop(&board, at);
    } else if (strcmp(verb, "cause") == 0) {
        expect_state(line);
    } else if (strcmp(verb, "refused") == 0) {
        char why[32];
        unsigned i = 0;
        text_of(line, "why", why, sizeof why);
        while (i < AXG_BOARD_REFUSALS && strcmp(refusal_names[i], why) != 0) {
            ++i;
        }
        expect_number(line, "count", board.refused[i], want);
    } else if (strcmp(verb, "announce") == 0) {
        expect_number(line, "announced", axg_board_announce_tool(&board), want);
    } else if (strcmp(verb, "may_tool") == 0) {
        expect_number(line, "may change", axg_board_may_change_tool(&board, at), want);
    } else if (strcmp(verb, "end_tool") == 0) {
        axg_board_end_tool(&board);
    } else if (strcmp(verb, "flags_of") == 0) {
        axg_board_says says = says_of(line);
        says.is_homed = true;
        expect_number(line, "flags", axg_board_flags(&board, &says), want);
    } else if (strcmp(verb, "session") == 0) {
        session(line);
    } else if (strcmp(verb, "session_due") == 0) {
        expect_number(line, "is due", axg_board_is_session_due(&board, at), want);
    } else if (strcmp(verb, "hash") == 0 || strcmp(verb, "sync") == 0 ||
               strcmp(verb, "heartbeat") == 0) {
        small(line, verb);
    } else if (strcmp(verb, "operator") == 0 || strcmp(verb, "status") == 0) {
        operator_frame(line, verb[0] == 's');
    } else if (strcmp(verb, "extend") == 0) {
        const uint32_t timer = (uint32_t)number_of(line, "timer");
        expect_number(line, "us", axg_board_extend_us(number_of(line, "last"), timer), want);
    } else if (strcmp(verb, "classical") == 0 || strcmp(verb, "fd") == 0) {
        axes(line, verb[0] == 'f');
    } else {
        ++faults;
        printf("unknown step: %s", line);
    }
}

int main(int count, char* arguments[]) {
    static char line[LINE_BYTES];
    FILE* const file = count == 2 ? fopen(arguments[1], "r") : NULL;
    if (file == NULL) {
        fputs("usage: play_permit2 permit2.json\n", stderr);
        return 2;
    }
    while (fgets(line, sizeof line, file) != NULL) {
        char verb[32];
        if (value_of(line, "steps") != NULL) {
            text_of(line, "name", script, sizeof script);
        }
        text_of(line, "do", verb, sizeof verb);
        if (verb[0] != '\0') {
            ++steps;
            play(line, verb);
        }
    }
    fclose(file);
    printf("%u passed, %u failed\n", steps - (faults < steps ? faults : steps), faults);
    return faults == 0 && steps != 0 ? 0 : 1;
}
