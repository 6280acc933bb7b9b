// SPDX-License-Identifier: Apache-2.0
#include "core/guard/monitor.hpp"

#include "core/base/assert.hpp"

namespace axg {

namespace {

/// Why there is no result; none: there is one.
StopReason reason_of(QueryStatus status) noexcept {
    switch (status) {
        case QueryStatus::ok:
            return StopReason::none;
        case QueryStatus::too_many_node_pairs:
        case QueryStatus::too_many_triangle_pairs:
        case QueryStatus::too_many_rechecks:
        case QueryStatus::too_many_leaf_pairs:
        case QueryStatus::too_many_box_rows:
            return StopReason::capacity;
        case QueryStatus::not_run:
        case QueryStatus::bad_query:
        case QueryStatus::bad_rounding:
            break;
    }
    return StopReason::engine;
}

StopReason reason_of(SnapshotStatus status) noexcept {
    return status == SnapshotStatus::unknown_tool  ? StopReason::tool
           : status == SnapshotStatus::not_run     ? StopReason::engine
           : status == SnapshotStatus::left_path   ? StopReason::left_path
           : status == SnapshotStatus::left_jog    ? StopReason::left_jog
           : status == SnapshotStatus::left_travel ? StopReason::left_travel
           : status == SnapshotStatus::left_limits ? StopReason::left_limits
           : status == SnapshotStatus::own_stop    ? StopReason::own_stop
                                                   : StopReason::snapshot;
}

StopReason judge_containment(const ContainmentResult& containment_result) noexcept {
    if (containment_result.status != QueryStatus::ok) {
        return reason_of(containment_result.status);
    }
    return containment_result.containment == Containment::none ? StopReason::none
                                                               : StopReason::contained;
}

/// Why a pair is not proven apart; none: it is.
StopReason judge_pair(const QueryResult& surfaces,
                      const ContainmentResult& containment_result) noexcept {
    if (surfaces.status != QueryStatus::ok) {
        return reason_of(surfaces.status);
    }
    if (surfaces.proof != Proof::far) {
        return StopReason::contact;
    }
    return judge_containment(containment_result);
}

/// Why the margin of a pair is not proven to standstill; none: it is.
StopReason judge_proof(const PairProof& proof) noexcept {
    switch (proof.surfaces.proof) {
        case JointBoxProof::proven:
            return judge_containment(proof.containment_result);
        case JointBoxProof::budget_spent:
            return StopReason::predicted;
        case JointBoxProof::bad_box:
            return StopReason::snapshot;
        case JointBoxProof::not_run:
        case JointBoxProof::engine_failed:
            break;
    }
    return StopReason::engine;
}

/// Writes the results of this cycle's proofs; reason none: every pair is proven.
void prove(const PairQueries& pair_queries, std::span<const QueryResult> results,
           std::span<const ContainmentResult> containment_results, CycleResult& result) noexcept {
    if (pair_queries.status != SnapshotStatus::ok) {
        result.reason = reason_of(pair_queries.status);
        return;
    }
    AXG_ASSERT(results.size() == pair_queries.count + 2U);
    AXG_ASSERT(containment_results.size() == pair_queries.count);
    result.known_answer_signature =
        known_answer_signature(results[pair_queries.count], results[pair_queries.count + 1U]);
    if (result.known_answer_signature != kKnownAnswerSignature) {
        result.reason = StopReason::known_answer;
    }
    // The first pair in order names the stop.
    for (std::uint32_t i = pair_queries.count; i-- > 0;) {
        const StopReason reason = judge_pair(results[i], containment_results[i]);
        if (reason != StopReason::none) {
            ++result.not_proven;
            result.pair = pair_queries.pair[i];
            result.reason = reason;
        }
    }
}

void prove(const StopCycle& cycle, CycleResult& result) noexcept {
    if (cycle.status != SnapshotStatus::ok) {
        result.reason = reason_of(cycle.status);
        result.limit = has_limit(result.reason) ? cycle.limit : LimitFact{};
        return;
    }
    result.known_answer_signature = cycle.known_answer_signature;
    if (result.known_answer_signature != kKnownAnswerSignature) {
        result.reason = StopReason::known_answer;
    }
    for (std::size_t i = cycle.proofs.size(); i-- > 0;) {  // the first pair in order names the stop
        const StopReason reason = judge_proof(cycle.proofs[i]);
        if (reason != StopReason::none) {
            ++result.not_proven;
            result.pair = cycle.proofs[i].pair;
            result.reason = reason;
        }
    }
}

/// Whether the reason only withholds a permit while the guard is not armed.
bool may_be_withheld(StopReason reason) noexcept {
    return reason == StopReason::predicted || reason == StopReason::left_path ||
           reason == StopReason::left_jog || reason == StopReason::left_travel ||
           reason == StopReason::left_limits;  // left_cap: only of an armed guard
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
        case StopReason::predicted:
            return "predicted";
        case StopReason::capacity:
            return "capacity";
        case StopReason::engine:
            return "engine";
        case StopReason::known_answer:
            return "known_answer";
        case StopReason::tool:
            return "tool";
        case StopReason::snapshot:
            return "snapshot";
        case StopReason::left_path:
            return "left_path";
        case StopReason::input:
            return "input";
        case StopReason::left_jog:
            return "left_jog";
        case StopReason::left_travel:
            return "left_travel";
        case StopReason::left_limits:
            return "left_limits";
        case StopReason::left_cap:
            return "left_cap";
        case StopReason::own_stop:
            return "own_stop";
    }
    return "unknown";
}

const char* to_text(CapBreak kind) noexcept {
    switch (kind) {
        case CapBreak::none:
            return "none";
        case CapBreak::too_fast:
            return "too_fast";
        case CapBreak::not_acknowledged:
            return "not_acknowledged";
        case CapBreak::unknown_permit:
            return "unknown_permit";
    }
    return "unknown";
}

CycleResult judge(const PairQueries& pair_queries, std::span<const QueryResult> results,
                  std::span<const ContainmentResult> containment_results, bool ready) noexcept {
    CycleResult result;
    prove(pair_queries, results, containment_results, result);
    result.is_stop = result.reason != StopReason::none;
    result.has_permit = ready && !result.is_stop;
    return result;
}

CycleResult judge(const StopCycle& cycle, bool ready, bool is_armed) noexcept {
    CycleResult result;
    prove(cycle, result);
    result.is_jog = cycle.is_jog;
    result.samples = cycle.samples;
    const bool is_proven = result.reason == StopReason::none;
    const bool may_wait = may_be_withheld(result.reason);
    // The guard stops a machine that moves without a permit, once the certificate is settled. A
    // person chooses a jog: one that is not proven is no motion yet.
    const bool is_loose = ready && cycle.is_settled && cycle.is_moving && !cycle.is_jog;
    // A board that stops by itself needs no stop, and no permit.
    const bool is_stopping = result.reason == StopReason::own_stop;
    result.is_stop = !is_proven && !is_stopping && (is_armed || is_loose || !may_wait);
    result.has_permit = ready && is_proven && !cycle.begins_jog;
    return result;
}

}  // namespace axg
