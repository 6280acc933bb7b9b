/* SPDX-License-Identifier: Apache-2.0
 * What happens to the guard, a witness that knows only what happened, and the eight properties.
 * Included by guard.pml. Two symmetries keep it small. Counters of samples are modulo 4 and kept as
 * ages, relative to the current sample: the rules read differences alone. The three frames of a
 * sample are interchangeable: what counts is how many there are, and whether one came before. */

#define K_frame 15

#define CHAOS 0
#define HEALTHY 1      /* everything works, a person resets and arms */
#define FLAP_FAULT 2   /* every second period has a reported fault */
#define FLAP_MISSED 3  /* every second period is silent */
#define FLAP_PROOF 4   /* every second period is not proven */
#define PERIODS_MAX 7  /* six whole ones suffice with these limits, five do not */

/* -DONLY=n asks for property n alone. */
#ifdef ONLY
#define ASKED(n) (n == ONLY)
#else
#define ASKED(n) (true)
#endif

#define OLD 3   /* periods; older is not told apart */
#define NONE 4

byte mode;
byte step, periods;  /* of a script */
bit alive = 1;

/* The receiver: the set being put together, the snapshot used last, the newest snapshot. */
bit listens = 1;         /* not INVALID */
byte set_frames;         /* of three */
bit set_foreign;         /* one of them is from the second sender */
byte set_age;
byte last_age = NONE;
byte snapshot_age = NONE;

/* One evaluation at a time, of snapshot_age. A snapshot that comes meanwhile is not kept. */
bit evaluates;
byte evaluated_late;     /* periods since it began */

/* A frame: set before a choice is left, nothing again after each step. */
byte frame_age;
bit frame_again;         /* one of those that the set has */
bit frame_foreign;

/* The witness. */
bit w_proof;                      /* this period has a proof: in time, of a young snapshot */
bit w_owes_stop;                  /* a fault came while armed */
bit w_latched, w_confirmed;       /* a stop, not reset with right; the axes stand */
bit w_noise = 1, w_noise_before = 1;  /* a fault in this period, in the last one */
bit w_tested, w_heard;            /* in selftest; no own frame failed since */
byte w_coherent;                  /* good periods in a row, in selftest */
byte w_released = 1;              /* since the stop: 1 a reset with right, 2 and then arm */

hidden byte was, delta;
hidden byte p1, p2, p3, p4, p5, p6, p7, p8;

inline forget_set() { set_frames = 0; set_foreign = 0; set_age = 0 }

inline forget_snapshot() { snapshot_age = NONE; evaluates = 0; evaluated_late = 0 }

inline give_up() { listens = 0; forget_set(); last_age = NONE; kind = K_fault_stop }

/* Differences of counters modulo 4: 1 and 2 newer, 0 the same, 3 older. */
inline receive() {
    kind = K_nothing;
    if
    :: !listens
    :: else ->
        delta = (last_age == NONE -> 1 : (last_age + 4 - frame_age) % 4);
        if
        :: delta == 0 && frame_foreign -> give_up()  /* same counter, other payload */
        :: delta == 0 && !frame_foreign || delta == 3 -> kind = K_fault_reported
        :: delta == 1 || delta == 2 ->
            delta = (set_frames == 0 -> 1 : (set_age + 4 - frame_age) % 4);
            if
            :: delta == 3 -> kind = K_fault_reported
            :: delta == 0 && set_frames > 0 && frame_again ->
                if
                :: set_foreign != frame_foreign -> give_up()
                :: else -> kind = K_fault_reported
                fi
            :: delta == 0 && !frame_again ->
                set_frames++;
                set_foreign = set_foreign | frame_foreign
            :: delta == 1 || delta == 2 ->
                kind = (set_frames == 0 -> K_nothing : K_fault_reported);  /* torn */
                set_frames = 1; set_foreign = frame_foreign; set_age = frame_age
            fi;
            if
            :: set_frames == 3 ->
                last_age = set_age;
                snapshot_age = (evaluates -> snapshot_age : set_age);
                forget_set()
            :: else
            fi
        fi
    fi
}

