// SPDX-License-Identifier: Apache-2.0
// The work of the bus thread: frames to snapshots, snapshots to the engine's queue, its results to
// the guard's states, states to frames. Callers pass in times and faults. It has no clock, thread,
// wait or allocation, so that a test drives it with a wire and a counter.
// States: docs/reference/states.md. Frames and their times: docs/reference/axguardd.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/guard/guard_state.hpp"
#include "core/guard/time_limits.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/can/can_transport.hpp"
#include "firmware_if/guard/black_box_recorder.hpp"
#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/guard/operator_desk.hpp"
#include "firmware_if/guard/outbox.hpp"
#include "firmware_if/guard/period_clock.hpp"
#include "firmware_if/guard/pulse_line.hpp"
#include "firmware_if/guard/spsc_queue.hpp"
#include "firmware_if/guard/standstill_watch.hpp"
#include "firmware_if/guard/sync_producer.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

struct LiveQueues {
    SpscQueue<LiveQuery, 64> queries;
    SpscQueue<LiveResult, 64> results;
    SpscQueue<LiveNote, 256> notes;
};

/// Counted by the thread at the bus; others may read them when it has ended.
struct LiveCounters {
    std::uint64_t snapshots = 0, permits = 0, stops = 0;  // permits, stops: handed to the outbox
    std::uint64_t slow = 0;                               // of the permits
    std::uint64_t late = 0;                               // results after the deadline
    std::uint64_t refused = 0;  // proven but not used: late, too old, or not the first of a period
    std::uint64_t echoes = 0, send_faults = 0;
    std::uint64_t frames_left = 0;  // turns that left frames for the next
    std::uint64_t notes_lost = 0;
    std::uint64_t records_lost = 0;  // of the black box
    // Messages of an operator that reset or armed, that were refused, and frames that are no
    // message or out of order.
    std::uint64_t operator_acts = 0, operator_refused = 0, operator_ignored = 0;
};

/// Why the newest sample has no permit, armed or not.
struct WithheldPermit {
    enum class Why : std::uint8_t {
        nothing = 0,  // it is proven, and in time
        no_sample,    // none was queried since the start or the last reset
        not_proven,   // `reason` and `pair` name the missing proof
        late,         // the result came after the deadline
        motion,       // an axis moves while the frames report standstill
        session,      // the board has not sent its session
        period,       // no window has shown yet that the board's period is can.sample_us to 1 %
    };
    Why why = Why::no_sample;
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    std::uint32_t query = 0;  // not_proven: LiveQuery::number; 0: none
};
[[nodiscard]] const char* to_text(WithheldPermit::Why why) noexcept;

/// The latch as two words in memory that outlives the process, so that storing it needs no call.
/// Only the exact pattern of "clear" is clear. The guard stores it when a person arms, before the
/// first permit. A stop of an armed guard therefore writes nothing: no page fault delays its frame,
/// and the death of the process cannot lose it.
struct LatchCell {
    std::uint64_t word = 0, inverse = 0;
};
inline constexpr std::uint64_t kLatchClear = 0x6178677561726421U;
[[nodiscard]] bool is_latched(const LatchCell& cell) noexcept;
void set_latch(LatchCell& cell, bool is_latched) noexcept;

[[nodiscard]] GuardLimits live_limits(const TimeLimits& times) noexcept;

struct LiveOptions {
    bool accepts_local = false;          // frames sent by this host are the board's: vcan
    BlackBoxQueue* black_box = nullptr;  // to the black box; null: nothing is recorded
    ConfigurationHashes hashes{};        // the board must send the same, if the layout has their id
    PulseLine* line = nullptr;           // in addition to the bus; null: there is none
    // For recorded or simulated motion, where a person is only supposed to have armed: the axes may
    // move at that time. Never set in a deployed guard (style.deployed_symbols).
    bool supposes_arming = false;
    // Does not judge the board's period: a trace is read with its own period, and a simulated board
    // has the declared one. Never set in a deployed guard.
    bool ignores_period = false;
    // For a recording with can.sync: guard, which contains the SYNC of its guard: sends none, and
    // uses the recorded own frame instead. Never set in a deployed guard.
    bool supposes_sync = false;
};

/// Options of the guard's own receiver.
[[nodiscard]] constexpr ReceiverOptions receiver_options(const LiveOptions& options) noexcept {
    return {.refuse_local = !options.accepts_local,
            .period = options.ignores_period ? PeriodUse::ignored : PeriodUse::proven};
}

