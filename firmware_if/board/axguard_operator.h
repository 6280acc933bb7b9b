// SPDX-License-Identifier: Apache-2.0
// A person's reset and arm over CAN, for a control panel or the board itself: a request, the nonce
// that the guard answers with, and a confirmation that repeats it. Rules and bytes:
// docs/reference/board.md.
#ifndef AXG_AXGUARD_OPERATOR_H
#define AXG_AXGUARD_OPERATOR_H

#include "firmware_if/board/axguard_board.h"

#ifdef __cplusplus
extern "C" {
#endif

#define AXG_OPERATOR_CONFIRM_US 5000000U  // from the request; later the guard refuses

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
    bool stands;      // a person sees that all axes stand; counts with format signals alone
    uint8_t counter;  // +1 a message, modulo 16
    uint32_t nonce;   // of the guard's status; 0 in a request
} axg_operator_message;

typedef enum axg_operator_refusal {
    AXG_OPERATOR_REFUSED_NOTHING = 0,
    AXG_OPERATOR_REFUSED_MOVES,    // an axis moves, or is not proven to stand
    AXG_OPERATOR_REFUSED_CAUSE,    // what stopped the guard is still there
    AXG_OPERATOR_REFUSED_PHASE,    // nothing to reset or to arm in this phase
    AXG_OPERATOR_REFUSED_NONCE,    // a confirmation of another request
    AXG_OPERATOR_REFUSED_TOO_LATE  // confirmed after 5 s
} axg_operator_refusal;

// The guard's status, every 100 ms and at each change.
typedef struct axg_operator_status {
    uint8_t phase;  // docs/reference/states.md: 0 stopped, 1 init, 2 selftest, 3 ready, 4 armed
    axg_operator_action action;    // that waits for its confirmation; or nothing
    axg_operator_refusal refusal;  // of the last message
    uint8_t counter;
    uint32_t nonce;  // to be repeated; 0: nothing waits
} axg_operator_status;

// The message of a panel.
// @param ids  can.ids.operator_in; the Data ID is the same number
void axg_operator_encode(const axg_operator_message* message, axg_board_axis_ids ids,
                         axg_board_can_frame* out);
// The guard's status.
// @param ids  can.ids.operator_out; the Data ID is the same number
void axg_operator_encode_status(const axg_operator_status* status, axg_board_axis_ids ids,
                                axg_board_can_frame* out);
// Reads a panel's message.
// @return  false: not exactly such a frame; out is untouched
bool axg_operator_decode(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                         axg_operator_message* out);
// Reads the guard's status.
// @return  false: not exactly such a frame; out is untouched
bool axg_operator_decode_status(const axg_board_can_frame* frame, axg_board_axis_ids ids,
                                axg_operator_status* out);

#ifdef __cplusplus
}  // extern "C"
#endif

#endif
