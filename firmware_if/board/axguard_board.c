// SPDX-License-Identifier: Apache-2.0
// Power-up, arming, stops, samples and the end of motion. Rules 1 and 4 to 8 of
// docs/reference/board.md.
#include "firmware_if/board/axguard_board.h"

#include "firmware_if/board/board_detail.h"

#define AXG_BOARD_STRIDES 16U
#define AXG_BOARD_STRIDE_US_MIN 1000U
#define AXG_BOARD_SAMPLES_MAX 15U
#define AXG_BOARD_HASH_RULE 1U
#define AXG_BOARD_ALL_HASHES 0x0FU

uint64_t axg_board_extend_us(uint64_t last_us, uint32_t timer_us) {
    const uint32_t low = (uint32_t)(last_us & 0xFFFFFFFFU);
    const uint32_t passed = timer_us - low;   // modulo 2^32, as the timer
    const uint32_t missing = low - timer_us;  // the same the other way round
    uint64_t at_us = last_us + passed;
    if ((passed > missing) && (last_us >= missing)) {
        at_us = last_us - missing;
    }
    return at_us;
}

uint32_t axg_board_number_of(const axg_board_sample* sample) {
    return ((uint32_t)sample->lap * AXG_BOARD_SYNC_MAX) + sample->sync - 1U;
}

uint32_t axg_board_samples_from(uint32_t from, uint32_t to) {
    return ((to + AXG_BOARD_SAMPLE_NUMBERS) - from) % AXG_BOARD_SAMPLE_NUMBERS;
}

uint64_t axg_board_horizon_us(const axg_board_options* options, uint8_t samples) {
    const uint32_t periods_us = (uint32_t)samples * options->period_us;
    const uint32_t longest_us = ((periods_us * 101U) + 99U) / 100U;
    return (uint64_t)longest_us + options->jitter_us + options->reaction_us;
}

static uint64_t axg_board_rest_us(const axg_board* board) {
    const uint32_t period_us = board->options.period_us;
    const uint32_t stride_us =
        (period_us > AXG_BOARD_STRIDE_US_MIN) ? period_us : AXG_BOARD_STRIDE_US_MIN;
    return (uint64_t)AXG_BOARD_STRIDES * stride_us;
}

axg_board_heard axg_board_refuse(axg_board* board, axg_board_refusal why) {
    uint32_t* const count = &board->refused[why];
    if (*count < UINT32_MAX) {
        ++*count;
    }
    board->last_refusal = why;
    board->permits_in_a_row = 0U;
    return AXG_BOARD_HEARD_REFUSED;
}

static void axg_board_cancel_tool(axg_board* board) {
    if (board->tool != AXG_BOARD_TOOL_STAYS) {
        board->tool = AXG_BOARD_TOOL_CANCELLED;
    }
}

void axg_board_halt(axg_board* board, axg_board_cause cause) {
    if (board->phase == AXG_BOARD_ARMED) {
        board->phase = AXG_BOARD_STOPPED;
        board->cause = cause;
    }
    board->has_end = false;
    axg_board_cancel_tool(board);
}

void axg_board_observe(axg_board* board, uint64_t now_us) {
    board->now_us = (now_us > board->now_us) ? now_us : board->now_us;
    if (board->has_end && (board->now_us >= board->end_us)) {
        board->has_end = false;
        axg_board_cancel_tool(board);
        if (board->moves) {
            axg_board_halt(board, AXG_BOARD_CAUSE_PERMIT_ENDED);
        }
    }
}

void axg_board_forget(axg_board* board) {
    board->has_plain = false;
    board->has_end = false;
    board->has_used = false;
    board->permits_in_a_row = 0U;
    board->forgotten_us = board->now_us;
    board->last.is_given = false;
    board->ordered.is_given = false;
    board->acked.is_given = false;
    for (uint32_t i = 0U; i < AXG_BOARD_RECORDS; ++i) {
        board->records[i].is_kept = false;
    }
}

