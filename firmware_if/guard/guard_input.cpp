// SPDX-License-Identifier: Apache-2.0
// The guard node reads frames from the wire and passes each to the part that handles it.
#include "firmware_if/guard/guard_node.hpp"

namespace axg {

void GuardNode::read_frames(std::int64_t now_us) noexcept {
    reads_more_ = true;
    for (std::uint32_t i = 0; i < kFramesATurn; ++i) {
        CanArrival arrival;
        switch (wire_.read(arrival)) {
            case ReadStatus::none:
                reads_more_ = false;
                return;
            case ReadStatus::frame:
                is_down_ = false;
                on_arrival(arrival, now_us);
                break;
            case ReadStatus::down:
                is_down_ = true;
                on_wire_fault("the interface is down", now_us);
                break;
            case ReadStatus::gone:
                is_gone_ = is_down_ = true;
                reads_more_ = false;
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
    switch (handshake_.on_frame(frame)) {
        case Handshake::Heard::nothing:
            break;
        case Handshake::Heard::equal:
            pass_when_agreed(now_us);
            break;
        case Handshake::Heard::different: {
            note_hash(handshake_.theirs(), now_us);
            fail(GuardFault::refused, now_us);
            break;
        }
    }
}

/// One line a second of each part.
void GuardNode::note_hash(const HashFrame& theirs, std::int64_t now_us) noexcept {
    if (now_us < hash_note_us_[theirs.part]) {
        return;
    }
    hash_note_us_[theirs.part] = now_us + kNoteUs;
    note({.kind = LiveNote::Kind::hashes,
          .words = kHashPartNames[theirs.part],
          .ours = handshake_.ours(theirs.part),
          .theirs = theirs.hash},
         now_us);
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
        const bool is_over = has_snapshot_
                                 ? period_.may_end(arrived_us)
                                 : event.samples_lost != 0 && period_.is_of_next(arrived_us);
        if (owed_ == completed_ && is_over) {
            end_period(now_us);
        }
        has_snapshot_ = true;
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

}  // namespace axg
