// SPDX-License-Identifier: Apache-2.0
// From SYNC, heartbeat and axis frames of our own formats to one snapshot (classical and fd): never
// two instants in one, never an unknown age.
#include <algorithm>
#include <cstdlib>

#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {
namespace {

constexpr std::uint8_t kEstimatesMost = 3;   // samples in a row whose SYNC was lost
constexpr std::int64_t kSyncAgePeriods = 8;  // a stamp older than half of the 16 is another turn
// A look-ahead path may overtake the positions of its sample, or replace those that were lost.
constexpr int kLookAheadSamplesLate = 2, kLookAheadSamplesEarly = 10;

/// SYNC and heartbeat: classical, one byte, nothing else.
ReceiverFault shape_of_one_byte(const CanFrame& frame) noexcept {
    if (frame.fd) {
        return ReceiverFault::bad_format;
    }
    if (frame.raw_dlc != 0) {
        return ReceiverFault::raw_dlc;
    }
    return frame.length_bytes == 1 ? ReceiverFault::none : ReceiverFault::bad_length;
}

}  // namespace

ReceiverEvent AxisReceiver::on_sync(const CanFrame& frame) noexcept {
    const ReceiverFault shape = shape_of_one_byte(frame);
    if (shape != ReceiverFault::none) {
        return fault(shape, frame.id);
    }
    const std::uint8_t counter = frame.data[0];
    if (counter < 1 || counter > kSyncCounterMax) {
        return fault(ReceiverFault::bad_format, frame.id);
    }
    const auto index = static_cast<std::uint8_t>(counter - 1);
    const Sequence sequence = sync_sequence_.next(index);
    if (sequence == Sequence::repeated) {
        return fault(ReceiverFault::repeated, frame.id);  // the earlier stamp stays: the safe one
    }
    if (sequence == Sequence::wrong) {
        restart(sync_period_);
        return fault(ReceiverFault::wrong_sequence, frame.id);
    }
    bool is_in_time = true;
    int steps = 1;
    if (last_sync_.counter != 0) {
        steps = (counter + kSyncCounterMax - last_sync_.counter) % kSyncCounterMax;
        const std::int64_t wanted_us = std::int64_t{steps} * set_.sample_us;
        const std::int64_t off_us = frame.time_us - last_sync_.time_us - wanted_us;
        is_in_time = std::abs(off_us) <= set_.sample_us / 5;
    }
    // Our clock was set back: it measures nothing across that, and this stamp may be the only one.
    const bool is_set_back = last_sync_.counter != 0 && frame.time_us < last_sync_.time_us;
    if (is_set_back) {
        restart(sync_period_);
    }
    // The frame's own stamp, even if it is before the clock: a sample may only look older.
    last_sync_ = {counter, frame.time_us};
    sync_stamps_[index % 16U] = last_sync_;
    window_us_ = now_us_;
    window_frames_ = 0;
    if (!is_set_back && is_period_wrong(sync_period_, steps, frame.time_us)) {
        return fault(ReceiverFault::sync_period, frame.id);
    }
    return is_in_time ? event() : fault(ReceiverFault::sync_early_or_late, frame.id);
}

ReceiverEvent AxisReceiver::on_heartbeat(const CanFrame& frame) noexcept {
    const ReceiverFault shape = shape_of_one_byte(frame);
    if (shape != ReceiverFault::none) {
        return fault(shape, frame.id);
    }
    const std::uint8_t node_state = frame.data[0];
    if (node_state == kHeartbeatOperational) {
        has_heartbeat_ = true;
        heartbeat_us_ = now_us_;
        return event();
    }
    const bool is_known = node_state == 0 || node_state == 4 || node_state == 127;
    if (!is_known) {
        return fault(ReceiverFault::bad_format, frame.id);
    }
    has_heartbeat_ = false;
    return state_ == ReceiverState::valid ? fault(ReceiverFault::heartbeat_state, frame.id)
                                          : event();
}

/// Counts samples as in the snapshots, so it needs a snapshot first. A frame may arrive before or
/// after the positions of its sample.
ReceiverEvent AxisReceiver::on_look_ahead_frame(const CanFrame& frame) noexcept {
    LookAheadFrameContent content;
    const FrameStatus status = decode_look_ahead_frame(set_, frame, content);
    if (status != FrameStatus::ok) {
        return fault(fault_of(status), frame.id);
    }
    const ReceiverEvent counted = check_counter(frame, content.counter, look_ahead_slot_);
    if (counted.kind != ReceiverEvent::Kind::none || !has_last_) {
        return counted;
    }
    const int modulus = static_cast<int>(index_modulus_);
    int off = (content.sync_counter - 1 - last_index_ + modulus) % modulus;
    off -= off > modulus / 2 ? modulus : 0;
    if (off < -kLookAheadSamplesLate || off > kLookAheadSamplesEarly) {
        return fault(ReceiverFault::late_sample, frame.id);
    }
    ReceiverEvent event = this->event();
    event.kind = ReceiverEvent::Kind::look_ahead;
    event.look_ahead.sample = last_sample_ + content.samples + static_cast<std::uint64_t>(off);
    event.look_ahead.position = content.position;
    event.look_ahead.before = content.before;
    ++counters_.look_ahead;
    return event;
}

