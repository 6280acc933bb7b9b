// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/guard_node.hpp"

#include <algorithm>
#include <atomic>

#include "core/guard/cap_guard.hpp"

namespace axg {
namespace {

// The first samples after a start have no speeds, so near pairs are not proven for some of them.
// A pair whose proof comes and goes must not log a line every period.
constexpr std::int64_t kLogUs = 1'000'000;

constexpr std::uint32_t kPeriodsATurn = 16;  // a longer sleep is a gap, and stops

const char* format_status(SendStatus status) noexcept {
    switch (status) {
        case SendStatus::ok:
            return "a guard frame was not seen on the bus";
        case SendStatus::gone:
            return "the interface was removed";
        default:
            return "a guard frame was rejected";
    }
}

}  // namespace

bool is_latched(const LatchCell& cell) noexcept {
    return cell.word != kLatchClear || cell.inverse != ~kLatchClear;
}

void set_latch(LatchCell& cell, bool is_latched) noexcept {
    const std::uint64_t word = is_latched ? ~kLatchClear : kLatchClear;
    // The memory belongs to a file: another process reads it, which the compiler cannot see.
    std::atomic_ref<std::uint64_t>(cell.word).store(word, std::memory_order_seq_cst);
    std::atomic_ref<std::uint64_t>(cell.inverse).store(~word, std::memory_order_seq_cst);
}

const char* to_text(WithheldPermit::Why why) noexcept {
    switch (why) {
        case WithheldPermit::Why::nothing:
            return "nothing";
        case WithheldPermit::Why::no_sample:
            return "no sample";
        case WithheldPermit::Why::not_proven:
            return "not proven";
        case WithheldPermit::Why::late:
            return "late";
        case WithheldPermit::Why::motion:
            return "motion";
        case WithheldPermit::Why::session:
            return "no session";
        case WithheldPermit::Why::period:
            return "period not shown";
    }
    return "?";
}

GuardLimits live_limits(const TimeLimits& times) noexcept {
    GuardLimits limits;
    limits.period_us = times.period_us;
    return limits;
}

GuardNode::GuardNode(const Machine& machine, LiveOptions options, CanTransport& wire,
                     LiveQueues& queues, LatchCell& latch, std::int64_t now_us) noexcept
    : machine_(machine),
      wire_(wire, options.black_box),
      queues_(queues),
      latch_(latch),
      times_(time_limits(machine)),
      limits_(live_limits(times_)),
      receiver_(machine, receiver_options(options)),
      standstill_(machine, {.refuse_local = !options.accepts_local, .period = PeriodUse::ignored},
                  standstill_rules(machine), now_us),
      guard_(start_guard(is_latched(latch))),
      outbox_(wire_, times_.echo_us),
      handshake_(machine.can, options.hashes),
      period_(times_.period_us, times_.deadline_us, now_us),
      age_samples_(age_samples(machine)),
      sync_(options.supposes_sync ? SyncProducer{} : make_sync_producer(machine, now_us)),
      last_turn_us_(now_us),
      heartbeat_us_(now_us),
      phase_us_(now_us),
      status_us_(now_us - kOperatorStatusUs),
      status_due_us_(has_sample_counter(machine.can) ? now_us : INT64_MAX),
      line_(options.line),
      supposes_arming_(options.supposes_arming) {
    wire_.set_time(now_us);
    on({.kind = GuardEventKind::restart}, now_us);
    if (guard_.phase == GuardPhase::init) {
        begin(now_us);
    } else {
        note({.kind = LiveNote::Kind::phase}, now_us);
    }
    has_begun_ = true;
}

/// Files are read before construction: only the self-test remains.
void GuardNode::begin(std::int64_t now_us) noexcept {
    on({.kind = GuardEventKind::loaded}, now_us);
    has_passed_ = is_held_ = false;
    ledger_.clear();
    logged_ = {};
    withheld_ = {};
    next_log_us_ = next_session_note_us_ = next_period_note_us_ = now_us + kLogUs;
    handshake_.begin(now_us);
    submit(LiveQuery::Kind::self_test, {}, now_us);
}

void GuardNode::turn(std::int64_t now_us) noexcept {
    has_submitted_ = false;
    wire_.begin_turn(now_us);
    send_waiting_stop(now_us);
    check_gap(now_us);
    take_results(now_us);
    end_periods(now_us);
    read_frames(now_us);
    on_receiver(receiver_.on_time(now_us), now_us);
    check_standstill(now_us);
    check_engine(now_us);
    check_recorder(now_us);
    send(now_us);
    wire_.end_turn();
    last_turn_us_ = now_us;
}

std::int64_t GuardNode::next_due_us() const noexcept {
    if (reads_more_) {
        return last_turn_us_;
    }
    return std::min({period_.next_us(), heartbeat_us_, outbox_.next_due_us(),
                     handshake_.next_due_us(), next_sync_us(sync_), status_due_us_});
}

/// The process did not run for longer than a permit: its data about that time is invalid.
void GuardNode::check_gap(std::int64_t now_us) noexcept {
    if (now_us - last_turn_us_ <= times_.permit_us) {
        return;
    }
    fail(GuardFault::gap, now_us);
    period_.restart(now_us);
}

void GuardNode::end_periods(std::int64_t until_us) noexcept {
    for (std::uint32_t i = 0; i < kPeriodsATurn && period_.next_us() <= until_us; ++i) {
        if (is_down_) {  // a fault that lasts is reported every period
            fail(GuardFault::input, until_us);
        }
        end_period(until_us);
    }
}

void GuardNode::end_period(std::int64_t now_us) noexcept {
    period_.advance();
    has_snapshot_ = false;
    on({.kind = GuardEventKind::deadline}, now_us);
}

void GuardNode::take_results(std::int64_t now_us) noexcept {
    LiveResult live_result;
    while (queues_.results.pop(live_result)) {
        end_periods(std::min(live_result.done_us, now_us));  // those before the result
        completed_ = live_result.number;
        wire_.add(live_result);
        waiting_since_us_ = now_us;
        if (live_result.epoch == epoch_) {
            on_result(live_result, now_us);
        }
    }
}

void GuardNode::on_result(const LiveResult& live_result, std::int64_t now_us) noexcept {
    if (live_result.kind == LiveQuery::Kind::self_test) {
        if (live_result.is_passed) {
            has_passed_ = true;
            pass_when_agreed(now_us);
        } else {
            fail(GuardFault::refused, now_us);
        }
        return;
    }
    if (live_result.result.is_stop && guard_.phase != GuardPhase::stopped) {
        reason_ = live_result.result.reason;
        pair_ = live_result.result.pair;
        stop_query_ = live_result.number;
    }
    using Why = WithheldPermit::Why;
    const CycleResult& result = live_result.result;
    withheld_ = {.why = result.has_permit ? Why::nothing : Why::not_proven,
                 .reason = result.reason,
                 .pair = result.pair,
                 .query = live_result.number};
    GuardEvent event =
        guard_event_of(live_result.result, live_result.period, now_us - live_result.latched_us);
    if (live_result.done_us - live_result.arrived_us > times_.deadline_us) {
        ++counters_.late;
        event.is_proven = false;
        withheld_ = {.why = Why::late};
    }
    if (guard_.phase != GuardPhase::armed && !supposes_arming_ && contradicts(now_us)) {
        event.is_proven = false;
        withheld_ = {.why = Why::motion};
    }
    if (event.is_proven && lacks_session(live_result, now_us)) {
        event.is_proven = false;
        withheld_ = {.why = Why::session};
    }
    if (event.kind == GuardEventKind::own_stop && guard_.phase == GuardPhase::armed) {
        note_own_stop();
    }
    if (!receiver_.is_period_shown()) {  // then it is not VALID: no permit
        withheld_ =
            result.reason == StopReason::none ? WithheldPermit{.why = Why::period} : withheld_;
        note_period(now_us);
    }
    if (has_sample_counter(machine_.can)) {
        hints_ = hints_of(live_result.result, live_result.sync_counter);
        has_hints_ = true;
    }
    const bool was_proven = guard_.is_proven;
    const GuardOutput output = on(event, now_us);
    log_withheld(live_result.result, now_us);
    note_held(live_result.result, now_us);
    counters_.refused +=
        live_result.result.has_permit && (was_proven || !guard_.is_proven) ? 1U : 0U;
    if (output.sends_permit) {
        send_permit(live_result, now_us);
    }
}

/// Logs once a second while the period is not shown. At 1 kHz a correct one is shown in less time.
void GuardNode::note_period(std::int64_t now_us) noexcept {
    if (now_us < next_period_note_us_) {
        return;
    }
    next_period_note_us_ = now_us + kLogUs;
    note({.kind = LiveNote::Kind::wire,
          .words = "not ready: no window of samples shows that the board's period is "
                   "can.sample_us to 1 % (axguard inspect prints it)"},
         now_us);
}

/// Whether an axis moves while the frames report standstill: until it rests no sample counts as
/// proven, which prevents arming. Logged once each time.
bool GuardNode::contradicts(std::int64_t now_us) noexcept {
    const std::uint32_t axis = standstill_.contradicted_axis();
    if (axis != contradicted_axis_ && axis != kNoIndex) {
        note({.kind = LiveNote::Kind::motion,
              .axis = axis,
              .words = "moves, but the board reports standstill"},
             now_us);
    }
    contradicted_axis_ = axis;
    return axis != kNoIndex;
}

/// Before arming a missing proof does not stop, so no other line names the pair. Logs it if pair or
/// reason differ from the last line, or if the guard was ready since.
void GuardNode::log_withheld(const CycleResult& result, std::int64_t now_us) noexcept {
    const bool is_waiting = guard_.phase == GuardPhase::selftest;
    const bool is_known = result.reason == logged_.reason && result.pair == logged_.pair;
    if (!is_waiting || result.reason == StopReason::none || is_known || now_us < next_log_us_) {
        return;
    }
    logged_ = result;
    next_log_us_ = now_us + kLogUs;
    note({.kind = LiveNote::Kind::withheld, .reason = result.reason, .pair = result.pair}, now_us);
}

/// The self-test has two sides: our engine, and a board with the same configuration as ours.
void GuardNode::pass_when_agreed(std::int64_t now_us) noexcept {
    if (has_passed_ && handshake_.has_agreed()) {
        has_passed_ = false;
        on({.kind = GuardEventKind::tested}, now_us);
    }
}

/// Drives latch at the end of SYNC. A SYNC that is not sent, because it is late or the queue is
/// full, is a lost sample: the receiver misses its number.
void GuardNode::send_sync(std::int64_t now_us) noexcept {
    const std::uint8_t counter = take_sync(sync_, now_us);
    if (counter != 0 &&
        wire_.send(encode_sync(machine_.can.sync_id, counter, now_us)) != SendStatus::ok) {
        ++counters_.send_faults;
    }
}

/// A stop is confirmed while the axes are at rest, in any state of the guard's own receiver.
void GuardNode::check_standstill(std::int64_t now_us) noexcept {
    if (guard_.phase != GuardPhase::stopped) {
        return;
    }
    const bool is_at_rest = standstill_.stands(now_us);
    if (is_at_rest != guard_.is_confirmed) {
        if (!is_at_rest) {
            note({.kind = LiveNote::Kind::motion,
                  .axis = standstill_.moving_axis(),
                  .words = "moves, or is no longer reported: the stop is sent again"},
                 now_us);
        }
        on({.kind = is_at_rest ? GuardEventKind::board_ack : GuardEventKind::board_moves}, now_us);
    }
}

void GuardNode::submit(LiveQuery::Kind kind, const ReceiverEvent& event,
                       std::int64_t now_us) noexcept {
    const bool has_caps = keeps_cap() && kind == LiveQuery::Kind::snapshot;
    const LiveQuery query{.kind = kind,
                          .number = submitted_ + 1,
                          .epoch = epoch_,
                          .period = guard_.period,
                          .is_armed = guard_.phase == GuardPhase::armed,
                          .event = event,
                          .caps = has_caps ? ledger_.note_sample(acked_permit(event.snapshot),
                                                                 event.samples_lost, age_samples_)
                                           : CapFacts{}};
    if (!queues_.queries.push(query)) {
        return;  // check_engine() reports an engine that is so far behind
    }
    ++submitted_;
    wire_.add(query);
    if (kind == LiveQuery::Kind::self_test || kind == LiveQuery::Kind::snapshot) {
        waiting_since_us_ = owed_ == completed_ ? now_us : waiting_since_us_;
        owed_ = submitted_;
    }
    has_submitted_ = true;
}

/// An engine without any result for longer than a permit is lost, whatever the receiver does.
void GuardNode::check_engine(std::int64_t now_us) noexcept {
    const bool is_silent = owed_ != completed_ && now_us - waiting_since_us_ > times_.permit_us;
    if (is_silent && !has_reported_engine_) {
        fail(GuardFault::engine, now_us);
    }
    has_reported_engine_ = is_silent;
}

/// A recorder that loses records makes the period a bad one, and too many of those stop.
void GuardNode::check_recorder(std::int64_t now_us) noexcept {
    if (counters_.records_lost != wire_.lost()) {
        counters_.records_lost = wire_.lost();
        fail(GuardFault::recorder, now_us);
    }
}

void GuardNode::fail(GuardFault fault, std::int64_t now_us) noexcept {
    on({.kind = GuardEventKind::fault, .fault = fault}, now_us);
}

void GuardNode::report(GuardFault fault, std::int64_t now_us) noexcept {
    wire_.set_time(now_us);
    wire_.add(LiveCall{LiveCall::Kind::report, fault});
    fail(fault, now_us);
}

void GuardNode::end() noexcept {
    if (guard_.phase == GuardPhase::armed) {
        set_latch(latch_, false);
    }
}

GuardOutput GuardNode::on(const GuardEvent& event, std::int64_t now_us) noexcept {
    const GuardPhase before = guard_.phase;
    const GuardOutput output = on_event(guard_, event, limits_);
    if (output.sends_stop) {
        send_stop(before != GuardPhase::stopped, now_us);
    }
    if (output.heartbeat != heartbeat_) {  // a change is sent at once
        heartbeat_ = output.heartbeat;
        heartbeat_us_ = now_us;
    }
    if (guard_.phase != before) {
        if (before == GuardPhase::armed) {
            set_line(false, now_us);
        }
        on_phase(before, now_us);
    }
    return output;
}

/// Runs before all else: the output line may be slow, and memory of a file may fault.
void GuardNode::send_stop(bool is_first, std::int64_t now_us) noexcept {
    outbox_.put_stop(encode_stop(machine_.can, now_us));
    send_waiting_stop(now_us);
    for (const std::uint32_t id : machine_.can.quick_stop_ids) {
        outbox_.put_quick_stop(encode_quick_stop(id, now_us));
    }
    if (has_sample_counter(machine_.can) && is_first) {
        put_stop_word(now_us);
    }
    send_waiting_stop(now_us);
    ++counters_.stops;
}

/// Sends nothing during construction: the first turn begins with it.
void GuardNode::send_waiting_stop(std::int64_t now_us) noexcept {
    if (has_begun_) {
        outbox_.send_stop(now_us);
    }
}

void GuardNode::on_phase(GuardPhase before, std::int64_t now_us) noexcept {
    if (guard_.phase == GuardPhase::armed) {
        set_latch(latch_, true);
    }
    if (guard_.phase == GuardPhase::stopped) {
        if (before != GuardPhase::armed) {
            set_latch(latch_, true);
        }
        standstill_.begin(now_us);
        if (guard_.cause != GuardFault::verdict) {
            reason_ = guard_.cause == GuardFault::input ? StopReason::input : StopReason::none;
            pair_ = kNoIndex;
        }
        Emergency emergency;
        emergency.code = emergency_code_of(guard_.cause, reason_);
        emergency.error_register = 1;
        emergency.pair = static_cast<std::uint8_t>(std::min<std::uint32_t>(pair_, 255));
        outbox_.put_emergency(encode_emergency(machine_.can, emergency, now_us));
    }
    if (guard_.phase == GuardPhase::ready) {
        logged_ = {};
    }
    forget_request(operator_);
    phase_us_ = now_us;
    note({.kind = LiveNote::Kind::phase}, now_us);
    if (before == GuardPhase::stopped) {  // only a person's reset leads here
        set_latch(latch_, false);
        reason_ = StopReason::none;
        outbox_.put_emergency(encode_emergency(machine_.can, {}, now_us));
        receiver_.acknowledge();
        ++epoch_;
        begin(now_us);
    }
}

void GuardNode::send(std::int64_t now_us) noexcept {
    send_sync(now_us);
    if (now_us >= heartbeat_us_) {
        heartbeat_us_ = std::max(heartbeat_us_ + kHeartbeatPeriodUs, now_us);
        if (heartbeat_ != GuardHeartbeat::silent) {
            outbox_.put_heartbeat(encode_guard_heartbeat(machine_.can, heartbeat_, now_us));
        }
        if (has_hints_) {
            has_hints_ = false;
            outbox_.put_hints(encode_hints(machine_.can, hints_, now_us));
        }
    }
    if (now_us >= handshake_.next_due_us()) {
        outbox_.put_hash(handshake_.next(now_us));
    }
    if (handshake_.is_overdue(now_us)) {
        note({.kind = LiveNote::Kind::wire,
              .frame_id = machine_.can.hashes_in_id,
              .words = "the board has not sent all its hashes"},
             now_us);
    }
    send_status(now_us);
    const OutboxResult sent = outbox_.work(now_us);
    if (sent.was_heard) {
        is_mute_ = false;
        on({.kind = GuardEventKind::tx_ok}, now_us);
    }
    if (!sent.has_failed) {
        return;
    }
    ++counters_.send_faults;
    const bool is_removed = sent.status == SendStatus::gone;
    if (!is_mute_ || is_removed) {  // logged once, until a frame is sent again
        is_mute_ = true;
        note({.kind = LiveNote::Kind::wire, .words = format_status(sent.status)}, now_us);
    }
    is_gone_ = is_gone_ || is_removed;
    on({.kind = GuardEventKind::tx_fail}, now_us);
    if (guard_.phase == GuardPhase::stopped) {  // the stop that this very failure led to
        const OutboxResult again = outbox_.work(now_us);
        counters_.send_faults += again.has_failed ? 1U : 0U;
    }
}

/// Each permit makes one edge, which holds the monoflop up: a thread that merely runs makes none.
/// A line that cannot be set counts as a frame that was not sent.
void GuardNode::set_line(bool level, std::int64_t now_us) noexcept {
    if (line_ == nullptr || line_level_ == level) {
        return;
    }
    line_level_ = level;
    if (!line_->set(level)) {
        note({.kind = LiveNote::Kind::wire, .words = "cannot set the output line"}, now_us);
        on({.kind = GuardEventKind::tx_fail}, now_us);
    }
}

void GuardNode::note(LiveNote entry, std::int64_t now_us) noexcept {
    entry.time_us = now_us;
    entry.phase = guard_.phase;
    entry.cause = guard_.cause;
    if (entry.kind != LiveNote::Kind::withheld) {  // it has its own reason and pair
        entry.reason = reason_;
        entry.pair = pair_;
    }
    wire_.add(entry);
    if (counters_.notes_lost != 0) {
        const LiveNote lost{.kind = LiveNote::Kind::lost,
                            .time_us = now_us,
                            .count = static_cast<std::uint32_t>(counters_.notes_lost)};
        counters_.notes_lost = queues_.notes.push(lost) ? 0 : counters_.notes_lost;
    }
    counters_.notes_lost += queues_.notes.push(entry) ? 0U : 1U;
}

}  // namespace axg