class GuardNode {
  public:
    /// `machine`, `wire`, `queues` and `latch` must outlive it.
    GuardNode(const Machine& machine, LiveOptions options, CanTransport& wire, LiveQueues& queues,
              LatchCell& latch, std::int64_t now_us) noexcept;

    /// Does all work that is due. Reads at most kFramesATurn frames.
    void turn(std::int64_t now_us) noexcept;
    /// When to call again at the latest; before, when the wire or the engine has something.
    [[nodiscard]] std::int64_t next_due_us() const noexcept;
    /// Whether the last turn submitted a query: the caller has to wake the engine thread.
    [[nodiscard]] bool has_submitted() const noexcept { return has_submitted_; }

    // Edges from a person, and faults from elsewhere in the process.
    void arm(std::int64_t now_us) noexcept;
    void reset(std::int64_t now_us) noexcept;
    void report(GuardFault fault, std::int64_t now_us) noexcept;
    /// Ends the process as planned: clears the latch of an armed guard. After a crash the guard
    /// starts stopped.
    void end() noexcept;

    [[nodiscard]] const Guard& guard() const noexcept { return guard_; }
    [[nodiscard]] const LiveCounters& counters() const noexcept { return counters_; }
    [[nodiscard]] const AxisReceiver& receiver() const noexcept { return receiver_; }
    /// The interface was removed: only a restart can recover it.
    [[nodiscard]] bool is_wire_gone() const noexcept { return is_gone_; }
    /// Reason of the newest stop.
    [[nodiscard]] StopReason reason() const noexcept { return reason_; }
    [[nodiscard]] std::uint32_t pair() const noexcept { return pair_; }  // kNoIndex: none
    /// Query whose verdict is the stop in force; 0: there is none, or it has another cause.
    [[nodiscard]] std::uint32_t stop_query() const noexcept {
        const bool is_verdict =
            guard_.phase == GuardPhase::stopped && guard_.cause == GuardFault::verdict;
        return is_verdict ? stop_query_ : 0;
    }
    /// When the phase began.
    [[nodiscard]] std::int64_t phase_us() const noexcept { return phase_us_; }
    [[nodiscard]] const WithheldPermit& withheld() const noexcept { return withheld_; }
    [[nodiscard]] bool stands(std::int64_t now_us) const noexcept {
        return standstill_.stands(now_us);
    }
    /// Whether a person's arming would have an effect now.
    [[nodiscard]] bool may_arm(std::int64_t now_us) noexcept {
        return hindrance_of(OperatorAction::arm, now_us) == OperatorRefusal::none;
    }
    /// The board has sent the session of the newest sample.
    [[nodiscard]] bool has_said_session() const noexcept {
        return receiver_.session_of(receiver_.newest_sync_counter()).has_value();
    }

    static constexpr std::uint32_t kFramesATurn = 64;

  private:
    GuardOutput on(const GuardEvent& event, std::int64_t now_us) noexcept;
    void send_stop(bool is_first, std::int64_t now_us) noexcept;
    void send_waiting_stop(std::int64_t now_us) noexcept;
    void fail(GuardFault fault, std::int64_t now_us) noexcept;
    void on_phase(GuardPhase before, std::int64_t now_us) noexcept;
    void check_gap(std::int64_t now_us) noexcept;
    void end_periods(std::int64_t until_us) noexcept;
    void end_period(std::int64_t now_us) noexcept;
    void take_results(std::int64_t now_us) noexcept;
    void on_result(const LiveResult& live_result, std::int64_t now_us) noexcept;
    void send_permit(const LiveResult& live_result, std::int64_t now_us) noexcept;
    void put_stop_word(std::int64_t now_us) noexcept;
    [[nodiscard]] bool keeps_cap() const noexcept { return machine_.guard.cap != CapPromise::none; }
    void note_held(const CycleResult& result, std::int64_t now_us) noexcept;
    [[nodiscard]] bool lacks_session(const LiveResult& live_result, std::int64_t now_us) noexcept;
    [[nodiscard]] std::optional<std::uint32_t> newest_nonce() const noexcept;
    void note_own_stop() noexcept;
    [[nodiscard]] bool waits_for_board() const noexcept;
    void read_frames(std::int64_t now_us) noexcept;
    void on_arrival(const CanArrival& arrival, std::int64_t now_us) noexcept;
    void on_foreign(const CanFrame& frame, const char* words, GuardFault fault,
                    std::int64_t now_us) noexcept;
    void send_sync(std::int64_t now_us) noexcept;
    void on_own_sync(const CanFrame& frame, std::int64_t now_us) noexcept;
    void on_wire_fault(const char* words, std::int64_t now_us) noexcept;
    void on_receiver(const ReceiverEvent& event, std::int64_t now_us) noexcept;
    void note_period(std::int64_t now_us) noexcept;
    void note_fault(const ReceiverEvent& event, std::int64_t now_us) noexcept;
    void check_standstill(std::int64_t now_us) noexcept;
    [[nodiscard]] bool contradicts(std::int64_t now_us) noexcept;
    void log_withheld(const CycleResult& result, std::int64_t now_us) noexcept;
    void pass_when_agreed(std::int64_t now_us) noexcept;
    void on_hash(const CanFrame& frame, std::int64_t now_us) noexcept;
    void note_hash(const HashFrame& theirs, std::int64_t now_us) noexcept;
    [[nodiscard]] OperatorRefusal hindrance_of(OperatorAction action, std::int64_t now_us) noexcept;
    void on_operator(const CanFrame& frame, std::int64_t now_us) noexcept;
    void note_operator(std::uint32_t kind, const char* words, std::int64_t now_us) noexcept;
    void send_status(std::int64_t now_us) noexcept;
    void check_recorder(std::int64_t now_us) noexcept;
    void submit(LiveQuery::Kind kind, const ReceiverEvent& event, std::int64_t now_us) noexcept;
    void check_engine(std::int64_t now_us) noexcept;
    void begin(std::int64_t now_us) noexcept;
    void send(std::int64_t now_us) noexcept;
    void set_line(bool level, std::int64_t now_us) noexcept;
    void note(LiveNote entry, std::int64_t now_us) noexcept;

