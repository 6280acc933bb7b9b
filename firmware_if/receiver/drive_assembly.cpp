// SPDX-License-Identifier: Apache-2.0
// From the process data of drives to one snapshot (format cia402). Drives latch their positions as
// SYNC ends and number nothing: only time shows which frames belong together. After any event that
// may have mixed two instants, a whole group is discarded. Rules: docs/reference/protocol.md.
#include <algorithm>
#include <cstdlib>

#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kStepsMax = 1'000'000;

}  // namespace

ReceiverEvent AxisReceiver::on_drive_sync(const CanFrame& frame) noexcept {
    const std::uint8_t counter_max = set_.sync_counter_max;
    const std::uint8_t counter = counter_max != 0 ? frame.data[0] : 0;
    ReceiverFault wrong = ReceiverFault::none;
    if (frame.fd || frame.raw_dlc != 0) {
        wrong = frame.fd ? ReceiverFault::bad_format : ReceiverFault::raw_dlc;
    } else if (frame.length_bytes != (counter_max != 0 ? 1 : 0)) {
        wrong = ReceiverFault::bad_length;
    } else if (counter_max != 0 && (counter < 1 || counter > counter_max)) {
        wrong = ReceiverFault::bad_format;
    } else if (counter_max != 0) {
        const Sequence sequence = sync_sequence_.next(static_cast<std::uint16_t>(counter - 1));
        wrong = sequence == Sequence::repeated ? ReceiverFault::repeated
                : sequence == Sequence::wrong  ? ReceiverFault::wrong_sequence
                                               : ReceiverFault::none;
    }
    const std::int64_t period_us = set_.sample_us;
    const std::int64_t elapsed_us = frame.time_us - drives_.sync_us;
    std::int64_t steps = 1;
    if (drives_.has_sync && counter_max != 0) {
        steps = (counter + counter_max - drives_.sync_counter) % counter_max;
    } else if (drives_.has_sync) {
        steps = std::clamp<std::int64_t>((elapsed_us + period_us / 2) / period_us, 0, kStepsMax);
        wrong =
            wrong == ReceiverFault::none && steps == 0 ? ReceiverFault::sync_early_or_late : wrong;
    }
    const bool is_whole = drives_.is_open && is_complete();
    const bool is_torn = drives_.is_open && !is_whole;
    drives_.is_open = wrong == ReceiverFault::none;
    // Our clock was set back: it measures nothing across that, and this stamp may be the only one.
    const bool is_set_back = drives_.has_sync && elapsed_us < 0;
    if (wrong == ReceiverFault::wrong_sequence || is_set_back) {
        restart(sync_period_);
    }
    if (wrong != ReceiverFault::none) {
        return fault(wrong, frame.id);  // drives may react to it: no data until the next good one
    }
    // Frames missing from the group before, or sent after a SYNC that was lost here, may still
    // arrive and would look like this group's.
    drives_.is_suspect = drives_.has_sync && (!is_whole || steps > 1);
    const bool is_in_time =
        !drives_.has_sync || std::abs(elapsed_us - steps * period_us) <= period_us / 5;
    drives_.steps = static_cast<std::uint32_t>(
        std::min<std::int64_t>(kStepsMax, std::int64_t{drives_.steps} + steps));
    drives_.has_sync = true;
    drives_.sync_us = frame.time_us;
    drives_.sync_counter = counter;
    begin_set(0);
    window_us_ = now_us_;
    window_frames_ = 0;
    if (!is_set_back && is_period_wrong(sync_period_, steps, frame.time_us)) {
        return fault(ReceiverFault::sync_period, frame.id);
    }
    if (is_torn) {
        return fault(ReceiverFault::torn, frame.id);
    }
    return is_in_time ? event() : fault(ReceiverFault::sync_early_or_late, frame.id);
}

ReceiverEvent AxisReceiver::assemble_drives(const AxisFrameContent& content, std::uint32_t slot,
                                            const CanFrame& frame) noexcept {
    if (!drives_.is_open) {
        return fault(ReceiverFault::sync_missing, frame.id);
    }
    if (now_us_ - drives_.sync_us > sync_window_us_) {
        return fault(ReceiverFault::late_sample, frame.id);
    }
    Slot& known = slots_[slot];
    if ((seen_ >> slot & 1U) != 0) {
        if (drives_.is_suspect) {
            return fault(ReceiverFault::late_sample, frame.id);
        }
        const auto* end = frame.data.data() + frame.length_bytes;
        const bool is_same = std::equal(frame.data.data(), end, known.payload.data());
        return fault(is_same ? ReceiverFault::repeated : ReceiverFault::spoofed, frame.id);
    }
    known.payload = frame.data;
    add_to_set(content, slot);
    if (!is_complete()) {
        return event();
    }
    if (drives_.is_suspect) {
        return fault(ReceiverFault::late_sample, frame.id);
    }
    const std::uint32_t steps = std::max(1U, drives_.steps);
    const Latch latch = dated(drives_.sync_us, drives_.sync_counter, steps);
    const ReceiverEvent event = deliver(latch, steps, frame.id);
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        drives_.steps = 0;
    }
    return event;
}

}  // namespace axg
