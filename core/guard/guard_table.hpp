// SPDX-License-Identifier: Apache-2.0
// The table of the guard's state machine: for each input and each phase, the next phase and one
// action. The model that is checked reads the same table (tests/model/guard_table.pml is written
// from it). Source: docs/reference/states.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/guard/guard_state.hpp"

namespace axg {

/// An event, classified with the counters.
enum class GuardInput : std::uint8_t {
    loaded = 0,
    tested,
    proven,            // a snapshot: of this period, young enough, proven, the first such
    refused,           // any other snapshot
    period_good,       // the period had a proven snapshot, and no fault
    period_settled,    // the same, and with it everything that ready needs
    period_disturbed,  // a proven snapshot, and a fault that is only reported
    period_missed,     // no proven snapshot
    period_silent,     // the same, and the permit that ends last has ended
    period_full,       // disturbed or missed, and the leaky count is full
    fault_reported,
    fault_stop,
    tx_ok,
    tx_fail,
    board_ack,
    board_moves,
    reset_refused,  // a fault is present, or the stop is not confirmed
    reset,
    arm,
    restart,
    kill,
    own_stop,  // a snapshot in a stop of the board's own
};
inline constexpr std::uint32_t kGuardInputs = 22;

enum class GuardAction : std::uint8_t {
    none = 0,
    begin,      // forget all evidence
    pass,       // the self-test has passed
    hear,       // an own frame was seen
    wait,       // count good periods from 0
    wait_deaf,  // the same, and an own frame must be seen again
    good,       // count a good period; the count of bad ones leaks
    disturbed,  // count a bad period that had its permit
    missed,     // count a bad period without one
    permit,     // send the permit
    stop,       // forget all evidence, send the stop
    repeat,     // send the stop again unless it is confirmed
    confirm,    // the stop is confirmed
    withdraw,   // it is no longer confirmed
    mute,       // the process ends: no frames
};
inline constexpr std::uint32_t kGuardActions = 15;

struct GuardRow {
    GuardInput input;
    GuardPhase phase;
    GuardPhase next;
    GuardAction action;
};

/// Every row with an action or another phase. In all others the phase stays, without an action.
inline constexpr auto kGuardRows = [] {
    using enum GuardAction;
    using enum GuardPhase;
    using In = GuardInput;
    return std::to_array<GuardRow>({
        {In::loaded, init, selftest, begin},
        {In::tested, selftest, selftest, pass},
        {In::proven, armed, armed, permit},

        {In::period_good, selftest, selftest, good},
        {In::period_good, ready, ready, good},
        {In::period_good, armed, armed, good},
        {In::period_settled, selftest, ready, good},
        {In::period_settled, ready, ready, good},
        {In::period_settled, armed, armed, good},
        {In::period_disturbed, selftest, selftest, wait},
        {In::period_disturbed, ready, ready, disturbed},
        {In::period_disturbed, armed, armed, disturbed},
        {In::period_missed, selftest, selftest, wait},
        {In::period_missed, ready, ready, missed},
        {In::period_missed, armed, armed, missed},
        {In::period_silent, selftest, selftest, wait},
        {In::period_silent, ready, selftest, wait},
        {In::period_silent, armed, stopped, stop},
        {In::period_full, selftest, selftest, wait},
        {In::period_full, ready, selftest, wait},
        {In::period_full, armed, stopped, stop},

        {In::fault_stop, init, stopped, stop},
        {In::fault_stop, selftest, stopped, stop},
        {In::fault_stop, ready, stopped, stop},
        {In::fault_stop, armed, stopped, stop},
        {In::tx_ok, selftest, selftest, hear},
        {In::tx_fail, selftest, selftest, wait_deaf},
        {In::tx_fail, ready, selftest, wait_deaf},
        {In::tx_fail, armed, stopped, stop},

        {In::period_good, stopped, stopped, repeat},
        {In::period_settled, stopped, stopped, repeat},
        {In::period_disturbed, stopped, stopped, repeat},
        {In::period_missed, stopped, stopped, repeat},
        {In::period_silent, stopped, stopped, repeat},
        {In::period_full, stopped, stopped, repeat},
        {In::board_ack, stopped, stopped, confirm},
        {In::board_moves, stopped, stopped, withdraw},
        {In::reset, stopped, init, begin},
        {In::arm, ready, armed, none},
        {In::own_stop, selftest, selftest, wait},
        {In::own_stop, ready, selftest, wait},
        {In::own_stop, armed, selftest, wait},

        {In::restart, stopped, stopped, stop},
        {In::restart, init, init, begin},
        {In::restart, selftest, init, begin},
        {In::restart, ready, init, begin},
        {In::restart, armed, init, begin},
        {In::kill, stopped, stopped, mute},
        {In::kill, init, init, mute},
        {In::kill, selftest, init, mute},
        {In::kill, ready, init, mute},
        {In::kill, armed, init, mute},
    });
}();

/// The row for any input and phase: the table is total.
[[nodiscard]] constexpr GuardRow guard_row(GuardInput input, GuardPhase phase) noexcept {
    for (const GuardRow& row : kGuardRows) {
        if (row.input == input && row.phase == phase) {
            return row;
        }
    }
    return {input, phase, phase, GuardAction::none};
}

}  // namespace axg
