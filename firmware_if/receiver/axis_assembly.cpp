// SPDX-License-Identifier: Apache-2.0
// From good frames to one coherent snapshot: never two instants in one, never an unknown age.
#include <algorithm>

#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {
namespace {

constexpr std::int64_t kDriftShare = 5000;   // sender clocks drift by at most 200 ppm
constexpr std::int64_t kPeriodPart = 100;    // the board's period is sample_us to 1 percent
constexpr std::int64_t kSyncAgePeriods = 8;  // a stamp older than half the 16 kept is another turn

}  // namespace

void AxisReceiver::begin_set(std::uint8_t sample_index) noexcept {
    seen_ = 0;
    set_index_ = sample_index;
    set_first_us_ = now_us_;
    snapshot_ = AxisSnapshot{};
    snapshot_.axis_count = set_.axis_count;
}

void AxisReceiver::add_to_set(const AxisFrameContent& content, std::uint32_t slot) noexcept {
    seen_ |= std::uint64_t{1} << slot;
    for (std::uint32_t i = 0; i < content.value_count; ++i) {
        const auto& value = content.values[i];
        snapshot_.position[value.axis] = value.position;
        raw_[value.axis] = value.raw;
    }
    if (content.has_status) {
        snapshot_.mode =
            std::max(snapshot_.mode, content.mode);  // several frames may have their say
        snapshot_.flags |= content.flags;
    }
    if (content.has_tool) {
        snapshot_.tool = content.tool;
    }
}

