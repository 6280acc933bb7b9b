// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/closed_loop.hpp"

namespace axg {

void ClosedLoop::post_sent() {
    for (const CanFrame& frame : sent_) {
        bus_.post(BusNode::guard, frame);
    }
    sent_.clear();
}

bool ClosedLoop::cycle() {
    if (!board_.latch(bus_)) {
        return false;
    }
    CanBus::Delivery delivery;
    while (bus_.next(board_.next_latch_us(), delivery)) {
        if (delivery.sender == BusNode::guard) {
            board_.on_frame(delivery.frame);
        } else {
            guard_.on_frame(delivery.frame, sent_);
            post_sent();
        }
    }
    if (guard_.on_time) {
        guard_.on_time(board_.next_latch_us(), sent_);
        post_sent();
    }
    return true;
}

}  // namespace axg
