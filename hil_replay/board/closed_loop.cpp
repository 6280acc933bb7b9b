// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/closed_loop.hpp"

#include <algorithm>
#include <span>

namespace axg {

void ClosedLoop::post_sent() {
    for (const CanFrame& frame : sent_) {
        bus_.post(BusNode::guard, frame);
    }
    sent_.clear();
}

void ClosedLoop::deliver(const CanBus::Delivery& delivery) {
    if (delivery.sender == BusNode::board) {
        guard_.on_frame(delivery.frame, sent_);
    } else {
        if (!delivery.is_lost) {
            board_.on_frame(delivery.frame);
        }
        if (guard_.on_echo) {
            guard_.on_echo(delivery.sent, sent_);
        }
    }
    post_sent();
}

bool ClosedLoop::cycle() {
    const std::span<const CanFrame> latched = board_.latch();
    for (const CanFrame& frame : latched) {
        bus_.post(BusNode::board, frame);
    }
    if (latched.empty()) {
        return false;
    }
    const std::int64_t end_us = board_.next_latch_us();
    CanBus::Delivery delivery;
    for (bool goes_on = true; goes_on;) {
        const std::int64_t due_us = guard_.next_due_us ? guard_.next_due_us() : INT64_MAX;
        if (bus_.next(std::min(due_us, end_us), delivery)) {
            deliver(delivery);
        } else if (due_us < end_us) {
            guard_.on_time(due_us, sent_);
            post_sent();
        } else {
            goes_on = false;
        }
    }
    if (guard_.on_time) {
        guard_.on_time(end_us, sent_);
        post_sent();
    }
    return true;
}

}  // namespace axg
