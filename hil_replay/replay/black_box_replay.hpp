// SPDX-License-Identifier: Apache-2.0
// Replays a dump of the black box through the same receiver and chain, in the order in which the
// live guard's two threads worked: its frames must give the recorded snapshots, and those the
// recorded verdicts. If the dump begins at the start of its process, the whole guard runs again
// and must send the recorded frames.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "firmware_if/guard/black_box_record.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "hil_replay/replay/recorded_guard.hpp"

namespace axg {

/// `run_in`: number not compared. A dump that begins after the start of its process first has to
/// restore the guard's state, until snapshots and verdicts agree again.
struct BlackBoxComparison {
    std::uint64_t same = 0, different = 0, run_in = 0;
};

struct BlackBoxStop {
    GuardFault cause = GuardFault::none;
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    ReceiverFault fault = ReceiverFault::none;  // cause input
    std::int64_t time_us = 0;
    std::int64_t latched_us = 0;  // of the sample; 0: none
};

struct ReplayedBlackBox {
    std::uint64_t records = 0, frames_read = 0, frames_sent = 0, frames_refused = 0, echoes = 0,
                  lost = 0;
    std::int64_t first_us = 0, last_us = 0;
    BlackBoxComparison snapshots, verdicts;
    // From the last frame of a sample to the echo of its permit, by the kernel's stamps of both.
    TimeHistogram permit_time;
    std::int64_t stop_us = -1;  // the same to the stop that a verdict led to; negative: none
    std::optional<LiveResult> first_different;       // as recorded
    std::optional<SentComparison> sent;              // none: records from the start are missing
    std::optional<BlackBoxStop> recorded, replayed;  // the last stop
    // Cycle of the replayed stop, if by a verdict; without a stop, the last cycle, if it withheld
    // the permit.
    std::optional<RefusedCycle> refused;
};

/// Whether the recorded stop follows from the dump. If the guard does not run again, a stop by
/// verdict or input follows from the frames; one by time or by the wire does not.
[[nodiscard]] bool can_be_reproduced(const ReplayedBlackBox& result) noexcept;
/// Whether the replay reproduced the recorded stop, at the same sample.
[[nodiscard]] bool is_reproduced(const ReplayedBlackBox& result) noexcept;

class BlackBoxReplay {
  public:
    static constexpr std::uint32_t kRunInSnapshots = 20;  // more than the guard's history

    /// `chain` is new; it and `machine` must outlive this.
    /// @param options  those of the guard, without its black box
    BlackBoxReplay(const Machine& machine, GuardChain& chain, const LiveOptions& options)
        : machine_(machine),
          options_(options),
          receiver_(machine, receiver_options(options)),
          chain_(chain) {}

    void on_record(const BlackBoxRecord& record);
    /// Returns the comparison; call it after the last record.
    [[nodiscard]] ReplayedBlackBox result();

  private:
    struct Heard {
        std::uint32_t number = 0;
        LiveQuery::Kind kind = LiveQuery::Kind::self_test;
        bool is_armed = false;
        ReceiverEvent event;
        CapFacts caps;
    };

    void on(const CanArrival& arrival);
    void on(const SentFrame& sent);
    void on(ReadStatus status);
    void on(const LiveQuery& query);
    void on(const LiveResult& live_result);
    void on(const LiveNote& note);
    void on(const LostRecords& lost);
    void on(const BlackBoxEnd&) {}
    void on(const EmptyTurn&);
    void on(const LiveCall& call);
    void on_receiver(const ReceiverEvent& event);
    void compare(const ReceiverEvent& recorded);
    void compare(const LiveResult& recorded, const CycleResult& made);

    void on_echo(const CanFrame& frame);
    void compare_sent(ReplayedBlackBox& out);

    const Machine& machine_;
    LiveOptions options_;
    std::optional<RecordedGuard> guard_;  // of a dump that is whole
    bool is_whole_ = false;
    AxisReceiver receiver_;
    GuardChain& chain_;
    ReplayedBlackBox result_;
    std::int64_t turn_us_ = 0;
    std::optional<ReceiverEvent> made_;  // by the last frame: a snapshot, or a look-ahead path
    std::deque<Heard> waiting_;          // for the engine's thread
    std::optional<BlackBoxStop> verdict_, input_;  // the last stop of either kind that was found
    std::optional<RefusedCycle> stopped_, withheld_;
    std::array<std::int64_t, kSyncCounterMax + 1> arrived_us_{};  // by SYNC counter; 0: none
    std::int64_t stop_since_us_ = 0;  // the sample whose verdict was a stop; 0: echoed
    ReceiverFault recorded_fault_ = ReceiverFault::none;
    std::int64_t stopping_us_ = 0;  // the sample of the last verdict that was a stop
    bool is_stopped_ = false;       // as the guard noted it
    bool has_verdict_ = false;      // that stops, since the start or the last reset
    bool runs_in_snapshots_ = true, runs_in_verdicts_ = true;
    std::uint32_t taken_ = 0;  // snapshots, since the run-in began
};

}  // namespace axg
