/* SPDX-License-Identifier: Apache-2.0
 * The guard, its receiver, and a world that does anything at any time: frames of one sample from
 * two senders, late, twice, mixed or never; evaluations late or wrong; faults, a bus that fails, a
 * process that is killed or held; a person who resets and arms at random. The transition table is
 * the one of core/guard/guard_table.hpp; what is done with it (guard_step) is held to
 * core/guard/guard_state.cpp state by state: -DRELATION prints every step there is.
 * Each property is an assertion; each -DBREAK=... is a mistake that one of them must find. Run by
 * check_model.py.
 * Properties, assumptions, figures: docs/reference/states.md. */
#include "guard_table.pml"

#define QUIET 2

/* The mistakes; 0 is the guard as it is. */
#ifndef BREAK
#define BREAK 0
#endif
#define LATE_COUNTS 1
#define OLD_COUNTS 2
#define ONE_SNAPSHOT 3
#define FAULTY_RESET 4
#define TIMER_PERMITS 5
#define FAULT_STAYS 6
#define TX_FAIL_STAYS 7
#define RESET_ARMS 8
#define ARM_RESETS 9
#define RESTART_UNLATCHES 10
#define KILL_STAYS 11
#define TX_FAIL_UNLATCHES 12
#define STOP_ONCE 13
#define NO_SELFTEST 14
#define NEVER_READY 15
#define DISTURBED_IS_GOOD 16
#define MISSED_IS_NOTHING 17
#define CONFIRMED_FOR_EVER 18
#define OWN_STOP_STAYS 19

/* Events. */
#define K_nothing 0
#define K_snapshot 1
#define K_deadline 2
#define K_fault_reported 3
#define K_fault_stop 4
#define K_tx_ok 5
#define K_tx_fail 6
#define K_board_ack 7
#define K_reset_edge 8
#define K_arm 9
#define K_loaded 10
#define K_tested 11
#define K_restart 12
#define K_kill 13
#define K_board_moves 14
#define K_own_stop 16

/* The guard: struct Guard without cause and period, of which no rule reads more than "this one". */
byte phase = P_init;
bit tested, heard, proven, confirmed;
byte quiet, good, held, bad;

/* The event: set before a choice is left, and nothing again after each step. */
byte kind;
bit event_proven;
byte event_late, event_age, event_samples;

/* Scratch of one step: what the table says, what is sent. Not part of a state. */
hidden byte input, next, action, sends_permit, sends_stop;

inline forget() {
    tested = 0; heard = 0; proven = 0; confirmed = 0;
    quiet = 0; good = 0; held = 0; bad = 0
}

inline classify() {
    if
    :: kind == K_snapshot ->
        if
        :: event_proven && !proven && (event_late == 0 || BREAK == LATE_COUNTS) &&
           (event_age + 1 <= event_samples || BREAK == OLD_COUNTS) -> input = I_proven
        :: else -> input = I_refused
        fi
    :: kind == K_deadline ->
        if
        :: (!proven || quiet == 0) && bad + BAD_WEIGHT >= BAD_LIMIT -> input = I_period_full
        :: else ->
            if
            :: !proven && held <= 1 -> input = I_period_silent
            :: !proven && held > 1 -> input = I_period_missed
            :: proven && quiet == 0 -> input = I_period_disturbed
            :: proven && quiet > 0 ->
                if
                :: tested && heard && (good + 1 >= SNAPSHOTS_MIN || BREAK == ONE_SNAPSHOT) ->
                    input = I_period_settled
                :: else -> input = I_period_good
                fi
            fi
        fi
    :: kind == K_reset_edge ->
        if
        :: confirmed && (quiet == QUIET || BREAK == FAULTY_RESET) -> input = I_reset
        :: else -> input = I_reset_refused
        fi
    :: kind == K_fault_reported -> input = I_fault_reported
    :: kind == K_fault_stop -> input = I_fault_stop
    :: kind == K_tx_ok -> input = I_tx_ok
    :: kind == K_tx_fail -> input = I_tx_fail
    :: kind == K_board_ack -> input = I_board_ack
    :: kind == K_board_moves -> input = I_board_moves
    :: kind == K_arm -> input = I_arm
    :: kind == K_loaded -> input = I_loaded
    :: kind == K_tested -> input = I_tested
    :: kind == K_restart -> input = I_restart
    :: kind == K_kill -> input = I_kill
    :: kind == K_own_stop -> input = I_own_stop
    fi
}

inline mark_period() {
    if
    :: kind == K_deadline ->
        proven = 0;
        held = (held > 0 -> held - 1 : 0);
        quiet = (quiet < QUIET -> quiet + 1 : QUIET)
    :: input == I_proven ->
        proven = 1;
        held = (held > event_samples + 1 -> held : event_samples + 1)
    :: kind == K_fault_reported || kind == K_fault_stop || kind == K_tx_fail -> quiet = 0
    :: else
    fi
}

