// SPDX-License-Identifier: GPL-2.0-or-later
// A tool change of LinuxCNC, one step a servo period: by the board library's rules, or by a
// person's key while the board is stopped. No step permits motion. This file does not use HAL.
#ifndef AXG_AXGUARD_TOOL_H
#define AXG_AXGUARD_TOOL_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_if/board/axguard_board.h"

typedef enum axg_tool_step {
    AXG_TOOL_NONE = 0,
    AXG_TOOL_WANTED,     // announced in the samples
    AXG_TOOL_OUT,        // what changes the tool has begun, after H(n_max)
    AXG_TOOL_UNGUARDED,  // the same, by a person's key
    AXG_TOOL_PERMIT,     // changed: LinuxCNC goes on when its first motion is permitted
    AXG_TOOL_DONE
} axg_tool_step;

typedef struct axg_tool {
    axg_tool_step step;
    uint16_t number;  // in the spindle, as the samples report it
    bool is_open;     // a person turned the key in this stop
    bool key_before;  // true when the component is loaded: a constant signal is no turn
} axg_tool;

typedef struct axg_tool_pins {
    bool wants;    // LinuxCNC wants the tool of `number`
    bool is_done;  // the tool was changed
    int32_t number;
} axg_tool_pins;

// The key opens by its turn, while the board is stopped and the axes rest. It closes by its
// return, by motion and by arming.
// @return  true: it has opened in this period
static inline bool axg_tool_turn_key(axg_tool* tool, const axg_board* board, bool key, bool rests) {
    const bool is_turned = key && !tool->key_before;
    const bool may_open = key && rests && board->phase == AXG_BOARD_STOPPED;
    tool->key_before = key;
    tool->is_open = may_open && (is_turned || tool->is_open);
    return is_turned && tool->is_open;
}

// True while the samples announce a change: the guard confirms no rest, and accepts no reset.
static inline bool axg_tool_is_announced(const axg_tool* tool) {
    return tool->step == AXG_TOOL_WANTED || tool->step == AXG_TOOL_OUT ||
           tool->step == AXG_TOOL_UNGUARDED;
}

// True while a person's key is open, or a change by it goes on: no axis moves then, not even to
// its home, and nobody arms.
static inline bool axg_tool_is_unguarded(const axg_tool* tool) {
    return tool->is_open || tool->step == AXG_TOOL_UNGUARDED;
}

// True while what changes the tool is at work.
static inline bool axg_tool_is_out(const axg_tool* tool) {
    return tool->step == AXG_TOOL_OUT || tool->step == AXG_TOOL_UNGUARDED;
}

// A person armed the board: a change that was announced before is announced anew.
static inline void axg_tool_on_armed(axg_tool* tool) {
    if (tool->step == AXG_TOOL_WANTED || tool->step == AXG_TOOL_OUT) {
        tool->step = AXG_TOOL_NONE;
    }
}

static inline void axg_tool_advance(axg_tool* tool, axg_board* board, const axg_tool_pins* pins,
                                    bool may_move, uint64_t now_us) {
    if (!pins->wants) {
        if (tool->step != AXG_TOOL_NONE) {
            axg_board_end_tool(board);
        }
        tool->step = AXG_TOOL_NONE;
    } else if (tool->is_open && (tool->step == AXG_TOOL_NONE || tool->step == AXG_TOOL_WANTED)) {
        tool->step = AXG_TOOL_UNGUARDED;
    } else if (tool->step == AXG_TOOL_NONE && axg_board_announce_tool(board)) {
        tool->step = AXG_TOOL_WANTED;
    } else if (tool->step == AXG_TOOL_WANTED && axg_board_may_change_tool(board, now_us)) {
        tool->step = AXG_TOOL_OUT;
    } else if (axg_tool_is_out(tool) && pins->is_done) {
        axg_board_end_tool(board);
        tool->number = (uint16_t)pins->number;
        axg_board_change(board, false, now_us);
        tool->step = AXG_TOOL_PERMIT;
    } else if (tool->step == AXG_TOOL_PERMIT && may_move) {
        tool->step = AXG_TOOL_DONE;
    }
}

#endif
