// SPDX-License-Identifier: Apache-2.0
// Reset and arm over CAN, for a control panel or the board itself: a request, a nonce in the
// guard's status, and a confirmation that repeats the nonce. Rules and bytes:
// docs/reference/board.md.
#ifndef AXG_AXGUARD_OPERATOR_H
#define AXG_AXGUARD_OPERATOR_H

#include "firmware_if/board/axguard_board.h"

#ifdef __cplusplus
extern "C" {
#endif

#define AXG_OPERATOR_CONFIRM_US 5000000U  // from the request; the guard rejects later ones

// Any two bytes of these differ in four bits or more.
typedef enum axg_operator_action {
    AXG_OPERATOR_NOTHING = 0,
    AXG_OPERATOR_RESET = 0x96,
    AXG_OPERATOR_ARM = 0x69
} axg_operator_action;

typedef enum axg_operator_step {
    AXG_OPERATOR_REQUEST = 0x0F,
    AXG_OPERATOR_CONFIRM = 0xF0
} axg_operator_step;

typedef struct axg_operator_message {
    axg_operator_action action;
    axg_operator_step step;
    bool stands;      // a person confirms that all axes are at rest; used only with format signals
    uint8_t counter;  // +1 per message, modulo 16
    uint32_t nonce;   // of the guard's status; 0 in a request
} axg_operator_message;

typedef enum axg_operator_refusal {
    AXG_OPERATOR_REFUSED_NOTHING = 0,
    AXG_OPERATOR_REFUSED_MOVES,     // an axis moves, or is not proven to be at rest
    AXG_OPERATOR_REFUSED_CAUSE,     // the cause of the stop is still present
    AXG_OPERATOR_REFUSED_PHASE,     // nothing to reset or to arm in this phase
    AXG_OPERATOR_REFUSED_NONCE,     // wrong nonce in the confirmation
    AXG_OPERATOR_REFUSED_TOO_LATE,  // confirmed after 5 s
    AXG_OPERATOR_REFUSED_BOARD      // the board stopped by itself: arm the board first
} axg_operator_refusal;

// Status of the guard, every 100 ms and at each change.
typedef struct axg_operator_status {
    uint8_t phase;  // docs/reference/states.md: 0 stopped, 1 init, 2 selftest, 3 ready, 4 armed
    axg_operator_action action;    // requested action that awaits confirmation; or nothing
    axg_operator_refusal refusal;  // of the last message
    uint8_t counter;
    uint32_t nonce;  // to repeat in the confirmation; 0: no request
} axg_operator_status;

// Encodes a panel's message.
// @param ids  can.ids.operator_in; the Data ID is the same number
void axg_operator_encode(const axg_operator_message* message, axg_board_axis_ids ids,
                         axg_board_can_frame* out);
// Encodes the guard's status.
// @param ids  can.ids.operator_out; the Data ID is the same number
void axg_operator_encode_status(const axg_operator_status* status, axg_board_axis_ids ids,
                                axg_board_can_frame* out);
// Decodes a panel's message.
// @return  false: not a valid frame; out is unchanged
bool axg_operator_decode(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                         axg_operator_message* out);
// Decodes the guard's status.
// @return  false: not a valid frame; out is unchanged
bool axg_operator_decode_status(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                                axg_operator_status* out);

#ifdef __cplusplus
}  // extern "C"
#endif

#endif
