// SPDX-License-Identifier: Apache-2.0
// Shared by all formats: a set of frames, and from a complete one a coherent snapshot. The sets of
// each format: native_assembly.cpp, signal_assembly.cpp, drive_assembly.cpp.
#include <algorithm>

#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

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
            std::max(snapshot_.mode, content.mode);  // several frames may each state a mode
        snapshot_.flags |= content.flags;
    }
    if (content.has_tool) {
        snapshot_.tool = content.tool;
    }
}

bool AxisReceiver::is_complete() const noexcept {
    return seen_ == (std::uint64_t{1} << set_.frame_count) - 1U;
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
    number_sample(latch.sync_counter);
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
    if (state_ == ReceiverState::init && good_in_row_ >= init_snapshots_ && is_heartbeat_fresh() &&
        is_period_shown()) {
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
