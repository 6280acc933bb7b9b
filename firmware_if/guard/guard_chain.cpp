// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/guard_chain.hpp"

#include "core/collision/known_answer.hpp"

namespace axg {

GuardChain::GuardChain(const Machine& machine, Engine engine,
                       const ContainmentTest& containment_test, const ChainParts& parts)
    : machine_(machine),
      engine_(engine),
      containment_test_(containment_test),
      parts_(parts),
      cap_guard_(machine),
      reach_watch_(machine) {
    if (parts_.stop_certificate == nullptr) {
        parts_.speed_advisory = nullptr;
    }
}

void GuardChain::note_sample(const CapFacts& caps, bool is_first) noexcept {
    std::array<double, kAxesMax> errors{};
    for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
        errors[i] = parts_.stop_certificate->held_error(i);
    }
    cap_guard_.note(snapshot_, caps, is_first, errors);
    reach_watch_.note(snapshot_, is_first, errors);
}

void GuardChain::take(const ReceiverEvent& event, const CapFacts& caps) noexcept {
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        snapshot_ = event.snapshot;
        if (parts_.stop_certificate != nullptr) {
            // Before VALID the receiver may begin anew, and samples are then counted by the clock.
            const bool is_first = event.state != ReceiverState::valid;
            parts_.stop_certificate->note(snapshot_, is_first);
            note_sample(caps, is_first);
        }
    } else if (event.kind == ReceiverEvent::Kind::look_ahead &&
               parts_.stop_certificate != nullptr) {
        parts_.stop_certificate->note_path(event.look_ahead);
    }
}

void GuardChain::evaluate(const EvaluationClock& clock) {
    if (parts_.stop_certificate != nullptr) {
        cap_guard_.bound(*parts_.stop_certificate);
        parts_.stop_certificate->prove(engine_, containment_test_);
        return;
    }
    make_contact_queries(machine_, snapshot_, pair_queries_, QueryScope::needed);
    if (!is_queried()) {
        return;
    }
    if (engine_.prefers_batches) {
        evaluate_together();
    } else {
        evaluate_in_turn(clock);
    }
}

void GuardChain::evaluate_together() noexcept {
    const std::span<const Query> queries{pair_queries_.queries.data(), pair_queries_.count + 2};
    engine_(queries, {results_.data(), queries.size()});
    containment_test_.run(queries.first(pair_queries_.count),
                          {results_.data(), pair_queries_.count},
                          {contained_.data(), pair_queries_.count});
}

void GuardChain::evaluate_in_turn(const EvaluationClock& clock) {
    std::int64_t before = clock.now();
    for (std::uint32_t i = 0; i < pair_queries_.count + 2; ++i) {
        engine_({&pair_queries_.queries[i], 1}, {&results_[i], 1});
        if (i < pair_queries_.count) {
            containment_test_.run({&pair_queries_.queries[i], 1}, {&results_[i], 1},
                                  {&contained_[i], 1});
            const std::int64_t after = clock.now();
            pair_ns_[i] = after - before;
            before = after;
        }
    }
}

/// Whether a missing proof stops: while armed, and in an own stop that began under permits. That
/// stop ends the permits, but the guard stops a board that does not rest in time (left_limits).
bool GuardChain::owes_stop(bool is_armed) noexcept {
    const SnapshotStatus status = parts_.stop_certificate->cycle().status;
    has_own_stop_ = status == SnapshotStatus::own_stop
                        ? has_own_stop_ || is_armed
                        : has_own_stop_ && status == SnapshotStatus::left_limits;
    return is_armed || has_own_stop_;
}

