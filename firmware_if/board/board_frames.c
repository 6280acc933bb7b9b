// SPDX-License-Identifier: Apache-2.0
// Frames of the board. Byte by byte: docs/reference/board.md and docs/reference/protocol.md.
#include "firmware_if/board/board_detail.h"

#define AXG_BOARD_TURN_COUNTS 3600000  // 360 deg at 0.0001 deg
#define AXG_BOARD_24_BITS_MAX 8388607
#define AXG_BOARD_24_BITS_NONE 0x800000U
#define AXG_BOARD_32_BITS_NONE 0x80000000U
#define AXG_BOARD_SESSION_US 100000U
#define AXG_BOARD_SESSION_VERSION 0x10U

static void axg_board_blank(axg_board_can_frame* out, uint32_t id, uint8_t length) {
    out->id = id;
    out->is_fd = false;
    out->length = length;
    for (uint32_t i = 0U; i < length; ++i) {
        out->data[i] = 0U;
    }
}

// The counts of an axis in two's complement; an endless axis in 0 to 360 deg.
static uint32_t axg_board_counts(const axg_board* board, uint32_t axis, int32_t position) {
    int32_t counts = position;
    if (((board->options.endless_axes >> axis) & 1U) != 0U) {
        counts %= AXG_BOARD_TURN_COUNTS;
        counts += (counts < 0) ? AXG_BOARD_TURN_COUNTS : 0;
    }
    return (uint32_t)counts;
}

static uint16_t axg_board_data_crc16(const axg_board_can_frame* frame, uint16_t data_id) {
    uint8_t id[2];
    axg_board_put_little(id, data_id, 2U);
    const uint16_t crc = axg_board_crc16((uint16_t)AXG_BOARD_CRC16_START, &frame->data[2],
                                         (uint32_t)frame->length - 2U);
    return axg_board_crc16(crc, id, 2U);
}

uint8_t axg_board_data_crc8(const axg_board_can_frame* frame, uint16_t data_id) {
    uint8_t id[2];
    axg_board_put_little(id, data_id, 2U);
    uint8_t crc = axg_board_crc8((uint8_t)AXG_BOARD_CRC8_START, &frame->data[1], 7U);
    crc = axg_board_crc8(crc, id, 2U);
    return (uint8_t)(crc ^ 0xFFU);
}

uint8_t axg_board_flags(const axg_board* board, const axg_board_says* says) {
    uint32_t flags = says->is_homed ? 0U : 1U;
    if (says->mode == AXG_BOARD_MODE_JOG) {
        flags |= says->jogs_down ? 2U : 0U;
        flags |= ((uint32_t)says->jog_axis & 15U) << 4U;
    } else {
        flags |= says->is_spindle_on ? 2U : 0U;
        flags |= says->is_rapid ? 8U : 0U;
        if (board->has_newest && board->records[board->newest_record].has_ack) {
            flags |= 4U | ((uint32_t)board->records[board->newest_record].ack << 4U);
        }
    }
    return (uint8_t)flags;
}

// One slot of three bytes: the axes in order, then the status, then nothing.
// @return  false: the position or the tool number does not fit
static bool axg_board_put_slot(const axg_board* board, const axg_board_says* says,
                               const int32_t positions[], uint32_t slot, uint8_t to[]) {
    bool fits = true;
    if (slot < board->options.axis_count) {
        const int32_t position = positions[slot];
        if (position == AXG_BOARD_NO_POSITION) {
            axg_board_put_little(to, AXG_BOARD_24_BITS_NONE, 3U);
        } else {
            const bool is_endless = ((board->options.endless_axes >> slot) & 1U) != 0U;
            fits = is_endless ||
                   ((position <= AXG_BOARD_24_BITS_MAX) && (position >= -AXG_BOARD_24_BITS_MAX));
            axg_board_put_little(to, axg_board_counts(board, slot, position), 3U);
        }
    } else if (slot == board->options.axis_count) {
        to[0] = says->mode;
        fits = says->tool <= 0xFFU;
        to[1] = (uint8_t)(says->tool & 0xFFU);
        to[2] = axg_board_flags(board, says);
    } else {
        // stays 0
    }
    return fits;
}

