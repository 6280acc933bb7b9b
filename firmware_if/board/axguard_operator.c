// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/axguard_operator.h"

#include "firmware_if/board/board_detail.h"

#define AXG_OPERATOR_VERSION 0x10U
#define AXG_OPERATOR_PHASE_MAX 4U

static void axg_operator_seal(axg_board_can_frame* out, axg_board_axis_ids ids, uint8_t counter,
                              uint32_t nonce) {
    out->id = ids.id;
    out->is_fd = false;
    out->length = 8U;
    out->data[1] = (uint8_t)(((uint32_t)counter & 15U) | AXG_OPERATOR_VERSION);
    axg_board_put_little(&out->data[5], nonce, 3U);
    out->data[0] = axg_board_data_crc8(out, ids.data_id);
}

static bool axg_operator_is_sealed(const axg_board_can_frame* frame, axg_board_axis_ids ids) {
    return (frame->id == ids.id) && !frame->is_fd && (frame->length == 8U) &&
           ((frame->data[1] & 0xF0U) == AXG_OPERATOR_VERSION) &&
           (frame->data[0] == axg_board_data_crc8(frame, ids.data_id));
}

static bool axg_operator_is_action(uint8_t byte) {
    return (byte == (uint8_t)AXG_OPERATOR_RESET) || (byte == (uint8_t)AXG_OPERATOR_ARM);
}

void axg_operator_encode(const axg_operator_message* message, axg_board_axis_ids ids,
                         axg_board_can_frame* out) {
    out->data[2] = (uint8_t)message->action;
    out->data[3] = (uint8_t)message->step;
    out->data[4] = message->stands ? 1U : 0U;
    axg_operator_seal(out, ids, message->counter, message->nonce);
}

void axg_operator_encode_status(const axg_operator_status* status, axg_board_axis_ids ids,
                                axg_board_can_frame* out) {
    out->data[2] = status->phase;
    out->data[3] = (uint8_t)status->action;
    out->data[4] = (uint8_t)status->refusal;
    axg_operator_seal(out, ids, status->counter, status->nonce);
}

bool axg_operator_decode(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                         axg_operator_message* out) {
    const uint8_t* const data = frame->data;
    const bool is_good = axg_operator_is_sealed(frame, ids) && axg_operator_is_action(data[2]) &&
                         ((data[3] == (uint8_t)AXG_OPERATOR_REQUEST) ||
                          (data[3] == (uint8_t)AXG_OPERATOR_CONFIRM)) &&
                         (data[4] <= 1U);
    if (is_good) {
        out->action = (axg_operator_action)data[2];
        out->step = (axg_operator_step)data[3];
        out->stands = data[4] == 1U;
        out->counter = (uint8_t)(data[1] & 15U);
        out->nonce = axg_board_get_little(&data[5], 3U);
    }
    return is_good;
}

bool axg_operator_decode_status(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                                axg_operator_status* out) {
    const uint8_t* const data = frame->data;
    const bool is_good = axg_operator_is_sealed(frame, ids) &&
                         (data[2] <= AXG_OPERATOR_PHASE_MAX) &&
                         ((data[3] == 0U) || axg_operator_is_action(data[3])) &&
                         (data[4] <= (uint8_t)AXG_OPERATOR_REFUSED_BOARD);
    if (is_good) {
        out->phase = data[2];
        out->action = (axg_operator_action)data[3];
        out->refusal = (axg_operator_refusal)data[4];
        out->counter = (uint8_t)(data[1] & 15U);
        out->nonce = axg_board_get_little(&data[5], 3U);
    }
    return is_good;
}