/* A period passes, whoever is awake. */
inline grow_older() {
    if
    :: set_frames != 0 ->
        set_age++;
        if
        :: set_age >= OLD -> forget_set()
        :: else
        fi
    :: else
    fi;
    last_age = (last_age < OLD -> last_age + 1 : last_age);
    snapshot_age = (snapshot_age < OLD -> snapshot_age + 1 : snapshot_age);
    evaluated_late = (evaluates && evaluated_late < OLD -> evaluated_late + 1 : evaluated_late)
}

inline end_evaluation(is_proven, samples) {
    kind = K_snapshot;
    event_proven = is_proven; event_late = evaluated_late; event_age = snapshot_age;
    event_samples = samples;
    forget_snapshot()
}

/* Anything that can happen to a process that lives. */
inline happen() {
    if
    :: kind = K_frame;
        if :: frame_again = 0 :: set_frames > 0 -> frame_again = 1 fi;
        if  /* the board's, late by a period at most; the second sender's, with any counter */
        :: frame_age = 0
        :: frame_age = 1
        :: frame_foreign = 1;
            if :: frame_age = 0 :: frame_age = 1 :: frame_age = 2 :: frame_age = 3 fi
        fi
    :: snapshot_age != NONE && !evaluates -> evaluates = 1
    :: evaluates -> end_evaluation(1, SAMPLES_LEAST)
    :: evaluates -> end_evaluation(1, SAMPLES_MOST)
    :: evaluates -> end_evaluation(0, SAMPLES_LEAST)
    :: listens && last_age == OLD -> give_up()  /* stale: seen sooner or later */
    :: kind = K_deadline
    :: kind = K_fault_reported
    :: kind = K_fault_stop
    :: kind = K_fault_stop; grow_older()  /* held for a while; the gap is seen on waking up */
    :: kind = K_fault_stop; grow_older(); grow_older(); grow_older()
    :: kind = K_tx_ok
    :: kind = K_tx_fail
    :: kind = K_board_ack
    :: kind = K_board_moves
    :: kind = K_reset_edge
    :: kind = K_arm
    :: kind = K_loaded
    :: kind = K_tested
    :: kind = K_kill
    :: evaluates -> kind = K_own_stop; forget_snapshot()
    fi
}

inline begin_script(which) {
    mode = which; forget_set(); last_age = NONE; forget_snapshot()
}

/* One period: what a person and the board do, the three frames, their evaluation, its end. */
inline follow_script() {
    if
    :: step == 0 && !alive -> kind = K_restart
    :: step == 0 && mode == FLAP_FAULT && periods % 2 == 1 -> kind = K_fault_reported
    :: step == 1 && mode == HEALTHY && phase == P_stopped -> kind = K_board_ack
    :: step == 1 && mode == HEALTHY && phase == P_init -> kind = K_loaded
    :: step == 1 && mode == HEALTHY && phase == P_selftest -> kind = K_tested
    :: step == 1 && mode == HEALTHY && phase == P_ready -> kind = K_arm
    :: step == 2 && mode == HEALTHY && phase == P_stopped -> kind = K_reset_edge
    :: step == 3 && mode == HEALTHY -> kind = K_tx_ok
    :: step >= 4 && step <= 6 && !(mode == FLAP_MISSED && periods % 2 == 1) ->
        kind = K_frame
    :: step == 7 && snapshot_age != NONE ->
        if
        :: mode == FLAP_PROOF && periods % 2 == 1 -> end_evaluation(0, SAMPLES_MOST)
        :: else -> end_evaluation(1, SAMPLES_MOST)
        fi
    :: step == 8 -> kind = K_deadline; periods++
    :: else
    fi;
    step = (step + 1) % 9
}