ReceiverEvent AxisReceiver::assemble(const AxisFrameContent& content, std::uint32_t slot,
                                     std::uint32_t frame_id) noexcept {
    const std::uint32_t modulus = index_modulus_;
    const auto index = static_cast<std::uint8_t>(
        set_.format == CanFormat::fd ? content.sample_index - 1U : content.sample_index);
    const auto ahead_of = [&](std::uint32_t other) { return (index + modulus - other) % modulus; };
    if (has_last_) {
        const std::uint32_t ahead = ahead_of(last_index_);
        if (ahead == 0) {
            return fault(ReceiverFault::sample_repeated, frame_id);
        }
        if (ahead > modulus / 2) {
            return fault(ReceiverFault::late_sample, frame_id);
        }
    }
    bool is_torn = false;
    if (seen_ != 0) {
        const std::uint32_t ahead = ahead_of(set_index_);
        if (ahead > modulus / 2) {
            return fault(ReceiverFault::late_sample, frame_id);
        }
        is_torn = ahead != 0 || (seen_ >> slot & 1U) != 0;
    }
    if (seen_ == 0 || is_torn) {
        begin_set(index);
    }
    add_to_set(content, slot);
    if (is_torn) {
        return fault(ReceiverFault::torn, frame_id);
    }
    return is_complete() ? finish(content, frame_id) : event();
}

/// The instant at which this sample was latched: its SYNC, or one extrapolated from the last sample
/// for a few samples when SYNC frames are lost. Never later than the first frame of the set.
AxisReceiver::Latch AxisReceiver::latch_of(std::uint8_t sample_index,
                                           std::uint32_t steps) noexcept {
    const SyncStamp& stamp = sync_stamps_[sample_index % 16U];
    const std::int64_t period_us = set_.sample_us;
    const std::int64_t elapsed_us = steps * period_us;
    const std::int64_t expected_us = sync_base_us_ + elapsed_us;
    const bool is_its_own =
        set_.format == CanFormat::fd ? stamp.counter == sample_index + 1 : stamp.counter != 0;
    if (is_its_own && set_first_us_ - stamp.time_us <= kSyncAgePeriods * period_us) {
        estimates_ = 0;
        return dated(std::min(stamp.time_us, set_first_us_), stamp.counter, steps);
    }
    if (!has_last_ || estimates_ >= kEstimatesMost) {
        return {};
    }
    ++estimates_;
    ++counters_.estimated;
    const auto counter =
        static_cast<std::uint8_t>((last_sync_counter_ - 1U + steps) % kSyncCounterMax + 1U);
    return {true, std::min(expected_us, set_first_us_), counter, expected_us};
}

/// A sender whose clock stops while its counter runs repeats old values in fresh frames. If its
/// clock shows that the frames were delayed together with their SYNC, it determines the age of the
/// sample. Its periods count from the sample that it dated last, delivered or not.
ReceiverFault AxisReceiver::judge_sender_clock(std::uint32_t sender_us, Latch& latch) noexcept {
    const std::uint32_t steps = (set_index_ + index_modulus_ - sender_index_) % index_modulus_;
    const std::int64_t elapsed_us = static_cast<std::uint32_t>(sender_us - last_sender_us_);
    const std::int64_t wanted_us = std::int64_t{steps} * set_.sample_us;
    if (has_sender_ && std::abs(elapsed_us - wanted_us) * 5 > wanted_us) {
        // The reference is unchanged: a stopped clock is refused until the data is stale.
        return ReceiverFault::sender_clock;
    }
    sender_index_ = set_index_;
    last_sender_us_ = sender_us;
    if (has_sender_) {
        sender_elapsed_us_ += elapsed_us;
        sender_offset_us_ = std::min(sender_offset_us_ + elapsed_us / kClockPart + 1,
                                     latch.time_us - sender_elapsed_us_);
        latch.time_us = std::min(latch.time_us, sender_elapsed_us_ + sender_offset_us_);
    } else {
        has_sender_ = true;
        sender_elapsed_us_ = 0;
        sender_offset_us_ = latch.time_us;
    }
    return is_period_wrong(sender_period_, steps, sender_elapsed_us_) ? ReceiverFault::sync_period
                                                                      : ReceiverFault::none;
}

ReceiverEvent AxisReceiver::finish(const AxisFrameContent& content,
                                   std::uint32_t frame_id) noexcept {
    seen_ = 0;
    const std::uint32_t modulus = index_modulus_;
    const std::uint32_t steps = has_last_ ? (set_index_ + modulus - last_index_) % modulus : 1U;
    Latch latch = latch_of(set_index_, steps);
    if (!latch.is_known) {
        return fault(ReceiverFault::sync_missing, frame_id);
    }
    const ReceiverFault wrong = set_.format == CanFormat::fd
                                    ? judge_sender_clock(content.sender_time_us, latch)
                                    : ReceiverFault::none;
    if (wrong != ReceiverFault::none) {
        return fault(wrong, frame_id);
    }
    return deliver(latch, steps, frame_id);
}

}  // namespace axg
