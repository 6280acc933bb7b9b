// SPDX-License-Identifier: Apache-2.0
// A pair of frames becomes a permit, or is refused by name. Rules 2, 3 and 7 of
// docs/reference/board.md.
#include <stddef.h>

#include "firmware_if/board/board_detail.h"

#define AXG_BOARD_AHEAD_MAX 15U
#define AXG_BOARD_LEVEL_MAX 3U

static bool axg_board_is_word(uint8_t byte) {
    return (byte == (uint8_t)AXG_BOARD_WORD_RUN) || (byte == (uint8_t)AXG_BOARD_WORD_SLOW) ||
           (byte == (uint8_t)AXG_BOARD_WORD_JOG) || (byte == (uint8_t)AXG_BOARD_WORD_STOP);
}

// The record of the newest sample with this SYNC counter, or null. One that is stamped after now is
// none: the end that follows from it could be as far away as its stamp is wrong.
static const axg_board_record* axg_board_find(const axg_board* board, uint8_t echo) {
    const axg_board_record* found = NULL;
    if (board->has_newest && (echo >= 1U) && (echo <= AXG_BOARD_SYNC_MAX)) {
        const uint32_t age =
            (((uint32_t)board->newest.sync + AXG_BOARD_SYNC_MAX) - echo) % AXG_BOARD_SYNC_MAX;
        const uint32_t newest = axg_board_number_of(&board->newest);
        const uint32_t number =
            ((newest + AXG_BOARD_SAMPLE_NUMBERS) - age) % AXG_BOARD_SAMPLE_NUMBERS;
        const axg_board_record* const record = &board->records[number % AXG_BOARD_RECORDS];
        if ((age < AXG_BOARD_RECORDS) && record->is_kept &&
            (axg_board_number_of(&record->sample) == number) &&
            (record->sample.latched_us <= board->now_us)) {
            found = record;
        }
    }
    return found;
}

static uint16_t axg_board_answer(const axg_board* board, uint16_t lap) {
    const uint8_t* const data = board->plain;
    uint8_t context[5];
    axg_board_put_little(context, board->nonce, 3U);
    axg_board_put_little(&context[3], lap, 2U);
    uint16_t crc = axg_board_crc16((uint16_t)AXG_BOARD_CRC16_START, data, 3U);
    crc = axg_board_crc16(crc, &data[5], 3U);
    crc = axg_board_crc16(crc, context, 5U);
    return (uint16_t)(crc ^ AXG_BOARD_ANSWER);
}

// Moves the reference with every right answer; true: 1 to 15 ahead of the last one.
static bool axg_board_is_next(axg_board* board, uint8_t live) {
    const uint32_t ahead = ((uint32_t)live + 256U - board->live) % 256U;
    const bool is_next = board->has_live && (ahead >= 1U) && (ahead <= AXG_BOARD_AHEAD_MAX);
    board->has_live = true;
    board->live = live;
    return is_next;
}

static bool axg_board_is_old(const axg_board* board, uint32_t number) {
    return board->has_used &&
           (axg_board_samples_from(board->used_sample, number) > (AXG_BOARD_SAMPLE_NUMBERS / 2U));
}

static axg_board_refusal axg_board_judge(axg_board* board, const axg_board_record* record,
                                         axg_board_permit* permit) {
    const uint8_t* const data = board->plain;
    const bool is_jog = data[0] == (uint8_t)AXG_BOARD_WORD_JOG;
    const uint8_t samples = (uint8_t)(data[7] >> 4U);
    axg_board_refusal why = AXG_BOARD_REFUSED_NOTHING;
    if (axg_board_get_little(&data[3], 2U) !=
        (uint32_t)axg_board_answer(board, record->sample.lap)) {
        why = AXG_BOARD_REFUSED_ANSWER;
    } else if (!axg_board_is_next(board, data[2])) {
        why = AXG_BOARD_REFUSED_LIVE;
    } else if ((!is_jog && (data[5] > AXG_BOARD_CAP_NONE)) ||
               ((data[7] & 15U) > AXG_BOARD_LEVEL_MAX)) {
        why = AXG_BOARD_REFUSED_VALUE;
    } else if ((samples == 0U) || (samples > board->options.permit_samples_max)) {
        why = AXG_BOARD_REFUSED_SAMPLES;
    } else if (axg_board_is_old(board, axg_board_number_of(&record->sample))) {
        why = AXG_BOARD_REFUSED_OLD_ECHO;
    } else {
        permit->end_us = record->sample.latched_us + ((uint64_t)samples * board->options.period_us);
        permit->caps = is_jog ? axg_board_equal_caps((uint8_t)AXG_BOARD_CAP_NONE)
                              : axg_board_caps_of(data[5], data[6]);
        permit->word = (axg_board_word)data[0];
        permit->live = data[2];
        permit->level = (uint8_t)(data[7] & 15U);
        permit->is_given = true;
        if (permit->end_us <= board->now_us) {
            why = AXG_BOARD_REFUSED_LATE;
        } else if (is_jog != board->is_jogging) {
            why = AXG_BOARD_REFUSED_JOG;
        } else {
            // usable
        }
    }
    return why;
}

