// SPDX-License-Identifier: Apache-2.0
#include "core/monitor.hpp"

#include "core/assert.hpp"

namespace axg {

namespace {

std::uint16_t signature_of(const Answer& far, const Answer& near) noexcept {
    const bool right = far.status == AnswerStatus::ok && far.proof == Proof::far &&
                       near.status == AnswerStatus::ok && near.proof == Proof::not_proven;
    return right ? kCanarySignature : 0;
}

/// Why there is no answer; none: there is one.
StopReason reason_of(AnswerStatus status) noexcept {
    switch (status) {
        case AnswerStatus::ok:
            return StopReason::none;
        case AnswerStatus::too_many_node_pairs:
        case AnswerStatus::too_many_triangle_pairs:
        case AnswerStatus::too_many_rechecks:
            return StopReason::capacity;
        case AnswerStatus::not_run:
        case AnswerStatus::bad_question:
        case AnswerStatus::bad_rounding:
            break;
    }
    return StopReason::engine;
}

/// Why a pair is not proven apart; none: it is.
StopReason judge_pair(const Answer& surfaces, const ContainmentAnswer& solids) noexcept {
    if (surfaces.status != AnswerStatus::ok) {
        return reason_of(surfaces.status);
    }
    if (surfaces.proof != Proof::far) {
        return StopReason::contact;
    }
    if (solids.status != AnswerStatus::ok) {
        return reason_of(solids.status);
    }
    return solids.containment == Containment::none ? StopReason::none : StopReason::contained;
}

/// Fills in what this cycle proved; reason none: everything.
void judge(const PairPlan& plan, std::span<const Answer> answers,
           std::span<const ContainmentAnswer> solids, CycleResult& result) noexcept {
    if (plan.status != PlanStatus::ok) {
        result.reason = plan.status == PlanStatus::unknown_tool ? StopReason::tool
                        : plan.status == PlanStatus::not_run    ? StopReason::engine
                                                                : StopReason::picture;
        return;
    }
    AXG_ASSERT(answers.size() == plan.count + 2U);
    AXG_ASSERT(solids.size() == plan.count);
    result.canary_signature = signature_of(answers[plan.count], answers[plan.count + 1U]);
    if (result.canary_signature != kCanarySignature) {
        result.reason = StopReason::canary;
    }
    for (std::uint32_t i = plan.count; i-- > 0;) {  // the first pair in order names the stop
        const StopReason reason = judge_pair(answers[i], solids[i]);
        if (reason != StopReason::none) {
            ++result.not_proven;
            result.pair = plan.pair[i];
            result.reason = reason;
        }
    }
}

void decide(MonitorState& state, bool ready, CycleResult& result) noexcept {
    ++state.cycles;
    if (result.reason != StopReason::none && !state.is_stopped) {
        state.is_stopped = true;
        state.reason = result.reason;
        state.pair = result.pair;
        result.stops_now = true;
    }
    result.has_permit = ready && !state.is_stopped;
    if (result.has_permit) {
        ++state.permits;
    }
    ++state.live_counter;
}

}  // namespace

const char* to_text(StopReason reason) noexcept {
    switch (reason) {
        case StopReason::none:
            return "none";
        case StopReason::contact:
            return "contact";
        case StopReason::contained:
            return "contained";
        case StopReason::capacity:
            return "capacity";
        case StopReason::engine:
            return "engine";
        case StopReason::canary:
            return "canary";
        case StopReason::tool:
            return "tool";
        case StopReason::picture:
            return "picture";
        case StopReason::input:
            return "input";
    }
    return "unknown";
}

CycleResult step(MonitorState& state, const PairPlan& plan, std::span<const Answer> answers,
                 std::span<const ContainmentAnswer> solids, bool ready) noexcept {
    CycleResult result;
    judge(plan, answers, solids, result);
    decide(state, ready, result);
    return result;
}

CycleResult step_input_lost(MonitorState& state) noexcept {
    CycleResult result;
    result.reason = StopReason::input;
    decide(state, false, result);
    return result;
}

void reset(MonitorState& state) noexcept {
    state.is_stopped = false;
    state.reason = StopReason::none;
    state.pair = kNoIndex;
}

}  // namespace axg
