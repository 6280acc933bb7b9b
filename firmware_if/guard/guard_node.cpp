// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/guard_node.hpp"

#include <algorithm>

namespace axg {
namespace {

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
      times_(time_limits(machine)),
      receiver_(machine, receiver_options(options)),
      standstill_(machine, {.refuse_local = !options.accepts_local, .period = PeriodUse::ignored},
                  standstill_rules(machine), now_us),
      guard_(start_guard(is_latched(latch))),
      outbox_(wire_, times_.echo_us),
      period_(times_.period_us, times_.deadline_us, now_us),
      sync_(options.supposes_sync ? SyncProducer{} : make_sync_producer(machine, now_us)),
      link_(queues, wire_),
      permits_(machine, receiver_),
      stop_{.latch = latch, .line = {.line = options.line}, .cause = {}},
      announcements_(machine, options.hashes, now_us),
      log_(queues.notes),
      phase_us_(now_us),
      bus_{.last_turn_us = now_us},
      supposes_arming_(options.supposes_arming) {
    wire_.set_time(now_us);
    on({.kind = GuardEventKind::restart}, now_us);
    if (guard_.phase == GuardPhase::init) {
        begin(now_us);
    } else {
        note({.kind = LiveNote::Kind::phase}, now_us);
    }
    bus_.has_begun = true;
}

/// Files are read before construction: only the self-test remains.
void GuardNode::begin(std::int64_t now_us) noexcept {
    on({.kind = GuardEventKind::loaded}, now_us);
    has_passed_ = false;
    permits_.begin();
    withheld_ = {};
    log_.begin(now_us);
    announcements_.handshake().begin(now_us);
    submit(LiveQuery::Kind::self_test, {}, now_us);
}

void GuardNode::turn(std::int64_t now_us) noexcept {
    link_.begin_turn();
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
    bus_.last_turn_us = now_us;
}

std::int64_t GuardNode::next_due_us() const noexcept {
    if (bus_.reads_more) {
        return bus_.last_turn_us;
    }
    return std::min({period_.next_us(), outbox_.next_due_us(), announcements_.next_due_us(),
                     next_sync_us(sync_)});
}

/// The process did not run for longer than a permit: its data about that time is invalid.
void GuardNode::check_gap(std::int64_t now_us) noexcept {
    if (now_us - bus_.last_turn_us <= times_.permit_us) {
        return;
    }
    fail(GuardFault::gap, now_us);
    period_.restart(now_us);
}

void GuardNode::end_periods(std::int64_t until_us) noexcept {
    for (std::uint32_t i = 0; i < kPeriodsATurn && period_.next_us() <= until_us; ++i) {
        if (bus_.is_down) {  // a fault that lasts is reported every period
            fail(GuardFault::input, until_us);
        }
        end_period(until_us);
    }
}

void GuardNode::end_period(std::int64_t now_us) noexcept {
    period_.advance();
    on({.kind = GuardEventKind::deadline}, now_us);
}

void GuardNode::take_results(std::int64_t now_us) noexcept {
    LiveResult live_result;
    while (link_.pop(live_result)) {
        end_periods(std::min(live_result.done_us, now_us));  // those before the result
        link_.note(live_result, now_us);
        if (link_.is_of_epoch(live_result)) {
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
        stop_.cause = {live_result.result.reason, live_result.result.pair, live_result.number};
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
        permits_.note_own_stop();
    }
    if (!receiver_.is_period_shown()) {  // then it is not VALID: no permit
        withheld_ =
            result.reason == StopReason::none ? WithheldPermit{.why = Why::period} : withheld_;
        note_period(now_us);
    }
    if (has_sample_counter(machine_.can)) {
        announcements_.set_hints(hints_of(live_result.result, live_result.sync_counter));
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
    if (NodeLog::take(log_.period_us, now_us)) {
        note({.kind = LiveNote::Kind::wire,
              .words = "not ready: no window of samples shows that the board's period is "
                       "can.sample_us to 1 % (axguard inspect prints it)"},
             now_us);
    }
}

/// Whether an axis moves while the frames report standstill: until it rests no sample counts as
/// proven, which prevents arming. Logged once each time.
bool GuardNode::contradicts(std::int64_t now_us) noexcept {
    const std::uint32_t axis = standstill_.contradicted_axis();
    if (axis != log_.contradicted_axis && axis != kNoIndex) {
        note({.kind = LiveNote::Kind::motion,
              .axis = axis,
              .words = "moves, but the board reports standstill"},
             now_us);
    }
    log_.contradicted_axis = axis;
    return axis != kNoIndex;
}

/// Before arming a missing proof does not stop, so no other line names the pair. Logs it if pair or
/// reason differ from the last line, or if the guard was ready since.
void GuardNode::log_withheld(const CycleResult& result, std::int64_t now_us) noexcept {
    const bool is_waiting = guard_.phase == GuardPhase::selftest;
    const bool is_known = result.reason == log_.reason && result.pair == log_.pair;
    if (!is_waiting || result.reason == StopReason::none || is_known ||
        !NodeLog::take(log_.withheld_us, now_us)) {
        return;
    }
    log_.reason = result.reason;
    log_.pair = result.pair;
    note({.kind = LiveNote::Kind::withheld, .reason = result.reason, .pair = result.pair}, now_us);
}

/// The self-test has two sides: our engine, and a board with the same configuration as ours.
void GuardNode::pass_when_agreed(std::int64_t now_us) noexcept {
    if (has_passed_ && announcements_.handshake().has_agreed()) {
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
    link_.submit(
        {.kind = kind,
         .period = guard_.period,
         .is_armed = guard_.phase == GuardPhase::armed,
         .event = event,
         .caps = kind == LiveQuery::Kind::snapshot ? permits_.note_sample(event) : CapFacts{}},
        now_us);
}

/// An engine without any result for longer than a permit is lost, whatever the receiver does.
void GuardNode::check_engine(std::int64_t now_us) noexcept {
    if (link_.is_newly_silent(now_us, times_.permit_us)) {
        fail(GuardFault::engine, now_us);
    }
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
        set_latch(stop_.latch, false);
    }
}

GuardOutput GuardNode::on(const GuardEvent& event, std::int64_t now_us) noexcept {
    const GuardPhase before = guard_.phase;
    const GuardOutput output = on_event(guard_, event, live_limits(times_));
    if (output.sends_stop) {
        send_stop(before != GuardPhase::stopped, now_us);
    }
    announcements_.set_heartbeat(output.heartbeat, now_us);
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
        outbox_.put_stop_word(encode_permit(machine_.can, permits_.stop_word(), now_us));
    }
    send_waiting_stop(now_us);
    ++counters_.stops;
}

/// Sends nothing during construction: the first turn begins with it.
void GuardNode::send_waiting_stop(std::int64_t now_us) noexcept {
    if (bus_.has_begun) {
        outbox_.send_stop(now_us);
    }
}

void GuardNode::on_phase(GuardPhase before, std::int64_t now_us) noexcept {
    if (guard_.phase == GuardPhase::armed) {
        set_latch(stop_.latch, true);
    }
    if (guard_.phase == GuardPhase::stopped) {
        if (before != GuardPhase::armed) {
            set_latch(stop_.latch, true);
        }
        standstill_.begin(now_us);
        if (guard_.cause != GuardFault::verdict) {
            stop_.cause.reason =
                guard_.cause == GuardFault::input ? StopReason::input : StopReason::none;
            stop_.cause.pair = kNoIndex;
        }
        Emergency emergency;
        emergency.code = emergency_code_of(guard_.cause, stop_.cause.reason);
        emergency.error_register = 1;
        emergency.pair = static_cast<std::uint8_t>(std::min<std::uint32_t>(stop_.cause.pair, 255));
        outbox_.put_emergency(encode_emergency(machine_.can, emergency, now_us));
    }
    if (guard_.phase == GuardPhase::ready) {
        log_.forget_withheld();
    }
    forget_request(operator_);
    phase_us_ = now_us;
    note({.kind = LiveNote::Kind::phase}, now_us);
    if (before == GuardPhase::stopped) {  // only a person's reset leads here
        set_latch(stop_.latch, false);
        stop_.cause.reason = StopReason::none;
        outbox_.put_emergency(encode_emergency(machine_.can, {}, now_us));
        receiver_.acknowledge();
        link_.begin_epoch();
        begin(now_us);
    }
}

void GuardNode::send(std::int64_t now_us) noexcept {
    send_sync(now_us);
    if (announcements_.handshake().is_overdue(now_us)) {
        note({.kind = LiveNote::Kind::wire,
              .frame_id = machine_.can.hashes_in_id,
              .words = "the board has not sent all its hashes"},
             now_us);
    }
    announcements_.put_due(operator_, guard_.phase, now_us, outbox_);
    const OutboxResult sent = outbox_.work(now_us);
    if (sent.was_heard) {
        bus_.is_mute = false;
        on({.kind = GuardEventKind::tx_ok}, now_us);
    }
    if (!sent.has_failed) {
        return;
    }
    ++counters_.send_faults;
    const bool is_removed = sent.status == SendStatus::gone;
    if (!bus_.is_mute || is_removed) {  // logged once, until a frame is sent again
        bus_.is_mute = true;
        note({.kind = LiveNote::Kind::wire, .words = format_status(sent.status)}, now_us);
    }
    bus_.is_gone = bus_.is_gone || is_removed;
    on({.kind = GuardEventKind::tx_fail}, now_us);
    if (guard_.phase == GuardPhase::stopped) {  // the stop that this very failure led to
        const OutboxResult again = outbox_.work(now_us);
        counters_.send_faults += again.has_failed ? 1U : 0U;
    }
}

void GuardNode::set_line(bool level, std::int64_t now_us) noexcept {
    if (!stop_.line.set(level)) {
        note({.kind = LiveNote::Kind::wire, .words = "cannot set the output line"}, now_us);
        on({.kind = GuardEventKind::tx_fail}, now_us);
    }
}

void GuardNode::send_permit(const LiveResult& live_result, std::int64_t now_us) noexcept {
    const Permit permit = permits_.issue(live_result);
    if (has_sample_counter(machine_.can)) {
        outbox_.put_permit(encode_permit(machine_.can, permit, now_us));
    }
    ++counters_.permits;
    counters_.slow += permit.word == PermitWord::slow ? 1U : 0U;
    set_line(!stop_.line.level, now_us);
}

/// Logged once a second.
bool GuardNode::lacks_session(const LiveResult& live_result, std::int64_t now_us) noexcept {
    if (permits_.has_session_of(live_result.sync_counter)) {
        log_.session_us = now_us;  // a missing session is then logged at once
        return false;
    }
    if (NodeLog::take(log_.session_us, now_us)) {
        note({.kind = LiveNote::Kind::wire,
              .frame_id = machine_.can.session_in_id,
              .words = "no session frame of the board for 300 ms: no permit"},
             now_us);
    }
    return true;
}

/// The board waits on its path, with permits and without a stop, until a crawl is proven. Informs
/// the person, because that may never happen.
void GuardNode::note_held(const CycleResult& result, std::int64_t now_us) noexcept {
    if (result.is_held && !log_.is_held) {
        note({.kind = LiveNote::Kind::wire,
              .words = "held by the cap for 2 s: not even a crawl is proven; jog the axes away, or "
                       "change the program"},
             now_us);
    }
    log_.is_held = result.is_held;
}

void GuardNode::note(LiveNote entry, std::int64_t now_us) noexcept {
    entry.time_us = now_us;
    entry.phase = guard_.phase;
    entry.cause = guard_.cause;
    if (entry.kind != LiveNote::Kind::withheld) {  // it has its own reason and pair
        entry.reason = stop_.cause.reason;
        entry.pair = stop_.cause.pair;
    }
    wire_.add(entry);
    counters_.notes_lost = log_.push(entry);
}

}  // namespace axg
