// SPDX-License-Identifier: Apache-2.0
// Runs a recorded trace through the deployed guard, with the time of every cycle and a list of the
// stops. The guard's timers fire between the lines and after the last. No allocation from the first
// frame to the last.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/distance_need.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/guard/timed_guard.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

inline constexpr std::int64_t kAfterStopUs = 10'000;  // after a stop, frames are still shown
// A guard that was never armed restarts after a longer time without frames.
inline constexpr std::int64_t kHoleUs = 10'000'000;

struct ReplayOptions {
    ChainParts parts{};            // each must outlive the run
    std::int64_t deadline_us = 0;  // above it a cycle is counted as late
    bool keep_going = false;       // judge the samples after a stop too
    bool is_realtime = false;  // a late cycle has no permit, as live; else late ones are counted
    std::int64_t arm_from_us = INT64_MIN;  // of the trace; before, a guard that is ready waits
    ConfigurationHashes hashes{};          // of the machine, for a board in the trace that has them
    EvaluationClock clock{};
    std::function<void(const CanFrame&)> sent{};  // each frame that the guard sends; may be empty
};

/// A slow cycle with its input.
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

/// Number of cycles by their count; the last place: this count and higher.
struct CountTable {
    std::array<std::uint64_t, 2048> cycles{};

    void add(std::uint32_t count) noexcept;
    /// The smallest count that this share of the cycles does not exceed.
    [[nodiscard]] std::uint32_t at_share(double share) const noexcept;
};

/// Cost of the proofs of stoppable mode, cycle by cycle.
struct ProofStatistics {
    CountTable queries, stages;
    std::uint32_t queries_most = 0, stages_most = 0;
    std::uint64_t withheld = 0;  // cycles without a permit, and without a stop
};

/// Results of the clearance levels: samples by the worst level of their pairs, and queries a
/// sample.
struct ClearanceLevelStatistics {
    std::uint64_t slow = 0, warn = 0;
    CountTable queries;
    std::uint32_t queries_most = 0;
};

/// Record of a stop, and of the first sample of every later episode of contact (keep_going).
struct StopEvent {
    GuardFault cause = GuardFault::verdict;
    StopReason reason = StopReason::none;  // cause verdict or input
    std::uint32_t pair = kNoIndex;
    LimitFact limit{};                          // for left_limits
    ReceiverFault fault = ReceiverFault::none;  // cause input
    std::int64_t measured_period_ns = 0;        // fault sync_period
    std::int64_t time_us = 0;                   // arrival of the sample, or when the guard stopped
    AxisSnapshot snapshot{};                    // the last one
    std::uint64_t samples = 1;                  // how long the episode lasted
    std::int64_t stop_us = 0;  // of a trace that ends in motion: when the guard stops
    UnprovenPair unproven{};   // stoppable mode: `pair`, as its proof failed
};
inline constexpr std::size_t kStopsKept = 64;
/// The reason of a verdict or an input fault; the cause of any other stop.
[[nodiscard]] const char* reason_text(const StopEvent& stop) noexcept;

/// Result of a cycle, for observers.
struct ReplayCycle {
    const AxisSnapshot& snapshot;
    const PairQueries& pair_queries;
    std::span<const QueryResult> results;
    std::span<const ContainmentResult> containment_results;  // [pair_queries.count]
    const CycleResult& result;
    std::uint8_t sync_counter;
    bool sent_permit;
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

    /// Processes one frame; call in order of time. False: the guard stopped without keep_going, and
    /// kAfterStopUs are over.
    [[nodiscard]] bool on_frame(const CanFrame& frame);
    /// The same for a frame that the trace does not contain.
    [[nodiscard]] bool on_added(const CanFrame& frame) {
        --frame_count_;
        return on_frame(frame);
    }
    /// Call after the last frame: sends the remaining frames of a stop, and checks whether the axes
    /// were moving.
    void finish();

