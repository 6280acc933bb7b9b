// SPDX-License-Identifier: Apache-2.0
#include "core/guard/guard_state.hpp"

#include <algorithm>

#include "core/base/assert.hpp"
#include "core/guard/guard_table.hpp"

namespace axg {

namespace {

/// Whether a snapshot is the first proven one of this period, and its permit does not end within a
/// period.
bool is_usable(const Guard& guard, const GuardEvent& event, const GuardLimits& limits) noexcept {
    return event.is_proven && event.period == guard.period && event.age_us >= 0 &&
           event.age_us + limits.period_us <= event.samples * limits.period_us && !guard.is_proven;
}

/// Classifies a period at its end.
GuardInput judge_period(const Guard& guard, const GuardLimits& limits) noexcept {
    const bool is_bad = !guard.is_proven || guard.quiet == 0;
    if (is_bad && guard.bad + limits.bad_weight >= limits.bad_limit) {
        return GuardInput::period_full;
    }
    if (!guard.is_proven) {
        return guard.held <= 1 ? GuardInput::period_silent : GuardInput::period_missed;
    }
    if (is_bad) {
        return GuardInput::period_disturbed;
    }
    const bool is_settled =
        guard.is_tested && guard.is_heard && guard.good + 1 >= limits.snapshots_min;
    return is_settled ? GuardInput::period_settled : GuardInput::period_good;
}

/// Returns the row's input. An event that is not in the list stops.
GuardInput classify(const Guard& guard, const GuardEvent& event,
                    const GuardLimits& limits) noexcept {
    switch (event.kind) {
        case GuardEventKind::fault:
            return is_reported_only(event.fault) ? GuardInput::fault_reported
                                                 : GuardInput::fault_stop;
        case GuardEventKind::loaded:
            return GuardInput::loaded;
        case GuardEventKind::tested:
            return GuardInput::tested;
        case GuardEventKind::snapshot:
            return is_usable(guard, event, limits) ? GuardInput::proven : GuardInput::refused;
        case GuardEventKind::deadline:
            return judge_period(guard, limits);
        case GuardEventKind::tx_ok:
            return GuardInput::tx_ok;
        case GuardEventKind::tx_fail:
            return GuardInput::tx_fail;
        case GuardEventKind::board_ack:
            return GuardInput::board_ack;
        case GuardEventKind::board_moves:
            return GuardInput::board_moves;
        case GuardEventKind::reset_edge:
            return guard.quiet == kQuiet && guard.is_confirmed ? GuardInput::reset
                                                               : GuardInput::reset_refused;
        case GuardEventKind::arm:
            return GuardInput::arm;
        case GuardEventKind::restart:
            return GuardInput::restart;
        case GuardEventKind::kill:
            return GuardInput::kill;
        case GuardEventKind::own_stop:
            return GuardInput::own_stop;
    }
    return GuardInput::fault_stop;
}

/// Marks that belong to the period, whatever the phase.
void mark_period(Guard& guard, GuardInput input, const GuardEvent& event) noexcept {
    if (event.kind == GuardEventKind::deadline) {
        ++guard.period;
        guard.held -= std::min(guard.held, 1U);
        guard.is_proven = false;
        guard.quiet = static_cast<std::uint8_t>(std::min(guard.quiet + 1, int{kQuiet}));
    }
    if (input == GuardInput::proven) {
        guard.is_proven = true;
        guard.held = std::max(guard.held, event.samples + 1U);
    }
    if (input == GuardInput::fault_reported || input == GuardInput::fault_stop ||
        input == GuardInput::tx_fail) {
        guard.quiet = 0;
    }
}

/// Discards the evidence only: phase, cause and period stay.
void forget(Guard& guard) noexcept {
    guard.is_tested = guard.is_heard = guard.is_proven = guard.is_confirmed = false;
    guard.quiet = 0;
    guard.good = guard.held = guard.bad = 0;
}

void wait(Guard& guard) noexcept {
    guard.good = 0;
}

/// Returns the cause of a new stop: by the input, else the event's fault, else refused.
GuardFault cause_of(GuardInput input, const GuardEvent& event) noexcept {
    switch (input) {
        case GuardInput::period_silent:
            return GuardFault::silence;
        case GuardInput::period_full:
            return GuardFault::flapping;
        case GuardInput::tx_fail:
            return GuardFault::output;
        default:
            return event.fault == GuardFault::none ? GuardFault::refused : event.fault;
    }
}

void act(Guard& guard, GuardAction action, const GuardLimits& limits,
         GuardOutput& output) noexcept {
    switch (action) {
        case GuardAction::none:
            break;
        case GuardAction::begin:
        case GuardAction::mute:
            forget(guard);
            break;
        case GuardAction::pass:
            guard.is_tested = true;
            break;
        case GuardAction::hear:
            guard.is_heard = true;
            break;
        case GuardAction::wait_deaf:
            guard.is_heard = false;
            wait(guard);
            break;
        case GuardAction::wait:
            wait(guard);
            break;
        case GuardAction::good:
            guard.good = std::min(guard.good + 1, limits.snapshots_min);
            guard.bad -= std::min(guard.bad, 1U);
            break;
        case GuardAction::disturbed:
        case GuardAction::missed:
            guard.bad += limits.bad_weight;
            break;
        case GuardAction::permit:
            output.sends_permit = true;
            break;
        case GuardAction::stop:
            forget(guard);
            output.sends_stop = true;
            break;
        case GuardAction::repeat:
            output.sends_stop = !guard.is_confirmed;
            break;
        case GuardAction::confirm:
            guard.is_confirmed = true;
            break;
        case GuardAction::withdraw:
            guard.is_confirmed = false;
            break;
    }
}

GuardHeartbeat heartbeat_of(GuardPhase phase, GuardAction action) noexcept {
    if (phase == GuardPhase::init || action == GuardAction::mute) {
        return GuardHeartbeat::silent;
    }
    if (phase == GuardPhase::selftest) {
        return GuardHeartbeat::starting;
    }
    return phase == GuardPhase::stopped ? GuardHeartbeat::tripped : GuardHeartbeat::running;
}

}  // namespace

const char* to_text(GuardPhase phase) noexcept {
    switch (phase) {
        case GuardPhase::stopped:
            return "stopped";
        case GuardPhase::init:
            return "init";
        case GuardPhase::selftest:
            return "selftest";
        case GuardPhase::ready:
            return "ready";
        case GuardPhase::armed:
            return "armed";
    }
    return "unknown";
}

const char* to_text(GuardFault fault) noexcept {
    switch (fault) {
        case GuardFault::none:
            return "none";
        case GuardFault::input_noise:
            return "input_noise";
        case GuardFault::recorder:
            return "recorder";
        case GuardFault::input:
            return "input";
        case GuardFault::verdict:
            return "verdict";
        case GuardFault::engine:
            return "engine";
        case GuardFault::gap:
            return "gap";
        case GuardFault::second_guard:
            return "second_guard";
        case GuardFault::refused:
            return "refused";
        case GuardFault::silence:
            return "silence";
        case GuardFault::flapping:
            return "flapping";
        case GuardFault::output:
            return "output";
        case GuardFault::latched:
            return "latched";
        case GuardFault::foreign_stop:
            return "foreign_stop";
    }
    return "unknown";
}

GuardEvent guard_event_of(const CycleResult& cycle, std::uint32_t period,
                          std::int64_t age_us) noexcept {
    if (cycle.is_stop) {
        return {.kind = GuardEventKind::fault, .fault = GuardFault::verdict};
    }
    return {.kind = cycle.reason == StopReason::own_stop ? GuardEventKind::own_stop
                                                         : GuardEventKind::snapshot,
            .is_proven = cycle.has_permit && cycle.reason == StopReason::none,
            .period = period,
            .age_us = age_us,
            .samples = cycle.samples};
}

Guard start_guard(bool is_latched) noexcept {
    Guard guard;
    guard.phase = is_latched ? GuardPhase::stopped : GuardPhase::init;
    guard.cause = is_latched ? GuardFault::latched : GuardFault::none;
    return guard;
}

GuardOutput on_event(Guard& guard, const GuardEvent& event, const GuardLimits& limits) noexcept {
    AXG_ASSERT(static_cast<std::uint32_t>(guard.phase) < kGuardPhases);
    const GuardInput input = classify(guard, event, limits);
    const GuardRow row = guard_row(input, guard.phase);
    mark_period(guard, input, event);
    GuardOutput output;
    act(guard, row.action, limits, output);
    if (row.next != guard.phase) {
        guard.cause = row.next == GuardPhase::stopped ? cause_of(input, event) : GuardFault::none;
    }
    guard.phase = row.next;
    output.heartbeat = heartbeat_of(row.next, row.action);
    return output;
}

}  // namespace axg