CycleResult GuardChain::decide(bool ready, bool is_armed) noexcept {
    if (parts_.stop_certificate != nullptr) {
        parts_.stop_certificate->keep();
    }
    CycleResult result = parts_.stop_certificate == nullptr
                             ? judge(pair_queries_, results(), containment_results(), ready)
                             : judge(parts_.stop_certificate->cycle(), ready, owes_stop(is_armed));
    if (parts_.stop_certificate == nullptr) {
        result.samples = machine_.can.permit_samples.least;
    }
    if (parts_.speed_advisory != nullptr) {
        result.advisories.speed_cap = parts_.speed_advisory->cap();
    }
    if (parts_.stop_certificate != nullptr && cap_guard_.is_on()) {
        const bool is_known = parts_.speed_advisory != nullptr && parts_.speed_advisory->is_known();
        cap_guard_.judge(parts_.stop_certificate->cycle(),
                         is_known ? &parts_.speed_advisory->wish() : nullptr, is_armed, result);
    }
    if (parts_.stop_certificate != nullptr) {
        reach_watch_.judge(parts_.stop_certificate->proven_reach(), is_armed, result);
    }
    if (parts_.margin_advisory != nullptr && parts_.margin_advisory->worst() != kNoIndex) {
        const std::uint32_t pair = parts_.margin_advisory->worst();
        result.advisories.pair = pair;
        result.advisories.clearance_level = parts_.margin_advisory->clearance_levels()[pair].level;
        result.advisories.distance_mm =
            parts_.margin_advisory->clearance_levels()[pair].distance_mm;
    }
    return result;
}

/// Queries an engine that received no batch in this cycle because the host processed all stages.
/// The clocks of an idle GPU would fall and delay the next launch; a lost GPU is detected now.
/// No decision uses the results: a lost engine proves nothing from then on.
void GuardChain::keep_awake() noexcept {
    if (parts_.stop_certificate->work().batches != 0) {
        return;
    }
    const std::uint32_t mesh = known_answer_mesh_index(machine_);
    const std::array queries{known_answer_query(mesh, false), known_answer_query(mesh, true)};
    std::array<QueryResult, queries.size()> results;
    engine_(queries, results);
}

void GuardChain::update_advisories() noexcept {
    if (parts_.stop_certificate != nullptr && engine_.host.stages != 0) {
        keep_awake();
    }
    if (parts_.stop_certificate == nullptr) {
        if (parts_.margin_advisory != nullptr) {
            parts_.margin_advisory->update(engine_, pair_queries_, results(),
                                           containment_results());
        }
        return;
    }
    // The advisories use, one after the other, the plan's queries that the certificate left.
    std::uint32_t queries = queries_of(parts_.stop_certificate->plan()) -
                            parts_.stop_certificate->work().planned_queries;
    if (parts_.speed_advisory != nullptr) {
        if (cap_guard_.is_on()) {
            parts_.speed_advisory->update_order(engine_, *parts_.stop_certificate, queries,
                                                cap_guard_.order());
        } else {
            parts_.speed_advisory->update(engine_, *parts_.stop_certificate, queries);
        }
        queries -= parts_.speed_advisory->queries();
    }
    if (parts_.margin_advisory != nullptr) {
        parts_.margin_advisory->update(engine_, *parts_.stop_certificate, queries);
    }
}

UnprovenPair GuardChain::unproven(std::uint32_t pair) const noexcept {
    return parts_.stop_certificate != nullptr && pair != kNoIndex
               ? unproven_pair(machine_, *parts_.stop_certificate, pair)
               : UnprovenPair{};
}

RefusedCycle GuardChain::refused(const CycleResult& result) const noexcept {
    return {.reason = result.reason,
            .pair = result.pair,
            .snapshot = snapshot_,
            .unproven = unproven(result.pair)};
}

std::span<const QueryResult> GuardChain::results() const noexcept {
    return {results_.data(), is_queried() ? pair_queries_.count + 2 : 0};
}

std::span<const ContainmentResult> GuardChain::containment_results() const noexcept {
    return {contained_.data(), is_queried() ? pair_queries_.count : 0};
}

std::span<const std::int64_t> GuardChain::pair_ns() const noexcept {
    return {pair_ns_.data(), is_queried() && !engine_.prefers_batches ? pair_queries_.count : 0};
}

}  // namespace axg
