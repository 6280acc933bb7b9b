// SPDX-License-Identifier: Apache-2.0
// What a board on the bench does wrong (bench_board.hpp).
#pragma once

namespace axg::test {

/// One rule of docs/reference/board.md broken.
enum class Broken {
    nothing,
    ends_from_arrival,  // end = arrival + n T
    newest_end,         // a newer permit with an earlier end shortens
    takes_old_echo,
    takes_any_echo,
    takes_any_lap,
    takes_any_nonce,
    takes_former_nonce,
    takes_any_answer,
    takes_live_again,
    takes_live_16,
    live_window_of_3,
    ignores_inverted,  // the plain frame is enough
    takes_either_order,
    takes_one_bit,
    takes_twin_of_another,
    takes_late_twin,
    takes_interleaved,
    takes_short_frames,
    takes_any_word,
    takes_cap_251,
    takes_level_4,
    takes_samples_0,
    takes_samples_above,
    refuses_slow,
    runs_on_jog,
    jogs_on_run,
    moves_on_first_permit,
    moves_without_hashes,
    answers_wrong_hash,
    ignores_stop_frame,
    ignores_long_stop_frame,
    ignores_stop_word,
    goes_on_after_end,
    ends_do_not_latch,
    resumes_by_itself,
    arms_by_itself,
    keeps_nonce,
    reacts_late,
    brakes_softly,
    turns_round,
    session_is_rare,
    counts_no_laps,
    loses_samples,
    period_is_long,
    says_it_stands,
    acks_without_promise,
    acks_at_once,  // before it is below the cap
    never_acks,
    hold_is_a_stop,
    changes_tool_early,
    changes_tool_in_stop,
    moves_another_axis,    // Y, from the stop on: it rested
    jerks_another_axis,    // Y, for 40 ms
    creeps_on_another,     // Y, 2 mm/s for 20 s
    moves_later,           // Y, 0.6 s after the stop
    resumes_later,         // 3 s after the stop: a person walks over
    moves_after_the_last,  // Y, once the test is over
    moves_without_arming,  // from power-up
    never_rests,           // after a stop it creeps on
    is_not_homed,          // no rule, but no sample counts
    count
};

}  // namespace axg::test
