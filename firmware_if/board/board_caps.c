// SPDX-License-Identifier: Apache-2.0
// The enforced cap: a permit orders, a sample acknowledges, and a permit counts only if the axes
// were no faster since its sample than the guard's proof assumes. Rules (i) to (iv):
// docs/reference/board.md.
#include "firmware_if/board/board_detail.h"

axg_board_caps axg_board_equal_caps(uint8_t cap) {
    axg_board_caps caps;
    for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
        caps.of[i] = cap;
    }
    return caps;
}

axg_board_caps axg_board_caps_of(uint8_t cap, uint8_t mask) {
    axg_board_caps caps;
    uint32_t bits = mask;
    for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
        caps.of[i] = ((bits & 1U) != 0U) ? cap : (uint8_t)AXG_BOARD_CAP_NONE;
        bits >>= 1U;
    }
    return caps;
}

bool axg_board_is_below(const axg_board_caps* lower, const axg_board_caps* upper) {
    bool is_below = true;
    for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
        is_below = is_below && (lower->of[i] <= upper->of[i]);
    }
    return is_below;
}

// A permit is named first by one of the 15 samples after its own: the low bits of an older one
// would pass for a newer one's. It may then be named for as long as the axes slow down.
static bool axg_board_may_name(const axg_board* board, const axg_board_record* record) {
    const uint32_t age =
        axg_board_samples_from(board->acked_sample, axg_board_number_of(&record->sample));
    return (board->options.cap_kind == AXG_BOARD_CAP_ENFORCED) && board->acked.is_given &&
           (board->is_acked_named || (age < AXG_BOARD_RECORDS));
}

// The newest usable permit.
static void axg_board_take_ack(axg_board* board, const axg_board_permit* permit) {
    if (!board->acked.is_given || (board->acked_sample != board->used_sample) ||
        (board->acked.live != permit->live)) {
        board->is_acked_named = false;
    }
    board->acked = *permit;
    board->acked_sample = board->used_sample;
}

void axg_board_open_record(axg_board* board, axg_board_record* record) {
    // If a bound changed between the stamp and this call, the old value is lost: assumes rapid.
    const bool is_known = record->sample.latched_us >= board->keeps_us;
    record->highest = is_known ? board->keeps : axg_board_equal_caps((uint8_t)AXG_BOARD_CAP_NONE);
    record->has_ack = axg_board_may_name(board, record);
    board->is_acked_named = record->has_ack;
    record->acked =
        record->has_ack ? board->acked.caps : axg_board_equal_caps((uint8_t)AXG_BOARD_CAP_NONE);
    record->ack = record->has_ack ? (uint8_t)(board->acked.live & 15U) : 0U;
}

bool axg_board_is_covered(const axg_board_record* record, const axg_board_caps* caps) {
    bool is_covered = true;
    for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
        const uint8_t proven =
            (record->acked.of[i] > caps->of[i]) ? record->acked.of[i] : caps->of[i];
        is_covered = is_covered && (record->highest.of[i] <= proven);
    }
    return is_covered;
}

void axg_board_acknowledge(axg_board* board) {
    if (board->ordered.is_given && axg_board_is_below(&board->keeps, &board->ordered.caps)) {
        axg_board_take_ack(board, &board->ordered);  // so the samples never name an older one
    }
}

// (ii), (iv): the permit that counted last has the end that is in force, so that a raise which
// drops all others shortens nothing, and no axis still has to slow down for it. (i): nor is there a
// newer one, which the samples may have named already.
static bool axg_board_may_rise(const axg_board* board) {
    return (board->phase == AXG_BOARD_ARMED) && board->has_end && board->last.is_given &&
           board->is_newest_counted && (board->last.end_us == board->end_us) &&
           axg_board_is_below(&board->keeps, &board->last.caps);
}

static void axg_board_raise(axg_board* board, uint32_t group, uint8_t cap) {
    board->keeps.of[group] = cap;
    for (uint32_t i = 0U; i < AXG_BOARD_RECORDS; ++i) {
        uint8_t* const highest = &board->records[i].highest.of[group];
        *highest = (cap > *highest) ? cap : *highest;
    }
    axg_board_take_ack(board, &board->last);  // at once: the one before orders less than this
}

// The bound of a group without an axis is 0, so that no acknowledgement waits for it.
static uint8_t axg_board_wanted(const axg_board* board, const axg_board_caps* wanted,
                                uint32_t group) {
    return (group < board->options.axis_count) ? wanted->of[group] : 0U;
}

axg_board_caps axg_board_keeps(axg_board* board, const axg_board_caps* wanted, uint64_t now_us) {
    axg_board_observe(board, now_us);
    if (board->options.cap_kind == AXG_BOARD_CAP_ENFORCED) {
        bool is_changed = false;
        for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
            const uint8_t cap = axg_board_wanted(board, wanted, i);
            if (cap < board->keeps.of[i]) {
                board->keeps.of[i] = cap;
                is_changed = true;
            }
        }
        if (axg_board_may_rise(board)) {
            for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
                const uint8_t most = board->last.caps.of[i];
                const uint8_t asked = axg_board_wanted(board, wanted, i);
                const uint8_t cap = (asked < most) ? asked : most;
                if (cap > board->keeps.of[i]) {
                    axg_board_raise(board, i, cap);
                    is_changed = true;
                }
            }
        }
        axg_board_acknowledge(board);
        if (is_changed) {
            board->keeps_us = board->now_us;
        }
    }
    return board->keeps;
}