// Uses a permit: stores its order, and its sample as the newest echo. It counts only if its proof
// covers the speeds since its sample.
static axg_board_heard axg_board_use(axg_board* board, const axg_board_record* record,
                                     const axg_board_permit* permit) {
    axg_board_heard heard = AXG_BOARD_HEARD_PERMIT;
    board->used_sample = axg_board_number_of(&record->sample);
    board->has_used = true;
    board->ordered = *permit;
    axg_board_acknowledge(board);
    if ((board->options.cap_kind == AXG_BOARD_CAP_ENFORCED) &&
        !axg_board_is_covered(record, &permit->caps)) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_CAP);
        board->is_newest_counted = false;
    } else {
        board->is_newest_counted = true;
        if (!board->has_end || (permit->end_us > board->end_us)) {
            board->end_us = permit->end_us;  // a newer permit that ends earlier shortens nothing
            board->has_end = true;
        }
        board->last = *permit;
        if (board->permits_in_a_row < AXG_BOARD_PERMITS_FIRST) {
            ++board->permits_in_a_row;
        }
        board->is_admitted =
            board->is_admitted || (board->permits_in_a_row == AXG_BOARD_PERMITS_FIRST);
        if (board->permits < UINT32_MAX) {
            ++board->permits;
        }
    }
    return heard;
}

// The word stop is obeyed whatever it echoes: a guard that lost its input has no newer sample.
static axg_board_heard axg_board_hear_stop(axg_board* board, const axg_board_record* record) {
    axg_board_heard heard = AXG_BOARD_HEARD_NOT_YET;
    if ((record != NULL) && (axg_board_get_little(&board->plain[3], 2U) ==
                             (uint32_t)axg_board_answer(board, record->sample.lap))) {
        (void)axg_board_is_next(board, board->plain[2]);
    }
    if (board->has_moved) {
        axg_board_halt(board, AXG_BOARD_CAUSE_STOP_WORD);
        heard = AXG_BOARD_HEARD_STOP;
    }
    return heard;
}

static axg_board_heard axg_board_pair(axg_board* board) {
    axg_board_heard heard = AXG_BOARD_HEARD_REFUSED;
    const axg_board_record* const record = axg_board_find(board, board->plain[1]);
    axg_board_permit permit;
    if (!axg_board_is_word(board->plain[0])) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_WORD);
    } else if (board->phase != AXG_BOARD_ARMED) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_STOPPED);
    } else if (board->plain[0] == (uint8_t)AXG_BOARD_WORD_STOP) {
        heard = axg_board_hear_stop(board, record);
    } else if (record == NULL) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_ECHO);
    } else {
        const axg_board_refusal why = axg_board_judge(board, record, &permit);
        heard = (why == AXG_BOARD_REFUSED_NOTHING) ? axg_board_use(board, record, &permit)
                                                   : axg_board_refuse(board, why);
    }
    return heard;
}

axg_board_heard axg_board_plain(axg_board* board, const axg_board_can_frame* frame,
                                uint64_t now_us) {
    axg_board_heard heard = AXG_BOARD_HEARD_PLAIN;
    const bool is_second = board->has_plain;
    board->has_plain = false;
    if (frame->is_fd || (frame->length != 8U)) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_SHAPE);
    } else {
        if (is_second) {  // the one before is lost, this one may be half of the next pair
            heard = axg_board_refuse(board, AXG_BOARD_REFUSED_TWIN_MISSING);
        }
        for (uint32_t i = 0U; i < 8U; ++i) {
            board->plain[i] = frame->data[i];
        }
        board->plain_us = now_us;
        board->has_plain = true;
    }
    return heard;
}

axg_board_heard axg_board_twin(axg_board* board, const axg_board_can_frame* frame,
                               uint64_t now_us) {
    axg_board_heard heard = AXG_BOARD_HEARD_REFUSED;
    const bool has_plain = board->has_plain;
    uint32_t same = 0U;
    board->has_plain = false;
    for (uint32_t i = 0U; i < 8U; ++i) {
        same |= (uint32_t)board->plain[i] ^ (uint32_t)frame->data[i] ^ 0xFFU;
    }
    if (frame->is_fd || (frame->length != 8U)) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_SHAPE);
    } else if (!has_plain) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_TWIN_ALONE);
    } else if ((now_us < board->plain_us) ||
               ((now_us - board->plain_us) > board->options.period_us)) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_TWIN_LATE);
    } else if (same != 0U) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_TWIN_DIFFERS);
    } else {
        heard = axg_board_pair(board);
    }
    return heard;
}