bool AxisReceiver::is_complete() const noexcept {
    return seen_ == (std::uint64_t{1} << set_.frame_count) - 1U;
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

/// Frames of other makers carry neither counter nor index: a set is what arrives within one period,
/// each id once. Its number follows from its arrival.
ReceiverEvent AxisReceiver::assemble_signals(const AxisFrameContent& content, std::uint32_t slot,
                                             std::uint32_t frame_id) noexcept {
    const bool is_torn =
        seen_ != 0 && ((seen_ >> slot & 1U) != 0 || now_us_ - set_first_us_ > set_.sample_us);
    if (seen_ == 0 || is_torn) {
        begin_set(0);
    }
    add_to_set(content, slot);
    if (is_torn) {
        return fault(ReceiverFault::torn, frame_id);
    }
    if (!is_complete()) {
        return event();
    }
    seen_ = 0;
    const ArrivalNumber number = number_arrival(arrivals_, set_first_us_);
    arrival_steps_ += number.steps;  // a sample that is not handed out counts for the next one
    if (!number.is_in_time) {
        return fault(ReceiverFault::arrival_jitter, frame_id);
    }
    const std::uint32_t steps = has_last_ ? arrival_steps_ : 1U;
    const ReceiverEvent event = deliver({true, set_first_us_, 0, set_first_us_}, steps, frame_id);
    arrival_steps_ = event.kind == ReceiverEvent::Kind::snapshot ? 0 : arrival_steps_;
    return event;
}

/// A SYNC held up in a queue must not make its sample younger: it counts as late by the tolerance
/// of its period and no more, and late ones in a row move the base slowly.
AxisReceiver::Latch AxisReceiver::dated(std::int64_t stamp_us, std::uint8_t sync_counter,
                                        std::uint32_t steps) const noexcept {
    if (!has_last_) {
        return {true, stamp_us, sync_counter, stamp_us};
    }
    const std::int64_t elapsed_us = std::int64_t{steps} * set_.sample_us;
    const std::int64_t expected_us = sync_base_us_ + elapsed_us;
    return {true, std::min<std::int64_t>(stamp_us, expected_us + set_.sample_us / 5), sync_counter,
            std::min(stamp_us, expected_us + elapsed_us / kPeriodPart + 1)};
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
    if (!has_last_ || estimates_ >= estimates_max_) {
        return {};
    }
    ++estimates_;
    ++counters_.estimated;
    const auto counter =
        static_cast<std::uint8_t>((last_sync_counter_ - 1U + steps) % kSyncCounterMax + 1U);
    return {true, std::min(expected_us, set_first_us_), counter, expected_us};
}

/// A sender whose clock stands while its counter runs repeats old values in fresh frames. Where its
/// clock shows that the frames were held up together with their SYNC, the sample is as old as the
/// clock says.
bool AxisReceiver::sender_clock_is_plausible(std::uint32_t sender_us, std::uint32_t steps,
                                             Latch& latch) noexcept {
    if (!has_sender_) {
        has_sender_ = true;
        last_sender_us_ = sender_us;
        sender_elapsed_us_ = 0;
        sender_offset_us_ = latch.time_us;
        return true;
    }
    const std::int64_t elapsed_us = static_cast<std::uint32_t>(sender_us - last_sender_us_);
    const std::int64_t wanted_us = std::int64_t{steps} * set_.sample_us;
    if (std::abs(elapsed_us - wanted_us) * 5 > wanted_us) {
        return false;  // the reference stays: a clock that stands is refused until it is stale
    }
    last_sender_us_ = sender_us;
    sender_elapsed_us_ += elapsed_us;
    sender_offset_us_ = std::min(sender_offset_us_ + elapsed_us / kDriftShare + 1,
                                 latch.time_us - sender_elapsed_us_);
    latch.time_us = std::min(latch.time_us, sender_elapsed_us_ + sender_offset_us_);
    return true;
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
    if (set_.format == CanFormat::fd &&
        !sender_clock_is_plausible(content.sender_time_us, steps, latch)) {
        return fault(ReceiverFault::sender_clock, frame_id);
    }
    return deliver(latch, steps, frame_id);
}

ReceiverEvent AxisReceiver::deliver(Latch latch, std::uint32_t steps,
                                    std::uint32_t frame_id) noexcept {
    const std::int64_t age_us = now_us_ - latch.time_us;
    if (age_us > stale_after_us_) {
        return fault(ReceiverFault::too_old, frame_id);
    }
    const SnapshotFault wrong = check_.check(snapshot_, raw_, steps);
    if (wrong.fault != ReceiverFault::none) {
        return fault(wrong.fault, frame_id, wrong.axis);
    }
    const std::uint32_t lost = has_last_ ? steps - 1 : 0;
    if (lost != 0) {
        good_in_row_ = 0;
        count_loss(lost);
    }
    loss_level_ -= loss_level_ > 0 ? 1 : 0;
    if (loss_level_ > kLossLimit) {
        return fault(ReceiverFault::loss_limit, frame_id);
    }
    counters_.late += age_us > set_.sample_us ? 1 : 0;
    if (has_last_) {
        last_sample_ += steps;
    } else if (has_history_) {  // after an acknowledge: by the clock, at least one
        const std::int64_t gap_us = latch.time_us - last_latched_us_;
        last_sample_ +=
            static_cast<std::uint64_t>(std::max<std::int64_t>(1, gap_us / set_.sample_us));
    }
    has_last_ = has_history_ = true;
    last_index_ = set_index_;
    last_sync_counter_ = latch.sync_counter;
    last_latched_us_ = latch.time_us;
    sync_base_us_ = latch.base_us;
    snapshot_.latched_us = latch.time_us;
    snapshot_.arrived_us = now_us_;
    snapshot_.sample = last_sample_;
    ++counters_.snapshots;
    good_in_row_ = static_cast<std::uint8_t>(std::min(good_in_row_ + 1, 255));
    if (state_ == ReceiverState::init && good_in_row_ >= init_snapshots_ && is_heartbeat_fresh()) {
        state_ = ReceiverState::valid;
    }
    ReceiverEvent event = this->event();
    event.kind = ReceiverEvent::Kind::snapshot;
    event.sync_counter = latch.sync_counter;
    event.samples_lost = lost;
    event.snapshot = snapshot_;
    return event;
}

}  // namespace axg
