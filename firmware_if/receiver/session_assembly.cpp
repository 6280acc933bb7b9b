// SPDX-License-Identifier: Apache-2.0
// The session that the board sends, and with it the lap of each sample. The CRC of a permit covers
// both. Source: docs/reference/board.md, "Session".
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

/// Counts as SYNC does, across lost samples too; the next session frame reveals whole laps that
/// were lost.
void AxisReceiver::number_sample(std::uint8_t sync_counter) noexcept {
    if (!has_last_) {
        // One lap more, so that a sample of the lap before has a number too.
        sync_sample_ = kSyncCounterMax + sync_counter - 1U;
        return;
    }
    sync_sample_ += (sync_counter + kSyncCounterMax - last_sync_counter_) % kSyncCounterMax;
}

/// Without a sample there are no laps to number: the next frame comes in 100 ms.
ReceiverEvent AxisReceiver::on_session_frame(const CanFrame& frame) noexcept {
    Session session;
    const FrameStatus status = decode_session(set_.session_id, frame, session);
    if (status != FrameStatus::ok) {
        return fault(fault_of(status), frame.id);
    }
    const ReceiverEvent counted = check_counter(frame, session.counter, session_slot_);
    if (counted.kind != ReceiverEvent::Kind::none || !has_last_) {
        return counted;
    }
    if (session_.on_session(session, sync_sample_) == SessionStatus::held_up) {
        return fault(ReceiverFault::held_up, frame.id);
    }
    session_us_ = now_us_;
    return event();
}

std::optional<SampleSession> AxisReceiver::session_of(std::uint8_t sync_counter) const noexcept {
    const bool is_counter = sync_counter >= 1 && sync_counter <= kSyncCounterMax;
    if (!is_counter || !has_last_ || !session_.has_session() ||
        now_us_ - session_us_ > kSessionTimeoutUs) {
        return std::nullopt;
    }
    const std::uint32_t before =
        (last_sync_counter_ + kSyncCounterMax - sync_counter) % std::uint32_t{kSyncCounterMax};
    return SampleSession{.nonce = session_.nonce(), .lap = session_.lap_of(sync_sample_ - before)};
}

}  // namespace axg
