// SPDX-License-Identifier: Apache-2.0
// The work of the guard's engine thread: queries of a snapshot, engine, decision. No allocation
// after construction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/cap_guard.hpp"
#include "core/guard/chain_parts.hpp"
#include "core/guard/distance_need.hpp"
#include "core/guard/margin_advisory.hpp"
#include "core/guard/monitor.hpp"
#include "core/guard/reach_watch.hpp"
#include "core/guard/speed_advisory.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

/// Monotonic nanoseconds; a test scripts it.
using NowNs = std::int64_t (*)(void* clock);

/// Clock for measurements. Without a function nothing is measured.
struct EvaluationClock {
    NowNs now_ns = nullptr;
    void* clock = nullptr;

    [[nodiscard]] std::int64_t now() const { return now_ns == nullptr ? 0 : now_ns(clock); }
};

/// A cycle that withheld the permit or stopped, as the chain left it.
struct RefusedCycle {
    std::uint32_t query = 0;  // LiveQuery::number; 0: not of a live guard
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    AxisSnapshot snapshot{};
    UnprovenPair unproven{};
};
// The engine thread copies it.
static_assert(std::is_trivially_copyable_v<RefusedCycle> && sizeof(RefusedCycle) <= 4096);

/// One cycle calls take() with a snapshot, evaluate(), decide(), and after its frames have been
/// sent update_advisories().
class GuardChain {
  public:
    /// `machine`, `engine`, `containment_test` and all of `parts` must outlive the chain.
    GuardChain(const Machine& machine, Engine engine, const ContainmentTest& containment_test,
               const ChainParts& parts);

    /// Stores an event of the receiver: a snapshot for the queries, a look-ahead path for the
    /// certificate.
    /// @param caps  with a snapshot of a board that applies caps
    void take(const ReceiverEvent& event, const CapFacts& caps = {}) noexcept;

    /// Makes and runs the queries of the last snapshot; the same for the same snapshot, so it may
    /// be repeated.
    void evaluate(const EvaluationClock& clock = {});

    /// Decision from the results: permit or stop.
    /// @param ready  the receiver trusts its snapshots (VALID)
    /// @param is_armed  a permit would be sent: a missing proof stops
    [[nodiscard]] CycleResult decide(bool ready, bool is_armed) noexcept;

    /// Uses the remaining queries of this cycle for the advisories of the next, and wakes a GPU
    /// that it did not query. Call it after sending the frames: a permit waits for no advisory.
    void update_advisories() noexcept;

    /// For traces: their machine obeys neither caps nor stops of this guard.
    void ignore_obedience() noexcept {
        cap_guard_.ignore();
        reach_watch_.ignore();
    }
    /// Sets the recorded order of a run that this chain joins later.
    void set_cap_order(const CapOrder& order) noexcept { cap_guard_.set_order(order); }

    [[nodiscard]] const Engine& engine() const noexcept { return engine_; }
    [[nodiscard]] const AxisSnapshot& snapshot() const noexcept { return snapshot_; }
    [[nodiscard]] const StopCertificate* stop_certificate() const noexcept {
        return parts_.stop_certificate;
    }
    /// Returns unproven_pair of the last decision; empty in contact mode and without a pair.
    [[nodiscard]] UnprovenPair unproven(std::uint32_t pair) const noexcept;
    /// Returns the last decision, which gave no permit. Call it before update_advisories.
    [[nodiscard]] RefusedCycle refused(const CycleResult& result) const noexcept;
    [[nodiscard]] const MarginAdvisory* margin_advisory() const noexcept {
        return parts_.margin_advisory;
    }

    // Contact mode; empty in stoppable mode.
    [[nodiscard]] const PairQueries& pair_queries() const noexcept { return pair_queries_; }
    /// [pair_queries.count + 2] of the last evaluation, or none if the snapshot is not ok.
    [[nodiscard]] std::span<const QueryResult> results() const noexcept;
    /// [pair_queries.count] of the last evaluation, or none.
    [[nodiscard]] std::span<const ContainmentResult> containment_results() const noexcept;
    /// Duration in ns of each of pair_queries().pair in the last evaluation, with a clock; none if
    /// all of them are one batch.
    [[nodiscard]] std::span<const std::int64_t> pair_ns() const noexcept;

  private:
    void note_sample(const CapFacts& caps, bool is_first) noexcept;
    void keep_awake() noexcept;
    [[nodiscard]] bool owes_stop(bool is_armed) noexcept;
    void evaluate_together() noexcept;
    void evaluate_in_turn(const EvaluationClock& clock);
    [[nodiscard]] bool is_queried() const noexcept {
        return pair_queries_.status == SnapshotStatus::ok;
    }

    const Machine& machine_;
    Engine engine_;
    const ContainmentTest& containment_test_;
    ChainParts parts_;
    CapGuard cap_guard_;
    ReachWatch reach_watch_;
    bool has_own_stop_ = false;  // begun under permits, and not over
    AxisSnapshot snapshot_;
    PairQueries pair_queries_;
    std::array<QueryResult, kQueriesMax> results_{};
    std::array<ContainmentResult, kPairsMax> contained_{};
    std::array<std::int64_t, kPairsMax> pair_ns_{};
};

}  // namespace axg