    [[nodiscard]] std::span<const StopEvent> stops() const noexcept {
        return {stops_.data(), stop_count_ < kStopsKept ? stop_count_ : kStopsKept};
    }
    /// The first sample whose permit was withheld although receiver and history were valid, and how
    /// many there were: the machine would not have moved. samples 0: none.
    [[nodiscard]] const StopEvent& withheld() const noexcept { return withheld_; }
    [[nodiscard]] std::uint64_t stop_count() const noexcept { return stop_count_; }
    /// The trace ends while the axes move: when the guard stops, if it was armed. samples 0: no.
    [[nodiscard]] const StopEvent& end_in_motion() const noexcept { return end_in_motion_; }
    /// When the guard was armed first; nullopt: never.
    [[nodiscard]] std::optional<std::int64_t> armed_us() const noexcept { return armed_us_; }
    /// Whether it could have been armed.
    [[nodiscard]] bool was_ready() const noexcept { return was_ready_; }
    [[nodiscard]] std::uint64_t permits() const noexcept;  // sent
    /// Samples whose verdict allows a permit, armed or not.
    [[nodiscard]] std::uint64_t proven() const noexcept { return proven_; }
    /// Samples without a permit because receiver or history were not valid yet: no sign of a near
    /// pair.
    [[nodiscard]] std::uint64_t early() const noexcept { return early_; }
    [[nodiscard]] std::span<const PairStatistics> pairs() const noexcept { return pairs_; }
    [[nodiscard]] bool is_stoppable() const noexcept {
        return chain_.stop_certificate() != nullptr;
    }
    /// Precondition: it is stoppable.
    [[nodiscard]] const CyclePlan& plan() const noexcept {
        return chain_.stop_certificate()->plan();
    }
    [[nodiscard]] const ProofStatistics& proofs() const noexcept { return *proofs_; }
    [[nodiscard]] bool has_clearance_levels() const noexcept {
        return chain_.margin_advisory() != nullptr;
    }
    [[nodiscard]] const ClearanceLevelStatistics& clearance_levels() const noexcept {
        return *clearance_levels_;
    }
    [[nodiscard]] const LimitSurvey& limits() const noexcept { return limits_; }
    [[nodiscard]] const TimeHistogram& cycles() const noexcept { return cycles_; }
    [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_; }
    /// The slowest first.
    [[nodiscard]] std::span<const SlowCycle> slowest() const noexcept {
        return {slowest_.data(), slow_count_};
    }
    /// Counters of the guard's receiver, summed over all starts.
    [[nodiscard]] ReceiverCounters input() const noexcept;
    [[nodiscard]] ReceiverState receiver_state() const noexcept {
        return guard_ ? guard_->guard().receiver().state() : ReceiverState::invalid;
    }
    [[nodiscard]] std::uint64_t frame_count() const noexcept { return frame_count_; }
    /// Number of parts of the machine whose hashes a board in the trace sends. For the others the
    /// guard receives its own.
    [[nodiscard]] int hashes_heard() const noexcept { return std::popcount(hashes_heard_); }
    /// Frames of a guard in the trace: not read, because this guard would detect a second guard.
    [[nodiscard]] std::uint64_t guard_frames() const noexcept { return guard_frames_; }

  private:
    void start(std::int64_t now_us);
    void note_hash(const CanFrame& frame);
    [[nodiscard]] bool is_guards_stop(const CanFrame& frame) const noexcept;
    void run_before(std::int64_t until_us);
    void on_cycle(const TimedCycle& cycle);
    void note_pairs();
    void note_proofs(const CycleResult& result);
    void note_withheld(const CycleResult& result);
    void note_clearance_levels();
    void note_time(std::int64_t spent_ns, const AxisSnapshot& snapshot);
    void note_verdict(const CycleResult& result);
    void note_guard();
    void note_fault(GuardFault cause, StopReason reason);
    void note_stop(const StopEvent& stop);
    void keep_going();
    void restart(std::int64_t now_us);

    const Machine& machine_;
    GuardChain chain_;
    ReplayOptions options_;
    std::function<void(const ReplayCycle&)> observe_;
    LiveEngine live_;
    std::optional<TimedGuard> guard_;  // from the first frame on
    std::vector<PairStatistics> pairs_;
    std::unique_ptr<ProofStatistics> proofs_ = std::make_unique<ProofStatistics>();
    std::unique_ptr<ClearanceLevelStatistics> clearance_levels_ =
        std::make_unique<ClearanceLevelStatistics>();
    LimitSurvey limits_;
    TimeHistogram cycles_;
    std::uint32_t hashes_heard_ = 0;  // a bit a part
    std::uint64_t overruns_ = 0, frame_count_ = 0, guard_frames_ = 0, permits_ = 0;
    std::uint64_t proven_ = 0, early_ = 0;
    ReceiverCounters input_;                        // with permits_: of guards before this one
    std::optional<ReceiverCounters> input_at_end_;  // of a trace that ends in motion
    std::optional<std::int64_t> armed_us_;
    std::array<SlowCycle, kSlowCyclesKept> slowest_{};
    std::size_t slow_count_ = 0;
    std::array<StopEvent, kStopsKept> stops_{};
    StopEvent withheld_{.samples = 0}, end_in_motion_{.samples = 0};
    std::size_t stop_count_ = 0;
    std::int64_t last_us_ = 0;          // of the trace
    std::int64_t ends_us_ = INT64_MAX;  // after the stop that ends the run
    AxisSnapshot before_{}, newest_{};  // of the last two cycles
    bool in_episode_ = false, was_ready_ = false, was_stopped_ = false, is_over_ = false;
    bool marks_guard_ = false;  // the log states the direction of a guard's frames
};

}  // namespace axg
