// SPDX-License-Identifier: Apache-2.0
// From frames of other makers to one snapshot (format signals). Rules: docs/reference/protocol.md.
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

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
    if (is_period_wrong(sync_period_, number.steps, set_first_us_)) {
        return fault(ReceiverFault::sync_period, frame_id);
    }
    const std::uint32_t steps = has_last_ ? arrival_steps_ : 1U;
    const ReceiverEvent event = deliver({true, set_first_us_, 0, set_first_us_}, steps, frame_id);
    arrival_steps_ = event.kind == ReceiverEvent::Kind::snapshot ? 0 : arrival_steps_;
    return event;
}

}  // namespace axg