    const Machine& machine_;
    BlackBoxRecorder wire_;  // records the frames that it reads and sends
    LiveQueues& queues_;
    LatchCell& latch_;
    TimeLimits times_;
    GuardLimits limits_;
    AxisReceiver receiver_;
    StandstillWatch standstill_;
    Guard guard_;
    Outbox outbox_;
    Handshake handshake_;
    PeriodClock period_;
    bool has_snapshot_ = false;  // in this period
    AckLedger ledger_;           // permits that the samples of a board with caps name
    std::uint32_t age_samples_;  // of their positions
    SyncProducer sync_;
    LiveCounters counters_;

    std::int64_t last_turn_us_;
    std::int64_t heartbeat_us_ = 0;  // next
    GuardHeartbeat heartbeat_ = GuardHeartbeat::silent;
    std::uint8_t live_counter_ = 0;
    // Numbers of queries. Not every kind has a result, and one result covers all queries before it.
    std::uint32_t submitted_ = 0, owed_ = 0, completed_ = 0, epoch_ = 0;
    std::int64_t waiting_since_us_ = 0;  // for the engine's next result
    StopReason reason_ = StopReason::none;
    std::uint32_t pair_ = kNoIndex, stop_query_ = 0;
    std::int64_t phase_us_;
    WithheldPermit withheld_;
    // The logged cause of not being ready, and the earliest time of the next such line.
    CycleResult logged_{};
    std::int64_t next_log_us_ = 0;
    std::uint32_t contradicted_axis_ = kNoIndex;  // at the last check
    std::int64_t next_session_note_us_ = 0, next_period_note_us_ = 0;
    Hints hints_;             // of the newest result
    bool has_hints_ = false;  // that was not sent yet
    OperatorDesk operator_;
    // Earliest time of the next line of each kind: a faulty panel or board cannot fill the log.
    static constexpr std::int64_t kNoteUs = 1'000'000;
    std::array<std::int64_t, kOperatorNotes> operator_note_us_{};
    std::array<std::int64_t, kHashParts> hash_note_us_{};
    OperatorStatus status_;                   // the last one sent
    std::int64_t status_us_, status_due_us_;  // times of the last and of the next one
    bool is_held_ = false;                    // the last result was held by the cap; logged
    bool has_submitted_ = false, is_down_ = false, is_gone_ = false, reads_more_ = false;
    bool has_reported_engine_ = false;
    bool has_passed_ = false;  // the self-test, since begin
    bool is_mute_ = false;     // our frames are not sent
    bool has_begun_ = false;   // construction is over: stops may be sent
    PulseLine* line_;
    bool line_level_ = false;
    bool supposes_arming_;
    // The board stopped by itself under permits, and nobody armed the guard since. While its nonce
    // is unchanged, nobody armed the board either.
    struct SeenOwnStop {
        bool is_on = false;
        std::optional<std::uint32_t> nonce;
    };
    SeenOwnStop own_stop_;
};

}  // namespace axg
