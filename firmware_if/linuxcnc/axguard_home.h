// SPDX-License-Identifier: GPL-2.0-or-later
// A person's key for homing: commands pass without a permit until all joints are homed. It opens at
// rest alone: a joint that loses its home in motion opens nothing. This file does not use HAL.
#ifndef AXG_AXGUARD_HOME_H
#define AXG_AXGUARD_HOME_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_if/board/axguard_board.h"

typedef struct axg_home {
    bool is_open;     // commands pass
    bool key_before;  // true when the component is loaded: a constant signal is no turn
} axg_home;

// Once a servo period. The key opens by its turn, and stops an armed board: nobody is both armed
// and unguarded. It closes by its return, and when all joints are homed.
// @param wants  a joint is not homed, and no tool change by a person's key goes on
// @return  true: it has opened in this period, and leads out of an E-stop
static inline bool axg_home_turn_key(axg_home* home, axg_board* board, bool key, bool wants,
                                     bool rests, uint64_t now_us) {
    const bool is_turned = key && !home->key_before;
    home->key_before = key;
    home->is_open = key && wants && ((is_turned && rests) || home->is_open);
    if (home->is_open && board->phase == AXG_BOARD_ARMED) {
        axg_board_stop(board, now_us);
    }
    return is_turned && home->is_open;
}

#endif
