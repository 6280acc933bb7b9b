// SPDX-License-Identifier: Apache-2.0
// Process data of drives (format cia402), and SYNC of all formats that have one.
#include <algorithm>
#include <cstdlib>

#include "firmware_if/receiver/assembler.hpp"

namespace axg {
namespace {

constexpr std::int64_t kStepsMax = 1'000'000;

ReceiverFault fault_of_sync(SyncWatch& sync, const CanFrame& frame) noexcept {
    const ReceiverFault shape = shape_of(frame, sync.counter_max != 0 ? 1 : 0);
    if (shape != ReceiverFault::none || sync.counter_max == 0) {
        return shape;
    }
    const std::uint8_t counter = frame.data[0];
    if (counter < 1 || counter > sync.counter_max) {
        return ReceiverFault::bad_format;
    }
    const Sequence sequence = sync.sequence.next(static_cast<std::uint16_t>(counter - 1));
    return sequence == Sequence::repeated ? ReceiverFault::repeated
           : sequence == Sequence::wrong  ? ReceiverFault::wrong_sequence
                                          : ReceiverFault::none;
}

}  // namespace

SyncWatch::Step SyncWatch::judge(const CanFrame& frame, std::int64_t period_us) noexcept {
    Step step{.fault = fault_of_sync(*this, frame)};
    if (!is_known) {
        return step;
    }
    const std::int64_t elapsed_us = frame.time_us - time_us;
    if (counter_max != 0) {
        step.periods = (frame.data[0] + counter_max - counter) % counter_max;
    } else {
        step.periods =
            std::clamp<std::int64_t>((elapsed_us + period_us / 2) / period_us, 0, kStepsMax);
        if (step.fault == ReceiverFault::none && step.periods == 0) {
            step.fault = ReceiverFault::sync_early_or_late;
        }
    }
    step.is_in_time = std::abs(elapsed_us - step.periods * period_us) <= period_us / 5;
    step.is_set_back = elapsed_us < 0;
    return step;
}

Assembly SyncWatch::take(const CanFrame& frame, const Step& step, bool is_torn,
                         ReceivedSamples& samples) noexcept {
    is_known = true;
    counter = counter_max != 0 ? frame.data[0] : 0;
    time_us = frame.time_us;
    const bool is_wrong =
        !step.is_set_back && samples.is_period_wrong(samples.by_sync, step.periods, frame.time_us);
    return {.fault = is_wrong           ? ReceiverFault::sync_period
                     : is_torn          ? ReceiverFault::torn
                     : !step.is_in_time ? ReceiverFault::sync_early_or_late
                                        : ReceiverFault::none,
            .begins_period = true};
}

DriveAssembler::DriveAssembler(const CanLayout& can, const AxisFrameSet& set) noexcept
    : window_us_(can.sync_window_us != 0 ? can.sync_window_us : can.sample_us),
      sync_{.counter_max = set.sync_counter_max,
            .sequence = sequence_of(can, set.sync_counter_max)} {}

void DriveAssembler::forget() noexcept {
    sync_.forget();
    is_open_ = is_suspect_ = false;
}

Assembly DriveAssembler::on_sync(const CanFrame& frame, ReceivedSamples& samples) noexcept {
    const SyncWatch::Step step = sync_.judge(frame, samples.period_us);
    const bool is_whole = is_open_ && samples.set.is_complete();
    const bool is_torn = is_open_ && !is_whole;
    is_open_ = step.fault == ReceiverFault::none;
    if (step.fault == ReceiverFault::wrong_sequence || step.is_set_back) {
        restart(samples.by_sync.watch);
    }
    if (!is_open_) {
        return {.fault = step.fault};  // drives may react to it: no data until the next good one
    }
    // Frames missing from the group before, or sent after a SYNC that was lost here, may still
    // arrive and would look like this group's.
    is_suspect_ = sync_.is_known && (!is_whole || step.periods > 1);
    samples.steps = static_cast<std::uint32_t>(std::min(kStepsMax, samples.steps + step.periods));
    samples.begin(0);
    return sync_.take(frame, step, is_torn, samples);
}

Assembly DriveAssembler::on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept {
    if (!is_open_) {
        return {.fault = ReceiverFault::sync_missing};
    }
    if (samples.now_us - sync_.time_us > window_us_) {
        return {.fault = ReceiverFault::late_sample};
    }
    SampleSet& set = samples.set;
    if (set.has(axis.slot)) {
        return {.fault =
                    is_suspect_ ? ReceiverFault::late_sample : axis.last.repeat_of(axis.frame)};
    }
    axis.last.payload = axis.frame.data;
    set.add(axis.content, axis.slot);
    if (!set.is_complete()) {
        return {};
    }
    if (is_suspect_) {
        return {.fault = ReceiverFault::late_sample};
    }
    const std::uint32_t steps = std::max(1U, samples.steps);
    return {.steps = steps, .latch = samples.dated(sync_.time_us, sync_.counter, steps)};
}

}  // namespace axg