inline act() {
    if
    :: action == A_none
    :: action == A_begin || action == A_mute -> forget()
    :: action == A_pass -> tested = 1
    :: action == A_hear -> heard = 1
    :: action == A_wait -> good = 0
    :: action == A_wait_deaf -> heard = 0; good = 0
    :: action == A_good ->
        good = (good + 1 < SNAPSHOTS_MIN -> good + 1 : SNAPSHOTS_MIN);
        bad = (bad > 0 -> bad - 1 : 0)
    :: action == A_disturbed -> bad = bad + BAD_WEIGHT
    :: action == A_missed -> bad = bad + BAD_WEIGHT
    :: action == A_permit -> sends_permit = 1
    :: action == A_stop -> forget(); sends_stop = 1
    :: action == A_repeat -> sends_stop = !confirmed
    :: action == A_confirm -> confirmed = 1
    :: action == A_withdraw -> confirmed = 0
    fi
}

/* Mistakes in the table. */
inline break_table() {
    if
    :: BREAK == TIMER_PERMITS && phase == P_armed && kind == K_deadline ->
        action = A_permit
    :: BREAK == FAULT_STAYS && phase == P_armed && input == I_fault_stop ->
        next = P_armed; action = A_none
    :: BREAK == TX_FAIL_STAYS && phase == P_armed && input == I_tx_fail ->
        next = P_armed; action = A_none
    :: BREAK == RESET_ARMS && input == I_reset && phase == P_stopped ->
        next = P_armed
    :: BREAK == ARM_RESETS && input == I_arm && phase == P_stopped ->
        next = P_init
    :: BREAK == RESTART_UNLATCHES && input == I_restart ->
        next = P_init; action = A_begin
    :: BREAK == KILL_STAYS && input == I_kill && phase == P_armed ->
        next = P_armed; action = A_none
    :: BREAK == OWN_STOP_STAYS && input == I_own_stop && phase == P_armed ->
        next = P_armed; action = A_none
    :: BREAK == TX_FAIL_UNLATCHES && input == I_tx_fail && phase == P_stopped ->
        next = P_init; action = A_begin
    :: BREAK == STOP_ONCE && action == A_repeat ->
        action = A_none
    :: BREAK == CONFIRMED_FOR_EVER && action == A_withdraw ->
        action = A_none
    :: BREAK == NO_SELFTEST && input == I_loaded && phase == P_init ->
        next = P_ready
    :: BREAK == NEVER_READY && next == P_ready && phase == P_selftest ->
        next = P_selftest
    :: BREAK == DISTURBED_IS_GOOD && action == A_disturbed ->
        action = A_good
    :: BREAK == MISSED_IS_NOTHING && action == A_missed ->
        action = A_none
    :: else
    fi
}

inline guard_step() {
    sends_permit = 0; sends_stop = 0;
    classify();
    look_up(input, phase);
    break_table();
    mark_period();
    act();
    phase = next
}

#ifdef RELATION

inline print_state() {
    printf("%d %d %d %d %d %d %d %d %d ", phase, tested, heard, proven, confirmed, quiet, good,
           held, bad)
}

inline print_event() {
    if
    :: kind == K_snapshot -> printf("snapshot")
    :: kind == K_deadline -> printf("deadline")
    :: kind == K_fault_reported -> printf("fault_reported")
    :: kind == K_fault_stop -> printf("fault_stop")
    :: kind == K_tx_ok -> printf("tx_ok")
    :: kind == K_tx_fail -> printf("tx_fail")
    :: kind == K_board_ack -> printf("board_ack")
    :: kind == K_board_moves -> printf("board_moves")
    :: kind == K_reset_edge -> printf("reset_edge")
    :: kind == K_arm -> printf("arm")
    :: kind == K_loaded -> printf("loaded")
    :: kind == K_tested -> printf("tested")
    :: kind == K_restart -> printf("restart")
    :: kind == K_kill -> printf("kill")
    :: kind == K_own_stop -> printf("own_stop")
    fi;
    printf(" %d %d %d %d : ", event_proven, event_late, event_age, event_samples)
}

/* Any event in any state. Run with -DPRINTF: each state is left once by each event. */
active proctype world() {
    do
    :: atomic {
        event_proven = 0; event_late = 0; event_age = 0; event_samples = 0;
        if
        :: kind = K_snapshot;
            if :: event_proven = 0 :: event_proven = 1 fi;
            if :: event_late = 0 :: event_late = 1 :: event_late = 2 fi;
            if :: event_age = 0 :: event_age = 1 :: event_age = 2 :: event_age = 3 fi;
            if :: event_samples = SAMPLES_LEAST :: event_samples = SAMPLES_MOST fi
        :: kind = K_deadline
        :: kind = K_fault_reported
        :: kind = K_fault_stop
        :: kind = K_tx_ok
        :: kind = K_tx_fail
        :: kind = K_board_ack
        :: kind = K_board_moves
        :: kind = K_reset_edge
        :: kind = K_arm
        :: kind = K_loaded
        :: kind = K_tested
        :: kind = K_restart
        :: kind = K_kill
        :: kind = K_own_stop
        fi;
        d_step {
            printf("STEP "); print_state(); print_event();
            guard_step();
            print_state(); printf("%d %d\n", sends_permit, sends_stop);
            kind = K_nothing; event_proven = 0; event_late = 0; event_age = 0; event_samples = 0
        }
    }
    od
}

#else
#include "guard_world.pml"
#endif