bool axg_board_power_up(axg_board* board, const axg_board_options* options, uint32_t nonce,
                        uint64_t now_us) {
    const bool is_good =
        (options->period_us != 0U) && (options->period_us <= AXG_BOARD_PERIOD_US_MAX) &&
        (options->permit_samples_max >= 1U) &&
        (options->permit_samples_max <= AXG_BOARD_SAMPLES_MAX) && (options->axis_count >= 1U) &&
        (options->axis_count <= AXG_BOARD_AXES_MAX) && (nonce <= AXG_BOARD_NONCE_MAX);
    *board = (axg_board){.phase = AXG_BOARD_STOPPED};
    if (is_good) {
        board->options = *options;
        board->is_ready = true;
    }
    board->now_us = now_us;
    board->rests_since_us = now_us;
    board->nonce = nonce;
    board->has_session_changed = true;
    board->keeps = axg_board_equal_caps(
        (options->cap_kind == AXG_BOARD_CAP_ENFORCED) ? 0U : (uint8_t)AXG_BOARD_CAP_NONE);
    axg_board_forget(board);
    return is_good;
}

// Two nonces whose checksums are equal would give the same answers.
static uint16_t axg_board_mark_of(uint32_t nonce) {
    uint8_t bytes[3];
    axg_board_put_little(bytes, nonce, 3U);
    return axg_board_crc16((uint16_t)AXG_BOARD_CRC16_START, bytes, 3U);
}

axg_board_arming axg_board_arm(axg_board* board, uint32_t nonce, uint64_t now_us) {
    axg_board_arming done = AXG_BOARD_ARMING_DONE;
    axg_board_observe(board, now_us);
    if (!board->is_ready) {
        done = AXG_BOARD_ARMING_NO_OPTIONS;
    } else if (board->moves) {
        done = AXG_BOARD_ARMING_MOVES;
    } else if ((board->now_us - board->rests_since_us) < axg_board_rest_us(board)) {
        done = AXG_BOARD_ARMING_REST;
    } else if (nonce > AXG_BOARD_NONCE_MAX) {
        done = AXG_BOARD_ARMING_NONCE;
    } else if (axg_board_mark_of(nonce) == axg_board_mark_of(board->nonce)) {
        done = AXG_BOARD_ARMING_NONCE_AGAIN;
    } else {
        axg_board_forget(board);
        board->nonce = nonce;
        board->has_session_changed = true;
        board->phase = AXG_BOARD_ARMED;
        board->has_live = false;
        board->has_reference = false;  // with another nonce numbers may come again
        board->is_admitted = false;
        board->has_moved = false;
        board->tool = AXG_BOARD_TOOL_STAYS;
        if (board->options.cap_kind == AXG_BOARD_CAP_ENFORCED) {
            board->keeps = axg_board_equal_caps(0U);  // it rests
            board->keeps_us = board->now_us;
        }
    }
    return done;
}

// A stamp is no time of a call: a wrong one would move the clock, and no end would pass any more.
bool axg_board_latch(axg_board* board, const axg_board_sample* sample) {
    const bool is_sync = (sample->sync >= 1U) && (sample->sync <= AXG_BOARD_SYNC_MAX);
    const uint32_t number = axg_board_number_of(sample);
    bool is_next = is_sync;
    if (is_sync && board->has_reference) {
        const uint32_t step = axg_board_samples_from(axg_board_number_of(&board->newest), number);
        is_next = (step >= 1U) && (step < (AXG_BOARD_SAMPLE_NUMBERS / 2U)) &&
                  (sample->latched_us > board->newest.latched_us);
    }
    if (is_next) {
        axg_board_record* const record = &board->records[number % AXG_BOARD_RECORDS];
        board->has_session_changed =
            board->has_session_changed || !board->has_newest || (sample->lap != board->newest.lap);
        board->newest = *sample;
        board->has_newest = true;
        board->has_reference = true;
        board->newest_record = (uint8_t)(number % AXG_BOARD_RECORDS);
        record->sample = *sample;
        axg_board_open_record(board, record);
        // A sample latched before the change never permits motion after it.
        record->is_kept = sample->latched_us >= board->forgotten_us;
        if (board->tool == AXG_BOARD_TOOL_WANTED) {
            board->tool = AXG_BOARD_TOOL_ANNOUNCED;
            board->tool_us = sample->latched_us;
        }
    } else {
        axg_board_forget(board);
        board->has_newest = false;
        if (board->moves) {
            axg_board_halt(board, AXG_BOARD_CAUSE_LATCH_ORDER);
        }
    }
    return is_next;
}

