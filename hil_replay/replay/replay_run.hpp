// SPDX-License-Identifier: Apache-2.0
// A recorded trace through the chain the live program runs, with the time of every cycle and a list
// of the stops. No allocation from the first frame to the last.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

// A cycle is a pure function of its snapshot. One that is late is repeated at once, and its least
// time counts: what another program on the PC took away is not the cycle's work. Live, every late
// cycle counts (axguardd).
inline constexpr int kLateRepeats = 3;

struct ReplayOptions {
    StopCertificate* stop_certificate = nullptr;  // null: contact mode. It must outlive the run
    SpeedAdvisory* speed_advisory = nullptr;      // null: no speed cap. So must this
    MarginAdvisory* margin_advisory = nullptr;    // null: no clearance levels. And this
    std::int64_t deadline_us = 0;                 // of one cycle: its queries, decision
    bool keep_going = false;                      // judge the samples after a stop too
    NowNs now_ns = nullptr;
    void* clock = nullptr;
};

/// A cycle that took long, with its input.
struct SlowCycle {
    std::int64_t spent_ns = 0;
    AxisSnapshot snapshot;
};
inline constexpr std::size_t kSlowCyclesKept = 8;

struct PairStatistics {
    TimeHistogram time;            // contact mode, where each pair is queried by itself
    std::uint64_t not_proven = 0;  // samples
    std::uint64_t slow = 0, warn = 0;
};

/// How often a cycle took so many; the last place: so many and more.
struct CountTable {
    std::array<std::uint64_t, 2048> cycles{};

    void add(std::uint32_t count) noexcept;
    /// The smallest count that this share of the cycles does not exceed.
    [[nodiscard]] std::uint32_t at_share(double share) const noexcept;
};

/// What the proofs of stoppable mode cost, cycle by cycle.
struct ProofStatistics {
    CountTable queries, rounds;
    std::uint32_t queries_most = 0, rounds_most = 0;
    std::uint64_t withheld = 0;  // cycles without a permit, and without a stop
};

/// What the clearance levels came to: samples by the worst level of their pairs, and queries a
/// sample.
struct ClearanceLevelStatistics {
    std::uint64_t slow = 0, warn = 0;
    CountTable queries;
    std::uint32_t queries_most = 0;
};

/// What is kept of a stop, and of the first sample of every later episode of contact (keep_going).
struct StopEvent {
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    ReceiverFault fault = ReceiverFault::none;  // reason input
    std::int64_t time_us = 0;                   // arrival of the sample, or of the fault
    AxisSnapshot snapshot{};                    // the last one
    std::uint64_t samples = 1;                  // how long the episode lasted
};
inline constexpr std::size_t kStopsKept = 64;

/// What a cycle came to, for whoever writes it down.
struct ReplayCycle {
    const AxisSnapshot& snapshot;
    const PairQueries& pair_queries;
    std::span<const QueryResult> results;
    std::span<const ContainmentResult> containment_results;  // [pair_queries.count]
    const CycleResult& result;
    std::uint8_t sync_counter;
    // Stoppable mode: pair_queries and results are empty.
    const StopCertificate* stop_certificate = nullptr;
    std::int64_t spent_ns = 0;
    const MarginAdvisory* margin_advisory = nullptr;

    /// The worst of all pairs; clear where the machine file states no clearance levels.
    [[nodiscard]] ClearanceLevel clearance_level() const noexcept {
        const std::uint32_t worst =
            margin_advisory == nullptr ? kNoIndex : margin_advisory->worst();
        return worst == kNoIndex ? ClearanceLevel::clear
                                 : margin_advisory->clearance_levels()[worst].level;
    }
};

class ReplayRun {
  public:
    /// `machine`, `engine` and `containment_test` must outlive the run. `observe` is called once a
    /// cycle, outside the time that is measured; it may be empty.
    ReplayRun(const Machine& machine, Engine engine, const ContainmentTest& containment_test,
              const ReplayOptions& options, std::function<void(const ReplayCycle&)> observe);

    /// One frame in order of time. False: stopped, and not to keep going.
    [[nodiscard]] bool on_frame(const CanFrame& frame);

    [[nodiscard]] const MonitorState& state() const noexcept { return chain_.state(); }
    [[nodiscard]] std::span<const StopEvent> stops() const noexcept {
        return {stops_.data(), stop_count_ < kStopsKept ? stop_count_ : kStopsKept};
    }
    /// The first sample whose permit was withheld though all was known that can be, and how many
    /// there were: the machine would not have moved. samples 0: none.
    [[nodiscard]] const StopEvent& withheld() const noexcept { return withheld_; }
    [[nodiscard]] std::uint64_t stop_count() const noexcept { return stop_count_; }
    [[nodiscard]] std::span<const PairStatistics> pairs() const noexcept { return pairs_; }
    [[nodiscard]] bool is_stoppable() const noexcept {
        return chain_.stop_certificate() != nullptr;
    }
    [[nodiscard]] const ProofStatistics& proofs() const noexcept { return *proofs_; }
    [[nodiscard]] bool has_clearance_levels() const noexcept {
        return chain_.margin_advisory() != nullptr;
    }
    [[nodiscard]] const ClearanceLevelStatistics& clearance_levels() const noexcept {
        return *clearance_levels_;
    }
    [[nodiscard]] const TimeHistogram& cycles() const noexcept { return cycles_; }
    [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_; }
    /// Cycles that were late once and in time when repeated at once.
    [[nodiscard]] std::uint64_t interrupted() const noexcept { return interrupted_; }
    /// The slowest first.
    [[nodiscard]] std::span<const SlowCycle> slowest() const noexcept {
        return {slowest_.data(), slow_count_};
    }
    [[nodiscard]] const AxisReceiver& receiver() const noexcept { return chain_.receiver(); }
    [[nodiscard]] std::uint64_t frame_count() const noexcept { return frame_count_; }

  private:
    using PairTimes = std::array<std::int64_t, kPairsMax>;

    void cycle(const ReceiverEvent& event);
    /// Makes and runs the queries. Returns ns spent, and those of each pair queried.
    std::int64_t evaluate(PairTimes& pair_ns);
    void note_pairs(const PairTimes& pair_ns);
    void note_proofs(const CycleResult& result);
    void note_withheld(const CycleResult& result, bool ready);
    void note_clearance_levels();
    void note_time(std::int64_t spent_ns, const AxisSnapshot& snapshot);
    void note_stop(const CycleResult& result, std::int64_t time_us, ReceiverFault fault);

    GuardChain chain_;
    ReplayOptions options_;
    std::function<void(const ReplayCycle&)> observe_;
    std::vector<PairStatistics> pairs_;
    std::unique_ptr<ProofStatistics> proofs_ = std::make_unique<ProofStatistics>();
    std::unique_ptr<ClearanceLevelStatistics> clearance_levels_ =
        std::make_unique<ClearanceLevelStatistics>();
    TimeHistogram cycles_;
    std::uint64_t overruns_ = 0, interrupted_ = 0, frame_count_ = 0;
    std::array<SlowCycle, kSlowCyclesKept> slowest_{};
    std::size_t slow_count_ = 0;
    std::array<StopEvent, kStopsKept> stops_{};
    StopEvent withheld_{.samples = 0};
    std::size_t stop_count_ = 0;
    bool in_episode_ = false;
};

}  // namespace axg
