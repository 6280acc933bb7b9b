// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/bus_view.hpp"

#include <algorithm>

#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/seen_frames.hpp"

namespace axg {

BusView::BusView(const Machine& machine, const ConfigurationHashes& hashes) noexcept
    : machine_(machine), hashes_(hashes), receiver_(machine) {
    latched_us_.fill(kNeverSeen);
}

void BusView::on_frame(const CanFrame& frame) noexcept {
    on_event(receiver_.on_frame(frame));
    if (frame.error || frame.extended || frame.remote) {
        return;
    }
    ++state_.frames;
    if (is_stop_frame(machine_.can, frame)) {
        state_.stop_us = frame.time_us;
        state_.permit_end_us = kNeverSeen;
    } else if (is_guard_id(machine_.can, frame.id) && frame.id != machine_.can.sync_id) {
        read_guard_frame(frame) ? void(state_.guard_us = frame.time_us) : void(++state_.bad);
    }
}

void BusView::on_time(std::int64_t now_us) noexcept {
    on_event(receiver_.on_time(now_us));
    if (receiver_.state() == ReceiverState::invalid) {
        receiver_.acknowledge();  // a display has nothing to stop: it reads on
    }
}

void BusView::on_event(const ReceiverEvent& event) noexcept {
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        state_.axes = event.snapshot;
        state_.board_us = event.time_us;
        if (event.sync_counter < latched_us_.size()) {
            latched_us_[event.sync_counter] = event.snapshot.latched_us;
        }
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        state_.input_fault = event.fault;
        state_.input_fault_us = event.time_us;
    }
}

bool BusView::read_guard_frame(const CanFrame& frame) noexcept {
    const CanLayout& can = machine_.can;
    if (frame.id == can.permit_id || frame.id == can.permit_id + 1) {
        return read_permit(frame);
    }
    if (frame.id == can.heartbeat_out_id) {
        return read_heartbeat(frame);
    }
    if (frame.id == can.emergency_id) {
        return read_emergency(frame);
    }
    if (frame.id == can.hashes_out_id && can.hashes_out_id != 0) {
        return read_hash(frame);
    }
    if (has_sample_counter(can) && frame.id == can.hints_id) {
        return note_hints(frame);
    }
    if (has_sample_counter(can) && frame.id == can.operator_out_id) {
        return read_phase(frame);
    }
    return true;  // a quick stop: its content is for the drive
}

bool BusView::read_permit(const CanFrame& frame) noexcept {
    const CanLayout& can = machine_.can;
    if (frame.id == can.permit_id) {
        const bool was_waiting = has_plain_;
        plain_ = frame;
        has_plain_ = true;
        return !was_waiting;  // two plain frames in a row: the first has no twin
    }
    const std::optional<SeenPermit> seen =
        has_plain_ ? axg::read_permit(can, plain_, frame) : std::nullopt;
    has_plain_ = false;
    if (!seen) {
        return false;
    }
    state_.answer = PermitAnswer::unknown;
    if (const auto session = receiver_.session_of(seen->permit.sync_counter)) {
        Permit wanted = seen->permit;
        wanted.nonce = session->nonce;
        wanted.lap = session->lap;
        state_.answer =
            answer_of(can, wanted) == seen->answer ? PermitAnswer::right : PermitAnswer::wrong;
    }
    note_permit(seen->permit, frame.time_us);
    return true;
}

void BusView::note_permit(const Permit& permit, std::int64_t now_us) noexcept {
    state_.permit = permit;
    state_.permit_us = now_us;
    if (permit.word == PermitWord::stop) {
        state_.permit_end_us = kNeverSeen;
        return;
    }
    if (state_.answer == PermitAnswer::wrong) {
        return;  // a board refuses it
    }
    // From the sample's latch; of a sample that this program has not seen, from the arrival.
    const std::int64_t latched_us =
        permit.sync_counter < latched_us_.size() ? latched_us_[permit.sync_counter] : kNeverSeen;
    const std::int64_t from_us =
        latched_us == kNeverSeen || now_us - latched_us > std::int64_t{machine_.can.sample_us} * 16
            ? now_us
            : latched_us;
    state_.permit_end_us =
        std::max(state_.permit_end_us,
                 from_us + std::int64_t{permit.samples} * std::int64_t{machine_.can.sample_us});
}

bool BusView::note_hints(const CanFrame& frame) noexcept {
    const std::optional<Hints> hints = read_hints(machine_.can, frame);
    if (!hints || (hints->pair != kHintNone && hints->pair >= machine_.pairs.size())) {
        return false;
    }
    state_.hints = hints;
    state_.hints_us = frame.time_us;
    return true;
}

bool BusView::read_hash(const CanFrame& frame) noexcept {
    HashFrame content;
    if (!decode_hash(frame, content) || content.part >= kHashParts) {
        return false;
    }
    const std::uint32_t bit = 1U << content.part;
    const bool is_equal = content.hash == hashes_.of[content.part];
    state_.other_hashes = is_equal ? state_.other_hashes & ~bit : state_.other_hashes | bit;
    return true;
}

bool BusView::read_emergency(const CanFrame& frame) noexcept {
    Emergency emergency;
    if (decode_emergency(machine_.can, frame, emergency) != GuardFrameStatus::ok) {
        return false;
    }
    state_.emergency =
        emergency.code == EmergencyCode::reset ? std::nullopt : std::optional(emergency);
    return true;
}

bool BusView::read_heartbeat(const CanFrame& frame) noexcept {
    GuardHeartbeat heartbeat = GuardHeartbeat::silent;
    if (decode_guard_heartbeat(machine_.can, frame, heartbeat) != GuardFrameStatus::ok) {
        return false;
    }
    state_.heartbeat = heartbeat;
    state_.heartbeat_us = frame.time_us;
    return true;
}

bool BusView::read_phase(const CanFrame& frame) noexcept {
    const std::optional<OperatorStatus> status = read_operator_status(machine_.can, frame);
    if (!status) {
        return false;
    }
    state_.phase = status->phase;
    state_.phase_us = frame.time_us;
    return true;
}

}  // namespace axg
