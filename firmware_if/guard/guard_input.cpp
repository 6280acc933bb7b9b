// SPDX-License-Identifier: Apache-2.0
// What comes in: frames from the wire, each passed to the part that handles it, and a person's
// reset and arm, by call and by frames.
#include "firmware_if/guard/guard_node.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNoMessage = kOperatorRefusals, kNoCounter = kOperatorRefusals + 1;
static_assert(kNoCounter < kOperatorNotes);

const char* words_of(OperatorAction action, OperatorRefusal refusal) noexcept {
    const bool is_arm = action == OperatorAction::arm;
    switch (refusal) {
        case OperatorRefusal::moves:
            return is_arm ? "arm: the axes are not at rest" : "reset: the axes are not yet at rest";
        case OperatorRefusal::cause:
            return "reset: a fault is still present";
        case OperatorRefusal::phase:
            return is_arm ? "arm: the guard is not ready" : "reset: nothing is latched";
        case OperatorRefusal::nonce:
            return is_arm ? "arm: confirmed with a wrong nonce"
                          : "reset: confirmed with a wrong nonce";
        case OperatorRefusal::too_late:
            return is_arm ? "arm: confirmed later than 5 s" : "reset: confirmed later than 5 s";
        case OperatorRefusal::board:
            return "arm: the board stopped by itself and has the nonce of then: arm the board "
                   "first";
        case OperatorRefusal::none:
            break;
    }
    return "";
}

}  // namespace

void GuardNode::read_frames(std::int64_t now_us) noexcept {
    bus_.reads_more = true;
    for (std::uint32_t i = 0; i < kFramesATurn; ++i) {
        CanArrival arrival;
        switch (wire_.read(arrival)) {
            case ReadStatus::none:
                bus_.reads_more = false;
                return;
            case ReadStatus::frame:
                bus_.is_down = false;
                on_arrival(arrival, now_us);
                break;
            case ReadStatus::down:
                bus_.is_down = true;
                on_wire_fault("the interface is down", now_us);
                break;
            case ReadStatus::gone:
                bus_.is_gone = bus_.is_down = true;
                bus_.reads_more = false;
                on_wire_fault("the interface was removed", now_us);
                return;
            case ReadStatus::failed:
                on_wire_fault("cannot read the socket", now_us);
                break;
        }
    }
    ++counters_.frames_left;
}

void GuardNode::on_wire_fault(const char* words, std::int64_t now_us) noexcept {
    note({.kind = LiveNote::Kind::wire, .words = words}, now_us);
    fail(GuardFault::input, now_us);
}

void GuardNode::on_arrival(const CanArrival& arrival, std::int64_t now_us) noexcept {
    const CanFrame& frame = arrival.frame;
    if (arrival.is_own) {
        ++counters_.echoes;
        outbox_.on_echo(frame);
        if (machine_.can.guard_sends_sync && frame.id == machine_.can.sync_id) {
            on_own_sync(frame, now_us);
        }
        return;
    }
    if (!frame.error && !frame.extended && is_guard_id(machine_.can, frame.id)) {
        on_foreign(frame, "a guard frame from another sender", GuardFault::second_guard, now_us);
        return;
    }
    if (is_stop_frame(machine_.can, frame)) {
        on_foreign(frame, "a stop frame from another sender", GuardFault::foreign_stop, now_us);
        return;
    }
    if (has_sample_counter(machine_.can) && frame.id == machine_.can.operator_in_id &&
        !frame.error && !frame.extended && !frame.remote) {
        on_operator(frame, now_us);
        return;
    }
    on_hash(frame, now_us);
    standstill_.on_frame(frame);
    on_receiver(receiver_.on_frame(frame), now_us);
}

void GuardNode::on_foreign(const CanFrame& frame, const char* words, GuardFault fault,
                           std::int64_t now_us) noexcept {
    note({.kind = LiveNote::Kind::wire, .frame_id = frame.id, .words = words}, now_us);
    fail(fault, now_us);
}

/// The echo of the guard's SYNC dates the sample. A SYNC later than the jitter that every proof
/// supposes violates a premise: a stop.
void GuardNode::on_own_sync(const CanFrame& frame, std::int64_t now_us) noexcept {
    if (!is_sync_in_time(sync_, frame.data[0], frame.time_us)) {
        note({.kind = LiveNote::Kind::wire,
              .frame_id = frame.id,
              .words = "the guard's SYNC ended later than guard.latch_jitter_us"},
             now_us);
        fail(GuardFault::input, now_us);
    }
    CanFrame sync = frame;
    sync.sent_by_host = false;  // the guard sent it, no other program of this host
    standstill_.on_frame(sync);
    on_receiver(receiver_.on_frame(sync), now_us);
}

void GuardNode::on_hash(const CanFrame& frame, std::int64_t now_us) noexcept {
    Handshake& handshake = announcements_.handshake();
    switch (handshake.on_frame(frame)) {
        case Handshake::Heard::nothing:
            break;
        case Handshake::Heard::equal:
            pass_when_agreed(now_us);
            break;
        case Handshake::Heard::different: {
            note_hash(handshake.theirs(), now_us);
            fail(GuardFault::refused, now_us);
            break;
        }
    }
}

/// One line a second of each part.
void GuardNode::note_hash(const HashFrame& theirs, std::int64_t now_us) noexcept {
    if (NodeLog::take(log_.hash_us[theirs.part], now_us)) {
        note({.kind = LiveNote::Kind::hashes,
              .words = kHashPartNames[theirs.part],
              .ours = announcements_.handshake().ours(theirs.part),
              .theirs = theirs.hash},
             now_us);
    }
}