inline observe() {
    if
    :: kind == K_snapshot ->
        w_proof = w_proof || (event_proven && event_late == 0 && event_age + 1 <= event_samples)
    :: kind == K_deadline ->
        if
        :: phase == P_selftest && w_proof && !w_noise ->
            w_coherent = (w_coherent + 1 < SNAPSHOTS_MIN -> w_coherent + 1 : SNAPSHOTS_MIN)
        :: phase == P_selftest && !(w_proof && !w_noise) -> w_coherent = 0
        :: else
        fi;
        w_noise_before = w_noise; w_noise = 0; w_proof = 0
    :: kind == K_fault_reported -> w_noise = 1
    :: kind == K_fault_stop || kind == K_tx_fail ->
        w_noise = 1;
        w_heard = w_heard && kind != K_tx_fail;
        w_owes_stop = w_owes_stop || phase == P_armed
    :: kind == K_board_ack -> w_confirmed = w_latched
    :: kind == K_board_moves -> w_confirmed = 0
    :: kind == K_reset_edge && w_latched && w_confirmed && !w_noise && !w_noise_before ->
        w_latched = 0; w_released = 1; w_tested = 0; w_heard = 0; w_coherent = 0
    :: kind == K_arm && w_released == 1 -> w_released = 2
    :: kind == K_own_stop ->
        w_released = (w_released == 2 -> 1 : w_released); w_coherent = 0
    :: kind == K_tested && phase == P_selftest -> w_tested = 1
    :: kind == K_tx_ok && phase == P_selftest -> w_heard = 1
    :: kind == K_kill || kind == K_restart ->
        w_owes_stop = 0; w_proof = 0; w_confirmed = 0; w_noise = 1; w_noise_before = 1;
        w_tested = 0; w_heard = 0; w_coherent = 0
    :: else
    fi
}

/* The eight properties, in the order of docs/reference/states.md. */
inline judge() {
    p1 = !sends_permit || (was == P_armed && phase == P_armed && w_proof && w_released == 2 &&
                           kind == K_snapshot);
    p2 = !(sends_permit && w_owes_stop) &&
         !(was == P_armed && (kind == K_fault_stop || kind == K_tx_fail) &&
           !(phase == P_stopped && sends_stop));
    p3 = !(was != P_armed && phase == P_armed && w_released != 2) &&
         !(w_latched && was == P_stopped && phase != P_stopped);
    p4 = !((kind == K_restart || kind == K_kill) &&
           (phase == P_armed || (w_latched && phase != P_stopped)));
    p5 = !(kind == K_deadline && phase == P_stopped && was == P_stopped &&
           sends_stop == w_confirmed) &&
         !(kind == K_tx_fail && was == P_stopped && phase != P_stopped);
    p6 = !(was != P_armed && phase == P_armed &&
           !(w_tested && w_heard && w_coherent == SNAPSHOTS_MIN));
    p7 = mode != HEALTHY || periods < PERIODS_MAX;
    p8 = mode < FLAP_FAULT || periods < PERIODS_MAX;
    assert(p1 || !ASKED(1)); assert(p2 || !ASKED(2)); assert(p3 || !ASKED(3));
    assert(p4 || !ASKED(4)); assert(p5 || !ASKED(5)); assert(p6 || !ASKED(6));
    assert(p7 || !ASKED(7)); assert(p8 || !ASKED(8))
}

inline follow_up() {
    if
    :: phase == P_stopped && was != P_stopped ->
        w_latched = 1; w_owes_stop = 0; w_confirmed = 0; w_noise = 1; w_released = 0;
        w_tested = 0; w_heard = 0; w_coherent = 0
    :: else
    fi;
    if
    :: kind == K_deadline -> grow_older()
    :: kind == K_kill ->
        alive = 0; listens = 1; forget_set(); last_age = NONE; forget_snapshot()
    :: kind == K_restart -> alive = 1
    :: kind == K_reset_edge && was == P_stopped && phase == P_init ->
        listens = 1; forget_set(); last_age = NONE
    :: else
    fi
}

active proctype world() {
end_world:
    do
    :: atomic {
        if
        :: mode == CHAOS && evaluated_late == OLD -> kind = K_fault_stop; forget_snapshot()
        :: mode == CHAOS && evaluated_late < OLD && alive -> happen()
        :: mode == CHAOS && !alive -> kind = K_restart
        :: mode == CHAOS -> begin_script(HEALTHY)
        :: mode == CHAOS && alive && phase == P_armed ->
            if
            :: begin_script(FLAP_FAULT)
            :: begin_script(FLAP_MISSED)
            :: begin_script(FLAP_PROOF)
            fi
        :: mode == HEALTHY && phase != P_armed -> follow_script()
        :: mode > HEALTHY && phase != P_stopped -> follow_script()
        fi;
        d_step {
            if :: kind == K_frame -> receive() :: else fi;
            was = phase;
            if
            :: kind != K_nothing ->
                observe();
                guard_step();
                judge();
                follow_up()
            :: else
            fi;
            kind = K_nothing; event_proven = 0; event_late = 0; event_age = 0; event_samples = 0;
            frame_age = 0; frame_again = 0; frame_foreign = 0
        }
    }
    od
}
