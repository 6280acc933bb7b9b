// SPDX-License-Identifier: Apache-2.0
// Frames of other makers without SYNC (format signals).
#include "firmware_if/receiver/assembler.hpp"

namespace axg {

SignalAssembler::SignalAssembler(const CanLayout& can) noexcept
    : arrivals_{
          .period_us = can.sample_us,
          .jitter_us = can.arrival_jitter_us != 0
                           ? can.arrival_jitter_us
                           : static_cast<std::int64_t>(kArrivalJitterShareMax * can.sample_us)} {}

Assembly SignalAssembler::on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept {
    SampleSet& set = samples.set;
    const bool is_torn =
        set.seen != 0 && (set.has(axis.slot) || samples.now_us - set.first_us > samples.period_us);
    if (set.seen == 0 || is_torn) {
        samples.begin(0);
    }
    set.add(axis.content, axis.slot);
    if (is_torn) {
        return {.fault = ReceiverFault::torn};
    }
    if (!set.is_complete()) {
        return {};
    }
    set.seen = 0;
    const ArrivalNumber number = number_arrival(arrivals_, set.first_us);
    samples.steps += number.steps;  // a sample that is not handed out counts for the next one
    if (!number.is_in_time) {
        return {.fault = ReceiverFault::arrival_jitter};
    }
    if (samples.is_period_wrong(samples.by_sync, number.steps, set.first_us)) {
        return {.fault = ReceiverFault::sync_period};
    }
    return {.steps = samples.last.is_known ? samples.steps : 1U,
            .latch = Latch{set.first_us, 0, set.first_us}};
}

}  // namespace axg
