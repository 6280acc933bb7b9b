// SPDX-License-Identifier: Apache-2.0
// Our own formats, classical and fd.
#include <algorithm>
#include <cstdlib>

#include "firmware_if/receiver/assembler.hpp"

namespace axg {
namespace {

constexpr std::uint8_t kEstimatesMost = 3;   // samples in a row whose SYNC was lost
constexpr std::int64_t kSyncAgePeriods = 8;  // a stamp older than half of the 16 is another turn

}  // namespace

NativeAssembler::NativeAssembler(const CanLayout& can, const AxisFrameSet& set) noexcept
    : modulus_(set.wire->index_modulus), sync_{.sequence = sequence_of(can, set.sync_counter_max)} {
    if (set.wire->has_sender_clock) {
        sender_clock_.emplace();
    }
}

void NativeAssembler::forget() noexcept {
    sync_.forget();
    sync_stamps_.fill({});
    estimates_ = 0;
    if (sender_clock_) {
        sender_clock_->is_known = false;
    }
}

Assembly NativeAssembler::on_sync(const CanFrame& frame, ReceivedSamples& samples) noexcept {
    const SyncWatch::Step step = sync_.judge(frame, samples.period_us);
    const bool is_good = step.fault == ReceiverFault::none;
    if (is_good ? step.is_set_back : step.fault == ReceiverFault::wrong_sequence) {
        restart(samples.by_sync.watch);
    }
    if (!is_good) {
        return {.fault = step.fault};  // repeated: the earlier stamp stays, the safe one
    }
    // The frame's own stamp, even if it is before the clock: a sample may only look older.
    sync_stamps_[(frame.data[0] - 1U) % 16U] = {frame.data[0], frame.time_us};
    return sync_.take(frame, step, false, samples);
}

Assembly NativeAssembler::on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept {
    const std::uint8_t index = axis.content.sample_index;
    const auto ahead_of = [&](std::uint32_t other) {
        return (index + modulus_ - other) % modulus_;
    };
    if (samples.last.is_known) {
        const std::uint32_t ahead = ahead_of(samples.last.index);
        if (ahead == 0) {
            return {.fault = ReceiverFault::sample_repeated};
        }
        if (ahead > modulus_ / 2) {
            return {.fault = ReceiverFault::late_sample};
        }
    }
    SampleSet& set = samples.set;
    bool is_torn = false;
    if (set.seen != 0) {
        const std::uint32_t ahead = ahead_of(set.index);
        if (ahead > modulus_ / 2) {
            return {.fault = ReceiverFault::late_sample};
        }
        is_torn = ahead != 0 || set.has(axis.slot);
    }
    if (set.seen == 0 || is_torn) {
        samples.begin(index);
    }
    set.add(axis.content, axis.slot);
    if (is_torn) {
        return {.fault = ReceiverFault::torn};
    }
    return set.is_complete() ? finish(axis.content.sender_time_us, samples) : Assembly{};
}

Assembly NativeAssembler::finish(std::uint32_t sender_us, ReceivedSamples& samples) noexcept {
    samples.set.seen = 0;
    Assembly out;
    if (samples.last.is_known) {
        out.steps = (samples.set.index + modulus_ - samples.last.index) % modulus_;
    }
    date(samples, out);
    if (!out.latch) {
        out.fault = ReceiverFault::sync_missing;
    } else if (sender_clock_) {
        out.fault = sender_clock_->judge(sender_us, modulus_, samples, *out.latch);
    }
    return out;
}

/// The instant at which this sample was latched: its SYNC, or one extrapolated from the last sample
/// for a few samples when SYNC frames are lost. Never later than the first frame of the set.
void NativeAssembler::date(const ReceivedSamples& samples, Assembly& out) noexcept {
    const std::int64_t first_us = samples.set.first_us;
    const SyncStamp& stamp = sync_stamps_[samples.set.index % 16U];
    const bool is_its_own =
        stamp.counter != 0 && (stamp.counter - 1U) % modulus_ == samples.set.index;
    if (is_its_own && first_us - stamp.time_us <= kSyncAgePeriods * samples.period_us) {
        estimates_ = 0;
        out.latch = samples.dated(std::min(stamp.time_us, first_us), stamp.counter, out.steps);
        return;
    }
    if (!samples.last.is_known || estimates_ >= kEstimatesMost) {
        return;
    }
    ++estimates_;
    out.is_estimated = true;
    const std::int64_t expected_us = samples.last.base_us + out.steps * samples.period_us;
    const auto counter = static_cast<std::uint8_t>(
        (samples.last.sync_counter - 1U + out.steps) % kSyncCounterMax + 1U);
    out.latch = Latch{std::min(expected_us, first_us), counter, expected_us};
}

ReceiverFault SenderClock::judge(std::uint32_t sender_us, std::uint32_t modulus,
                                 ReceivedSamples& samples, Latch& latch) noexcept {
    const std::uint32_t steps = (samples.set.index + modulus - index) % modulus;
    const std::int64_t since_us = static_cast<std::uint32_t>(sender_us - last_us);
    const std::int64_t wanted_us = steps * samples.period_us;
    if (is_known && std::abs(since_us - wanted_us) * 5 > wanted_us) {
        // The reference is unchanged: a stopped clock is refused until the data is stale.
        return ReceiverFault::sender_clock;
    }
    index = samples.set.index;
    last_us = sender_us;
    if (is_known) {
        elapsed_us += since_us;
        offset_us = std::min(offset_us + since_us / kClockPart + 1, latch.time_us - elapsed_us);
        latch.time_us = std::min(latch.time_us, elapsed_us + offset_us);
    } else {
        is_known = true;
        elapsed_us = 0;
        offset_us = latch.time_us;
    }
    return samples.is_period_wrong(samples.by_sender, steps, elapsed_us)
               ? ReceiverFault::sync_period
               : ReceiverFault::none;
}

}  // namespace axg
