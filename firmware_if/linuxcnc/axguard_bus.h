// SPDX-License-Identifier: GPL-2.0-or-later
// A guard on another computer: samples leave as the frames of a board over SocketCAN, the guard's
// frames come in, and a person's one act resets and arms it by the frames of a panel
// (docs/reference/board.md). This file does not use HAL.
#ifndef AXG_AXGUARD_BUS_H
#define AXG_AXGUARD_BUS_H

#include <axguard.h>
#include <stdbool.h>
#include <stdint.h>

#include "firmware_if/board/axguard_operator.h"

typedef struct axg_bus {
    int socket;
    uint32_t operator_in_id, operator_out_id;
    axg_operator_status status;  // of the guard, as last received
    bool has_status;
    int64_t status_us, asked_us;
    uint8_t counter;
    int64_t arm_until_us;  // 0: nobody arms
    bool wants_reset;
} axg_bus;

// Opens the interface; the kernel passes only the guard's frames.
// @return  false: the reason and the remedy are in `fault`
bool axg_bus_open(axg_bus* bus, const char* interface, const axg_terms* terms, char* fault,
                  unsigned fault_bytes);
// @return  false: the frame is not on its way, because the queue is full or the interface gone
bool axg_bus_send(const axg_bus* bus, const axg_frame* frame);
// Reads the next frame of the guard; stores its status frames instead of returning them.
// @return  false: no frame is available
bool axg_bus_receive(axg_bus* bus, int64_t now_us, axg_frame* out);
// A person arms: within the next five seconds the guard is reset, where it is stopped, and armed.
void axg_bus_press(axg_bus* bus, int64_t now_us);
// Sends the frames of that act that are due.
void axg_bus_arm(axg_bus* bus, int64_t now_us);
// The guard's phase from a status of the last half second; without one, stopped.
axg_phase axg_bus_phase(const axg_bus* bus, int64_t now_us);
void axg_bus_close(axg_bus* bus);

#endif