static axg_board_heard axg_board_hash(axg_board* board, const axg_board_can_frame* frame) {
    const uint8_t* const data = frame->data;
    axg_board_heard heard = AXG_BOARD_HEARD_HASH;
    if (frame->is_fd || (frame->length != 8U) || (data[0] >= AXG_BOARD_HASH_PARTS) ||
        (data[1] != AXG_BOARD_HASH_RULE) || (data[2] != 0U) || (data[3] != 0U)) {
        heard = axg_board_refuse(board, AXG_BOARD_REFUSED_SHAPE);
    } else {
        const uint8_t bit = (uint8_t)(1U << data[0]);
        if (axg_board_get_little(&data[4], 4U) == board->options.hashes[data[0]]) {
            board->hashes_equal = (uint8_t)(board->hashes_equal | bit);
        } else {
            board->hashes_equal = (uint8_t)(board->hashes_equal & (uint8_t)(0xFFU ^ bit));
            heard = AXG_BOARD_HEARD_HASH_DIFFERS;
            if (board->moves) {
                axg_board_halt(board, AXG_BOARD_CAUSE_HASH_DIFFERS);
            }
        }
    }
    return heard;
}

axg_board_heard axg_board_frame(axg_board* board, const axg_board_can_frame* frame,
                                uint64_t now_us) {
    axg_board_heard heard = AXG_BOARD_HEARD_NOTHING;
    axg_board_observe(board, now_us);
    if (frame->id == board->options.stop_id) {
        axg_board_halt(board, AXG_BOARD_CAUSE_STOP_FRAME);  // whatever it carries
        heard = AXG_BOARD_HEARD_STOP;
    } else if (frame->id == board->options.permit_id) {
        heard = axg_board_plain(board, frame, board->now_us);
    } else if (frame->id == (board->options.permit_id + 1U)) {
        heard = axg_board_twin(board, frame, board->now_us);
    } else if ((frame->id == board->options.hashes_id) && (frame->id != 0U)) {
        heard = axg_board_hash(board, frame);
    } else {
        // another node's
    }
    return heard;
}

axg_board_motion axg_board_may_move(axg_board* board, uint64_t now_us) {
    axg_board_motion motion;
    axg_board_observe(board, now_us);
    const bool is_agreed =
        (board->options.hashes_id == 0U) || (board->hashes_equal == AXG_BOARD_ALL_HASHES);
    motion.may_move =
        (board->phase == AXG_BOARD_ARMED) && board->has_end && board->is_admitted && is_agreed;
    motion.end_us = motion.may_move ? board->end_us : 0U;
    motion.word = motion.may_move ? board->last.word : AXG_BOARD_WORD_NONE;
    motion.level = motion.may_move ? board->last.level : 0U;
    motion.keeps = board->keeps;
    motion.ordered = board->ordered.is_given ? board->ordered.caps : axg_board_equal_caps(0U);
    return motion;
}

void axg_board_moves(axg_board* board, bool moves, uint64_t now_us) {
    const axg_board_motion motion = axg_board_may_move(board, now_us);
    if (moves && !board->moves) {
        if (motion.may_move) {
            board->has_moved = true;
        } else {
            axg_board_halt(board, AXG_BOARD_CAUSE_NOT_PERMITTED);
        }
    }
    if (board->moves && !moves) {
        board->rests_since_us = board->now_us;
    }
    board->moves = moves;
}

void axg_board_stop(axg_board* board, uint64_t now_us) {
    axg_board_observe(board, now_us);
    axg_board_halt(board, AXG_BOARD_CAUSE_PERSON);
}

void axg_board_change(axg_board* board, bool is_jog, uint64_t now_us) {
    axg_board_observe(board, now_us);
    axg_board_forget(board);
    board->is_jogging = is_jog;
    if (board->moves) {
        axg_board_halt(board, AXG_BOARD_CAUSE_CHANGED);
    }
}

bool axg_board_announce_tool(axg_board* board) {
    const bool is_let =
        (board->phase == AXG_BOARD_ARMED) && (board->tool != AXG_BOARD_TOOL_CANCELLED);
    if (is_let && (board->tool == AXG_BOARD_TOOL_STAYS)) {
        board->tool = AXG_BOARD_TOOL_WANTED;
    }
    return is_let;
}

bool axg_board_may_change_tool(axg_board* board, uint64_t now_us) {
    const axg_board_motion motion = axg_board_may_move(board, now_us);
    const uint64_t horizon_us =
        axg_board_horizon_us(&board->options, board->options.permit_samples_max);
    return motion.may_move && (board->tool == AXG_BOARD_TOOL_ANNOUNCED) &&
           (board->now_us >= board->tool_us) && ((board->now_us - board->tool_us) >= horizon_us);
}

void axg_board_end_tool(axg_board* board) {
    if (board->tool != AXG_BOARD_TOOL_CANCELLED) {
        board->tool = AXG_BOARD_TOOL_STAYS;
    }
}
