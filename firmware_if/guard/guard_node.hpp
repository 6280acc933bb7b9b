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
#include "firmware_if/guard/announcements.hpp"
#include "firmware_if/guard/black_box_recorder.hpp"
#include "firmware_if/guard/engine_link.hpp"
#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/guard/node_log.hpp"
#include "firmware_if/guard/operator_desk.hpp"
#include "firmware_if/guard/outbox.hpp"
#include "firmware_if/guard/period_clock.hpp"
#include "firmware_if/guard/permit_issue.hpp"
#include "firmware_if/guard/standstill_watch.hpp"
#include "firmware_if/guard/stop_latch.hpp"
#include "firmware_if/guard/sync_producer.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

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
    [[nodiscard]] bool has_submitted() const noexcept { return link_.has_submitted(); }

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
    [[nodiscard]] bool is_wire_gone() const noexcept { return bus_.is_gone; }
    /// Reason of the newest stop.
    [[nodiscard]] StopReason reason() const noexcept { return stop_.cause.reason; }
    [[nodiscard]] std::uint32_t pair() const noexcept { return stop_.cause.pair; }
    /// Query whose verdict is the stop in force; 0: there is none, or it has another cause.
    [[nodiscard]] std::uint32_t stop_query() const noexcept {
        const bool is_verdict =
            guard_.phase == GuardPhase::stopped && guard_.cause == GuardFault::verdict;
        return is_verdict ? stop_.cause.query : 0;
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
    void note_held(const CycleResult& result, std::int64_t now_us) noexcept;
    [[nodiscard]] bool lacks_session(const LiveResult& live_result, std::int64_t now_us) noexcept;
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
    void check_recorder(std::int64_t now_us) noexcept;
    void submit(LiveQuery::Kind kind, const ReceiverEvent& event, std::int64_t now_us) noexcept;
    void check_engine(std::int64_t now_us) noexcept;
    void begin(std::int64_t now_us) noexcept;
    void send(std::int64_t now_us) noexcept;
    void set_line(bool level, std::int64_t now_us) noexcept;
    void note(LiveNote entry, std::int64_t now_us) noexcept;

    /// The wire, as the turns left it.
    struct Bus {
        std::int64_t last_turn_us = 0;
        bool is_down = false, is_gone = false;
        bool reads_more = false;  // the last turn left frames for the next
        bool is_mute = false;     // our frames are not sent
        bool has_begun = false;   // construction is over: stops may be sent
    };

    const Machine& machine_;
    BlackBoxRecorder wire_;  // records the frames that it reads and sends
    TimeLimits times_;
    AxisReceiver receiver_;
    StandstillWatch standstill_;
    Guard guard_;
    Outbox outbox_;
    PeriodClock period_;
    SyncProducer sync_;
    EngineLink link_;
    PermitIssue permits_;
    StopOutput stop_;
    Announcements announcements_;
    OperatorDesk operator_;
    LiveCounters counters_;
    NodeLog log_;
    WithheldPermit withheld_;
    std::int64_t phase_us_;
    Bus bus_;
    bool has_passed_ = false;  // the self-test, since begin
    bool supposes_arming_;
};

}  // namespace axg