uint8_t axg_board_encode_classical(axg_board* board, const axg_board_says* says,
                                   const int32_t positions[], const axg_board_axis_ids ids[],
                                   axg_board_can_frame out[]) {
    const uint8_t frames = (uint8_t)((board->options.axis_count / 2U) + 1U);
    bool is_good = board->has_newest;
    for (uint32_t i = 0U; is_good && (i < frames); ++i) {
        const uint32_t index = ((uint32_t)board->newest.sync - 1U) & 15U;
        axg_board_blank(&out[i], ids[i].id, 8U);
        out[i].data[1] = (uint8_t)(((uint32_t)board->axes_counter & 15U) | (index << 4U));
        is_good = axg_board_put_slot(board, says, positions, 2U * i, &out[i].data[2]);
        if (is_good) {
            is_good = axg_board_put_slot(board, says, positions, (2U * i) + 1U, &out[i].data[5]);
        }
        out[i].data[0] = axg_board_data_crc8(&out[i], ids[i].data_id);
    }
    board->axes_counter = (uint8_t)(board->axes_counter + (is_good ? 1U : 0U));
    return is_good ? frames : 0U;
}

// The next length of a flexible frame.
static uint8_t axg_board_fd_length(uint32_t bytes) {
    static const uint8_t lengths[7] = {12U, 16U, 20U, 24U, 32U, 48U, 64U};
    uint32_t i = 0U;
    while ((i < 6U) && (lengths[i] < bytes)) {
        ++i;
    }
    return lengths[i];
}

uint8_t axg_board_encode_fd(axg_board* board, const axg_board_says* says, const int32_t positions[],
                            axg_board_axis_ids ids, axg_board_can_frame* out) {
    const uint32_t axes = board->options.axis_count;
    if (board->has_newest) {
        axg_board_blank(out, ids.id, axg_board_fd_length(12U + (4U * axes)));
        out->is_fd = true;
        out->data[2] = board->axes_counter;
        out->data[3] = axg_board_flags(board, says);
        for (uint32_t i = 0U; i < axes; ++i) {
            const uint32_t counts = (positions[i] == AXG_BOARD_NO_POSITION)
                                        ? AXG_BOARD_32_BITS_NONE
                                        : axg_board_counts(board, i, positions[i]);
            axg_board_put_little(&out->data[4U + (4U * i)], counts, 4U);
        }
        uint8_t* const end = &out->data[4U + (4U * axes)];
        axg_board_put_little(end, (uint32_t)(board->newest.latched_us & 0xFFFFFFFFU), 4U);
        axg_board_put_little(&end[4], says->tool, 2U);
        end[6] = says->mode;
        end[7] = board->newest.sync;
        axg_board_put_little(out->data, axg_board_data_crc16(out, ids.data_id), 2U);
        board->axes_counter = (uint8_t)(board->axes_counter + 1U);
    }
    return board->has_newest ? 1U : 0U;
}

bool axg_board_is_session_due(const axg_board* board, uint64_t now_us) {
    return board->has_newest &&
           (board->has_session_changed || (now_us >= (board->session_us + AXG_BOARD_SESSION_US)));
}

bool axg_board_encode_session(axg_board* board, axg_board_axis_ids ids, uint64_t now_us,
                              axg_board_can_frame* out) {
    if (board->has_newest) {
        axg_board_blank(out, ids.id, 8U);
        out->data[1] =
            (uint8_t)(((uint32_t)board->session_counter & 15U) | AXG_BOARD_SESSION_VERSION);
        out->data[2] = board->newest.sync;
        axg_board_put_little(&out->data[3], board->newest.lap, 2U);
        axg_board_put_little(&out->data[5], board->nonce, 3U);
        out->data[0] = axg_board_data_crc8(out, ids.data_id);
        board->session_counter = (uint8_t)(board->session_counter + 1U);
        board->session_us = now_us;
        board->has_session_changed = false;
    }
    return board->has_newest;
}

bool axg_board_encode_hash(const axg_board* board, uint32_t id, uint8_t part,
                           axg_board_can_frame* out) {
    const bool is_part = part < AXG_BOARD_HASH_PARTS;
    if (is_part) {
        axg_board_blank(out, id, 8U);
        out->data[0] = part;
        out->data[1] = 1U;  // the rule of what goes into the hashes
        axg_board_put_little(&out->data[4], board->options.hashes[part], 4U);
    }
    return is_part;
}

void axg_board_encode_sync(uint32_t id, uint8_t sync, axg_board_can_frame* out) {
    axg_board_blank(out, id, 1U);
    out->data[0] = sync;
}

void axg_board_encode_heartbeat(uint32_t id, uint8_t state, axg_board_can_frame* out) {
    axg_board_blank(out, id, 1U);
    out->data[0] = state;
}