void GuardNode::note_fault(const ReceiverEvent& event, std::int64_t now_us) noexcept {
    LiveNote out{.kind = LiveNote::Kind::input,
                 .fault = event.fault,
                 .frame_id = event.frame_id,
                 .axis = event.axis};
    if (event.fault == ReceiverFault::sync_period) {
        out.ours = static_cast<std::uint32_t>(1000 * times_.period_us);
        out.theirs = static_cast<std::uint32_t>(receiver_.counters().measured_period_ns);
    }
    note(out, now_us);
}

void GuardNode::on_receiver(const ReceiverEvent& event, std::int64_t now_us) noexcept {
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        ++counters_.snapshots;
        period_.follow(event.snapshot.arrived_us,
                       guard_.phase != GuardPhase::armed && guard_.good == 0);
        // A period belongs to one sample. If that sample was evaluated or lost, this one belongs to
        // the next period, however late the bus delivered the one before.
        const std::int64_t arrived_us = event.snapshot.arrived_us;
        const bool is_over = period_.has_snapshot()
                                 ? period_.may_end(arrived_us)
                                 : event.samples_lost != 0 && period_.is_of_next(arrived_us);
        if (link_.is_idle() && is_over) {
            end_period(now_us);
        }
        period_.take_snapshot();
        submit(LiveQuery::Kind::snapshot, event, now_us);
        if (event.samples_lost != 0) {
            fail(GuardFault::input_noise, now_us);
        }
    } else if (event.kind == ReceiverEvent::Kind::look_ahead) {
        submit(LiveQuery::Kind::look_ahead, event, now_us);
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        note_fault(event, now_us);
        fail(GuardFault::input, now_us);
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::drop) {
        fail(GuardFault::input_noise, now_us);
    }
}

void GuardNode::arm(std::int64_t now_us) noexcept {
    wire_.set_time(now_us);
    wire_.add(LiveCall{.kind = LiveCall::Kind::arm});
    const OperatorRefusal refusal = hindrance_of(OperatorAction::arm, now_us);
    if (refusal == OperatorRefusal::none) {
        permits_.forget_own_stop();
        on({.kind = GuardEventKind::arm}, now_us);
    } else if (guard_.phase != GuardPhase::armed) {
        note({.kind = LiveNote::Kind::refused, .words = words_of(OperatorAction::arm, refusal)},
             now_us);
    }
}

void GuardNode::reset(std::int64_t now_us) noexcept {
    wire_.set_time(now_us);
    wire_.add(LiveCall{.kind = LiveCall::Kind::reset});
    const OperatorRefusal refusal = hindrance_of(OperatorAction::reset, now_us);
    if (refusal == OperatorRefusal::none) {
        on({.kind = GuardEventKind::reset_edge}, now_us);
    } else {
        note({.kind = LiveNote::Kind::refused, .words = words_of(OperatorAction::reset, refusal)},
             now_us);
    }
}

/// The reason why that action would have no effect now; none: it would have one.
OperatorRefusal GuardNode::hindrance_of(OperatorAction action, std::int64_t now_us) noexcept {
    if (action == OperatorAction::arm) {
        const bool may_move = supposes_arming_ && !permits_.has_own_stop();
        return guard_.phase != GuardPhase::ready          ? OperatorRefusal::phase
               : !may_move && !standstill_.stands(now_us) ? OperatorRefusal::moves
               : permits_.waits_for_board()               ? OperatorRefusal::board
                                                          : OperatorRefusal::none;
    }
    if (guard_.phase != GuardPhase::stopped) {
        return OperatorRefusal::phase;
    }
    check_standstill(now_us);
    if (!guard_.is_confirmed) {
        return OperatorRefusal::moves;
    }
    Guard tried = guard_;
    static_cast<void>(on_event(tried, {.kind = GuardEventKind::reset_edge}, live_limits(times_)));
    return tried.phase == GuardPhase::stopped ? OperatorRefusal::cause : OperatorRefusal::none;
}

void GuardNode::on_operator(const CanFrame& frame, std::int64_t now_us) noexcept {
    OperatorMessage message;
    if (decode_operator_message(machine_.can, frame, message) != FrameStatus::ok) {
        ++counters_.operator_ignored;
        note_operator(kNoMessage, "a frame that is not an operator message", now_us);
        return;
    }
    const OperatorRefusal hindrance = hindrance_of(message.action, now_us);
    switch (hear(operator_, message, hindrance, now_us)) {
        case OperatorHearing::ignored:
            ++counters_.operator_ignored;
            note_operator(kNoCounter, "an operator message whose counter did not advance by 1",
                          now_us);
            break;
        case OperatorHearing::refused:
            ++counters_.operator_refused;
            note_operator(static_cast<std::uint32_t>(operator_.refusal),
                          words_of(message.action, operator_.refusal), now_us);
            break;
        case OperatorHearing::asked:
            break;
        case OperatorHearing::confirmed: {
            ++counters_.operator_acts;
            const bool is_arm = message.action == OperatorAction::arm;
            note({.kind = LiveNote::Kind::person,
                  .frame_id = frame.id,
                  .words = is_arm ? "an operator arms" : "an operator resets"},
                 now_us);
            if (is_arm) {
                permits_.forget_own_stop();
            }
            on({.kind = is_arm ? GuardEventKind::arm : GuardEventKind::reset_edge}, now_us);
            break;
        }
    }
}

/// Logs at most one line a second of each kind.
void GuardNode::note_operator(std::uint32_t kind, const char* words, std::int64_t now_us) noexcept {
    if (NodeLog::take(log_.operator_us[kind], now_us)) {
        note({.kind = LiveNote::Kind::refused,
              .frame_id = machine_.can.operator_in_id,
              .words = words},
             now_us);
    }
}

}  // namespace axg
