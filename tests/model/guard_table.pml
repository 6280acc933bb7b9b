/* SPDX-License-Identifier: Apache-2.0
 * Written by axg_guard_table from core/guard/guard_table.hpp: change that, and write
 * this again. Included by guard.pml. */

#define P_stopped 0
#define P_init 1
#define P_selftest 2
#define P_ready 3
#define P_armed 4

#define I_loaded 0
#define I_tested 1
#define I_proven 2
#define I_refused 3
#define I_period_good 4
#define I_period_settled 5
#define I_period_disturbed 6
#define I_period_missed 7
#define I_period_silent 8
#define I_period_full 9
#define I_fault_reported 10
#define I_fault_stop 11
#define I_tx_ok 12
#define I_tx_fail 13
#define I_board_ack 14
#define I_board_moves 15
#define I_reset_refused 16
#define I_reset 17
#define I_arm 18
#define I_restart 19
#define I_kill 20
#define I_own_stop 21

#define A_none 0
#define A_begin 1
#define A_pass 2
#define A_hear 3
#define A_wait 4
#define A_wait_deaf 5
#define A_good 6
#define A_disturbed 7
#define A_missed 8
#define A_permit 9
#define A_stop 10
#define A_repeat 11
#define A_confirm 12
#define A_withdraw 13
#define A_mute 14

#define SNAPSHOTS_MIN 2
#define SAMPLES_LEAST 2
#define SAMPLES_MOST 3
#define BAD_WEIGHT 2
#define BAD_LIMIT 4

/* Sets next and action. */
inline look_up(input, phase) {
    if
    :: input == I_loaded && phase == P_init ->
        next = P_selftest; action = A_begin
    :: input == I_tested && phase == P_selftest ->
        next = P_selftest; action = A_pass
    :: input == I_proven && phase == P_armed ->
        next = P_armed; action = A_permit
    :: input == I_period_good && phase == P_selftest ->
        next = P_selftest; action = A_good
    :: input == I_period_good && phase == P_ready ->
        next = P_ready; action = A_good
    :: input == I_period_good && phase == P_armed ->
        next = P_armed; action = A_good
    :: input == I_period_settled && phase == P_selftest ->
        next = P_ready; action = A_good
    :: input == I_period_settled && phase == P_ready ->
        next = P_ready; action = A_good
    :: input == I_period_settled && phase == P_armed ->
        next = P_armed; action = A_good
    :: input == I_period_disturbed && phase == P_selftest ->
        next = P_selftest; action = A_wait
    :: input == I_period_disturbed && phase == P_ready ->
        next = P_ready; action = A_disturbed
    :: input == I_period_disturbed && phase == P_armed ->
        next = P_armed; action = A_disturbed
    :: input == I_period_missed && phase == P_selftest ->
        next = P_selftest; action = A_wait
    :: input == I_period_missed && phase == P_ready ->
        next = P_ready; action = A_missed
    :: input == I_period_missed && phase == P_armed ->
        next = P_armed; action = A_missed
    :: input == I_period_silent && phase == P_selftest ->
        next = P_selftest; action = A_wait
    :: input == I_period_silent && phase == P_ready ->
        next = P_selftest; action = A_wait
    :: input == I_period_silent && phase == P_armed ->
        next = P_stopped; action = A_stop
    :: input == I_period_full && phase == P_selftest ->
        next = P_selftest; action = A_wait
    :: input == I_period_full && phase == P_ready ->
        next = P_selftest; action = A_wait
    :: input == I_period_full && phase == P_armed ->
        next = P_stopped; action = A_stop
    :: input == I_fault_stop && phase == P_init ->
        next = P_stopped; action = A_stop
    :: input == I_fault_stop && phase == P_selftest ->
        next = P_stopped; action = A_stop
    :: input == I_fault_stop && phase == P_ready ->
        next = P_stopped; action = A_stop
    :: input == I_fault_stop && phase == P_armed ->
        next = P_stopped; action = A_stop
    :: input == I_tx_ok && phase == P_selftest ->
        next = P_selftest; action = A_hear
    :: input == I_tx_fail && phase == P_selftest ->
        next = P_selftest; action = A_wait_deaf
    :: input == I_tx_fail && phase == P_ready ->
        next = P_selftest; action = A_wait_deaf
    :: input == I_tx_fail && phase == P_armed ->
        next = P_stopped; action = A_stop
    :: input == I_period_good && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_period_settled && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_period_disturbed && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_period_missed && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_period_silent && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_period_full && phase == P_stopped ->
        next = P_stopped; action = A_repeat
    :: input == I_board_ack && phase == P_stopped ->
        next = P_stopped; action = A_confirm
    :: input == I_board_moves && phase == P_stopped ->
        next = P_stopped; action = A_withdraw
    :: input == I_reset && phase == P_stopped ->
        next = P_init; action = A_begin
    :: input == I_arm && phase == P_ready ->
        next = P_armed; action = A_none
    :: input == I_own_stop && phase == P_selftest ->
        next = P_selftest; action = A_wait
    :: input == I_own_stop && phase == P_ready ->
        next = P_selftest; action = A_wait
    :: input == I_own_stop && phase == P_armed ->
        next = P_selftest; action = A_wait
    :: input == I_restart && phase == P_stopped ->
        next = P_stopped; action = A_stop
    :: input == I_restart && phase == P_init ->
        next = P_init; action = A_begin
    :: input == I_restart && phase == P_selftest ->
        next = P_init; action = A_begin
    :: input == I_restart && phase == P_ready ->
        next = P_init; action = A_begin
    :: input == I_restart && phase == P_armed ->
        next = P_init; action = A_begin
    :: input == I_kill && phase == P_stopped ->
        next = P_stopped; action = A_mute
    :: input == I_kill && phase == P_init ->
        next = P_init; action = A_mute
    :: input == I_kill && phase == P_selftest ->
        next = P_init; action = A_mute
    :: input == I_kill && phase == P_ready ->
        next = P_init; action = A_mute
    :: input == I_kill && phase == P_armed ->
        next = P_init; action = A_mute
    :: else -> next = phase; action = A_none
    fi
}
