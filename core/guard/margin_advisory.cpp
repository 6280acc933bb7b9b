// SPDX-License-Identifier: Apache-2.0
#include "core/guard/margin_advisory.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/collision/known_answer.hpp"
#include "core/machine/cycle_plan.hpp"

namespace axg {

namespace {

constexpr double kNotProven = -1;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Distance at which a pair returns to a better level: beyond its threshold by the band, roundings
/// included.
double way_back(const MarginRule& rule, double distance_mm) noexcept {
    return (distance_mm + rule.band_mm) * (1 + 0x1p-40);
}

bool has_clearance_level(const Pair& pair) noexcept {
    return pair.warn_mm > 0;
}

/// Level of a pair that is proven for its margin and for no larger distance.
ClearanceLevel worst_clearance_level(const Pair& pair) noexcept {
    return pair.slow_mm > 0 ? ClearanceLevel::slow : ClearanceLevel::warn;
}

bool is_far(const QueryResult& query_result) noexcept {
    return query_result.status == QueryStatus::ok && query_result.proof == Proof::far;
}

bool is_kept(const PairProof& proof) noexcept {
    return proof.surfaces.proof == JointBoxProof::proven &&
           proof.containment_result.status == QueryStatus::ok &&
           proof.containment_result.containment == Containment::none;
}

}  // namespace

bool has_clearance_levels(const Machine& machine) noexcept {
    return std::any_of(machine.pairs.begin(), machine.pairs.end(), has_clearance_level);
}

MarginRule margin_rule(const Machine& machine, const Pair& pair) noexcept {
    return {.stop_mm = pair.margin_mm,
            .slow_mm = pair.margin_mm + pair.slow_mm,
            .warn_mm = pair.margin_mm + pair.warn_mm,
            .band_mm = machine.guard.level_band_mm,
            .hold_cycles = machine.guard.level_hold_samples};
}

double largest_query_mm(const Machine& machine, const Pair& pair) noexcept {
    const MarginRule rule = margin_rule(machine, pair);
    return has_clearance_level(pair) ? way_back(rule, rule.warn_mm) : rule.stop_mm;
}

MarginAdvisory::MarginAdvisory(const Machine& machine, JointBoxProver prover, Arena arena) noexcept
    : machine_(&machine), prover_(std::move(prover)), arena_(std::move(arena)) {}

std::optional<MarginAdvisory> MarginAdvisory::create(const Machine& machine) {
    const std::size_t pairs = machine.pairs.size();
    const std::uint32_t steps = 2 * stop_tasks(machine);
    auto prover = JointBoxProver::create(machine, steps,
                                         {.rounds = kAdvisoryRounds,
                                          .queries = queries_of(cycle_plan(machine, steps / 2)),
                                          .known_answer_mesh = known_answer_mesh_index(machine)});
    Arena arena(Arena::size_bytes<MarginState>(pairs) +
                Arena::size_bytes<PairClearanceLevel>(pairs) + Arena::size_bytes<double>(pairs) +
                Arena::size_bytes<Step>(steps) + Arena::size_bytes<JointBoxTask>(steps) +
                Arena::size_bytes<JointBoxResult>(steps) + Arena::size_bytes<Query>(steps + 2) +
                Arena::size_bytes<QueryResult>(steps + 2));
    if (!prover || !arena.ok()) {
        return std::nullopt;
    }
    MarginAdvisory advisory(machine, std::move(*prover), std::move(arena));
    advisory.states_ = advisory.arena_.take<MarginState>(pairs);
    advisory.clearance_levels_ = advisory.arena_.take<PairClearanceLevel>(pairs);
    advisory.least_mm_ = advisory.arena_.take<double>(pairs);
    advisory.steps_ = advisory.arena_.take<Step>(steps);
    advisory.tasks_ = advisory.arena_.take<JointBoxTask>(steps);
    advisory.results_ = advisory.arena_.take<JointBoxResult>(steps);
    advisory.queries_ = advisory.arena_.take<Query>(steps + 2);
    advisory.query_results_ = advisory.arena_.take<QueryResult>(steps + 2);
    advisory.arena_.seal();
    for (std::size_t i = 0; i < pairs; ++i) {
        advisory.states_[i].level = worst_clearance_level(machine.pairs[i]);
        advisory.least_mm_[i] = machine.pairs[i].margin_mm;
    }
    advisory.finish();  // until the first update, the worst level that each pair has
    return advisory;
}

void MarginAdvisory::begin() noexcept {
    work_ = {};
    step_count_ = 0;
    std::fill(least_mm_.begin(), least_mm_.end(), kFar);  // a pair without queries
}

/// Adds the certificate's result for a pair with one tool. If proven, adds queries of the
/// thresholds at which the level of the pair would change from its present level.
void MarginAdvisory::add(std::uint32_t pair, std::uint32_t task, bool is_proven) noexcept {
    const Pair& of = machine_->pairs[pair];
    if (!is_proven || !has_clearance_level(of)) {
        least_mm_[pair] = std::min(least_mm_[pair], is_proven ? of.margin_mm : kNotProven);
        return;
    }
    const MarginRule rule = margin_rule(*machine_, of);
    const ClearanceLevel level = states_[pair].level;
    const bool is_clear = level == ClearanceLevel::clear, is_slow = level <= ClearanceLevel::slow;
    steps_[step_count_++] = {pair, task, is_clear ? rule.warn_mm : way_back(rule, rule.warn_mm),
                             false};
    if (of.slow_mm > 0) {
        steps_[step_count_++] = {pair, task, is_slow ? way_back(rule, rule.slow_mm) : rule.slow_mm,
                                 false};
    }
}

/// A task has the distance of its largest proven threshold, a pair the least of its tools.
void MarginAdvisory::finish() noexcept {
    for (std::uint32_t i = 0; i < step_count_;) {
        const Step& first = steps_[i];
        double proven_mm = machine_->pairs[first.pair].margin_mm;
        for (; i < step_count_ && steps_[i].task == first.task; ++i) {
            proven_mm = steps_[i].is_far ? std::max(proven_mm, steps_[i].distance_mm) : proven_mm;
        }
        least_mm_[first.pair] = std::min(least_mm_[first.pair], proven_mm);
    }
    worst_ = kNoIndex;
    for (std::uint32_t i = 0; i < clearance_levels_.size(); ++i) {
        const Pair& pair = machine_->pairs[i];
        PairClearanceLevel& out = clearance_levels_[i];
        out = {ClearanceLevel::clear, std::max(least_mm_[i], 0.0)};
        if (least_mm_[i] < pair.margin_mm) {
            out.level = ClearanceLevel::stop;
            states_[i] = {.level = worst_clearance_level(pair)};
        } else if (has_clearance_level(pair)) {
            out.level = update_margin(states_[i], margin_rule(*machine_, pair), least_mm_[i]);
        }
        const auto is_worse_than = [&out](const PairClearanceLevel& other) {
            return out.level < other.level ||
                   (out.level == other.level && out.distance_mm < other.distance_mm);
        };
        if (out.level != ClearanceLevel::clear &&
            (worst_ == kNoIndex || is_worse_than(clearance_levels_[worst_]))) {
            worst_ = i;
        }
    }
}

void MarginAdvisory::update(const Engine& engine, const StopCertificate& certificate,
                            std::uint32_t queries) noexcept {
    begin();
    const StopCycle cycle = certificate.cycle();
    if (cycle.status != SnapshotStatus::ok) {
        std::fill(least_mm_.begin(), least_mm_.end(), kNotProven);
    }
    for (std::uint32_t i = 0; i < cycle.proofs.size(); ++i) {
        // In a jog the proven floor of a pair may be less than its margin.
        add(cycle.proofs[i].pair, i, is_kept(cycle.proofs[i]) && !cycle.is_jog);
    }
    for (std::uint32_t i = 0; i < step_count_; ++i) {
        tasks_[i] = certificate.tasks()[steps_[i].task];
        tasks_[i].margin_mm = steps_[i].distance_mm;
    }
    if (step_count_ != 0) {
        work_ = prover_.prove(engine, tasks_.first(step_count_), results_.first(step_count_),
                              {.queries = queries});
    }
    for (std::uint32_t i = 0; i < step_count_; ++i) {
        steps_[i].is_far = work_.known_answer_signature == kKnownAnswerSignature &&
                           results_[i].proof == JointBoxProof::proven;
    }
    finish();
}

void MarginAdvisory::update(const Engine& engine, const PairQueries& pair_queries,
                            std::span<const QueryResult> query_results,
                            std::span<const ContainmentResult> containment_results) noexcept {
    begin();
    if (pair_queries.status != SnapshotStatus::ok) {
        std::fill(least_mm_.begin(), least_mm_.end(), kNotProven);
    }
    for (std::uint32_t i = 0; i < containment_results.size(); ++i) {
        const bool is_proven = is_far(query_results[i]) &&
                               containment_results[i].status == QueryStatus::ok &&
                               containment_results[i].containment == Containment::none;
        add(pair_queries.pair[i], i, is_proven);
    }
    if (step_count_ != 0) {
        for (std::uint32_t i = 0; i < step_count_; ++i) {
            queries_[i] = pair_queries.queries[steps_[i].task];
            queries_[i].r_mm = steps_[i].distance_mm;
        }
        const std::uint32_t all = step_count_ + 2;
        std::copy_n(pair_queries.queries.begin() + pair_queries.count, 2,
                    queries_.begin() + step_count_);
        std::fill_n(query_results_.begin(), all, QueryResult{});
        engine(queries_.first(all), query_results_.first(all));
        work_ = {.rounds = 1,
                 .queries = step_count_,
                 .known_answer_signature = known_answer_signature(query_results_[step_count_],
                                                                  query_results_[step_count_ + 1])};
    }
    for (std::uint32_t i = 0; i < step_count_; ++i) {
        steps_[i].is_far =
            work_.known_answer_signature == kKnownAnswerSignature && is_far(query_results_[i]);
    }
    finish();
}

}  // namespace axg
