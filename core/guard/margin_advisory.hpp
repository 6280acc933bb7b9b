// SPDX-License-Identifier: Apache-2.0
// The clearance levels of a cycle: how much farther than its margin every pair stays apart,
// wherever the axes may move before rest. Runs after the certificate, with the rest of the plan's
// queries, two thresholds a pair. An advisory: no proof depends on it.
// mm. Source: docs/reference/states.md, "Advisories".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/margin_state.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Whether any pair has a clearance level beyond its margin: else there is no query and no advice.
[[nodiscard]] bool has_clearance_levels(const Machine& machine) noexcept;

/// Distances at which the level of a pair changes: its margin, and its levels beyond that.
[[nodiscard]] MarginRule margin_rule(const Machine& machine, const Pair& pair) noexcept;

/// Largest distance of the queries of a pair, by this advisory or by the certificate.
[[nodiscard]] double largest_query_mm(const Machine& machine, const Pair& pair) noexcept;

class MarginAdvisory {
  public:
    /// `machine` must outlive it. Empty: memory ran out.
    [[nodiscard]] static std::optional<MarginAdvisory> create(const Machine& machine);

    /// Computes the clearance levels of the boxes that the certificate's last `prove` queried: the
    /// same boxes, larger distances.
    /// @param queries  the rest of the cycle's queries
    /// Cost: at most these, in at most kAdvisoryRounds batches. A threshold
    /// that they do not prove counts as not reached.
    void update(const Engine& engine, const StopCertificate& certificate,
                std::uint32_t queries) noexcept;

    /// Contact mode: the clearance levels of the sampled pose. Cost: two queries a pair, in one
    /// batch.
    /// @param query_results, containment_results  of the pairs queried, as GuardChain has them
    void update(const Engine& engine, const PairQueries& pair_queries,
                std::span<const QueryResult> query_results,
                std::span<const ContainmentResult> containment_results) noexcept;

    /// One pair: its reported level, and the proven distance. Before the first
    /// `update` it is the worst level that the pair has.
    struct PairClearanceLevel {
        ClearanceLevel level = ClearanceLevel::stop;
        double distance_mm = 0;  // certified; the largest threshold that was proven
    };
    /// [Machine::pairs]
    [[nodiscard]] std::span<const PairClearanceLevel> clearance_levels() const noexcept {
        return clearance_levels_;
    }
    /// The pair with the worst level, the nearest if several have it; kNoIndex: all clear.
    [[nodiscard]] std::uint32_t worst() const noexcept { return worst_; }

    static constexpr std::uint32_t kAdvisoryRounds = 7;  // six halvings

    // Work of the last `update`, without known-answer tests.
    [[nodiscard]] std::uint32_t queries() const noexcept { return work_.queries; }
    [[nodiscard]] std::uint32_t rounds() const noexcept { return work_.rounds; }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes();
    }

  private:
    /// A threshold that is queried of one pair, with one tool.
    struct Step {
        std::uint32_t pair, task;  // of Machine::pairs, and of the certificate
        double distance_mm;
        bool is_far;
    };

    MarginAdvisory(const Machine& machine, JointBoxProver prover, Arena arena) noexcept;
    void begin() noexcept;
    void add(std::uint32_t pair, std::uint32_t task, bool is_proven) noexcept;
    void finish() noexcept;

    const Machine* machine_;
    JointBoxProver prover_;
    Arena arena_;
    std::span<MarginState> states_;                   // [pairs]
    std::span<PairClearanceLevel> clearance_levels_;  // [pairs]
    std::span<double> least_mm_;  // [pairs] over the tools of this cycle; negative: not proven
    std::span<Step> steps_;       // [two of each pair with each tool], those of a task together
    std::uint32_t step_count_ = 0;
    std::span<JointBoxTask> tasks_;
    std::span<JointBoxResult> results_;
    std::span<Query> queries_;
    std::span<QueryResult> query_results_;
    std::uint32_t worst_ = kNoIndex;
    JointBoxWork work_;
};

}  // namespace axg
