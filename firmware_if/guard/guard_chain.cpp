// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/guard_chain.hpp"

#include "core/collision/known_answer.hpp"

namespace axg {

GuardChain::GuardChain(const Machine& machine, Engine engine,
                       const ContainmentTest& containment_test, StopCertificate* stop_certificate,
                       SpeedAdvisory* speed_advisory, MarginAdvisory* margin_advisory)
    : machine_(machine),
      engine_(engine),
      containment_test_(containment_test),
      stop_certificate_(stop_certificate),
      speed_advisory_(stop_certificate == nullptr ? nullptr : speed_advisory),
      margin_advisory_(margin_advisory),
      cap_guard_(machine) {}

void GuardChain::note_caps(const CapFacts& caps, bool is_first) noexcept {
    std::array<double, kAxesMax> errors{};
    for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
        errors[i] = stop_certificate_->held_error(i);
    }
    cap_guard_.note(snapshot_, caps, is_first, errors);
}

void GuardChain::take(const ReceiverEvent& event, const CapFacts& caps) noexcept {
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        snapshot_ = event.snapshot;
        if (stop_certificate_ != nullptr) {
            // Before VALID the receiver may begin anew, and samples are then counted by the clock.
            const bool is_first = event.state != ReceiverState::valid;
            stop_certificate_->note(snapshot_, is_first);
            note_caps(caps, is_first);
        }
    } else if (event.kind == ReceiverEvent::Kind::look_ahead && stop_certificate_ != nullptr) {
        stop_certificate_->note_path(event.look_ahead);
    }
}

void GuardChain::evaluate(const EvaluationClock& clock) {
    if (stop_certificate_ != nullptr) {
        cap_guard_.bound(*stop_certificate_);
        stop_certificate_->prove(engine_, containment_test_);
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
    const SnapshotStatus status = stop_certificate_->cycle().status;
    has_own_stop_ = status == SnapshotStatus::own_stop
                        ? has_own_stop_ || is_armed
                        : has_own_stop_ && status == SnapshotStatus::left_limits;
    return is_armed || has_own_stop_;
}

CycleResult GuardChain::decide(bool ready, bool is_armed) noexcept {
    if (stop_certificate_ != nullptr) {
        stop_certificate_->keep();
    }
    CycleResult result = stop_certificate_ == nullptr
                             ? judge(pair_queries_, results(), containment_results(), ready)
                             : judge(stop_certificate_->cycle(), ready, owes_stop(is_armed));
    if (stop_certificate_ == nullptr) {
        result.samples = machine_.can.permit_samples.least;
    }
    if (speed_advisory_ != nullptr) {
        result.advisories.speed_cap = speed_advisory_->cap();
    }
    if (stop_certificate_ != nullptr && cap_guard_.is_on()) {
        const bool is_known = speed_advisory_ != nullptr && speed_advisory_->is_known();
        cap_guard_.judge(stop_certificate_->cycle(), is_known ? &speed_advisory_->wish() : nullptr,
                         is_armed, result);
    }
    if (margin_advisory_ != nullptr && margin_advisory_->worst() != kNoIndex) {
        const std::uint32_t pair = margin_advisory_->worst();
        result.advisories.pair = pair;
        result.advisories.clearance_level = margin_advisory_->clearance_levels()[pair].level;
        result.advisories.distance_mm = margin_advisory_->clearance_levels()[pair].distance_mm;
    }
    return result;
}

/// Queries an engine that received no batch in this cycle because the host processed all stages.
/// The clocks of an idle GPU would fall and delay the next launch; a lost GPU is detected now.
/// No decision uses the results: a lost engine proves nothing from then on.
void GuardChain::keep_awake() noexcept {
    if (stop_certificate_->work().batches != 0) {
        return;
    }
    const std::uint32_t mesh = known_answer_mesh_index(machine_);
    const std::array queries{known_answer_query(mesh, false), known_answer_query(mesh, true)};
    std::array<QueryResult, queries.size()> results;
    engine_(queries, results);
}

void GuardChain::update_advisories() noexcept {
    if (stop_certificate_ != nullptr && engine_.host.stages != 0) {
        keep_awake();
    }
    if (stop_certificate_ == nullptr) {
        if (margin_advisory_ != nullptr) {
            margin_advisory_->update(engine_, pair_queries_, results(), containment_results());
        }
        return;
    }
    // The advisories use, one after the other, the plan's queries that the certificate left.
    std::uint32_t queries =
        queries_of(stop_certificate_->plan()) - stop_certificate_->work().planned_queries;
    if (speed_advisory_ != nullptr) {
        if (cap_guard_.is_on()) {
            speed_advisory_->update_order(engine_, *stop_certificate_, queries, cap_guard_.order());
        } else {
            speed_advisory_->update(engine_, *stop_certificate_, queries);
        }
        queries -= speed_advisory_->queries();
    }
    if (margin_advisory_ != nullptr) {
        margin_advisory_->update(engine_, *stop_certificate_, queries);
    }
}

UnprovenPair GuardChain::unproven(std::uint32_t pair) const noexcept {
    return stop_certificate_ != nullptr && pair != kNoIndex
               ? unproven_pair(machine_, *stop_certificate_, pair)
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
