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
            CanFrame answer;
            if (board_.take_answer(delivery.frame.time_us, answer)) {
                bus_.post(BusNode::board, answer);
            }
        }
        if (guard_.on_echo) {
            guard_.on_echo(delivery.sent, sent_);
        }
    }
    post_sent();
}

void ClosedLoop::post_of_board(std::span<const CanFrame> frames) {
    for (const CanFrame& frame : frames) {
        bus_.post(BusNode::board, frame);
    }
}

/// Delivers the next frame that ends by `end_us`, after the timers due before it. False: none.
bool ClosedLoop::next_event(std::int64_t end_us, CanBus::Delivery& delivery) {
    while (true) {
        const std::int64_t due_us = guard_.next_due_us ? guard_.next_due_us() : INT64_MAX;
        if (bus_.next(std::min(due_us, end_us), delivery)) {
            deliver(delivery);
            return true;
        }
        if (due_us >= end_us) {
            return false;
        }
        guard_.on_time(due_us, sent_);
        post_sent();
    }
}

bool ClosedLoop::cycle_on_sync() {
    const std::int64_t end_us = board_.next_latch_us() + period_us_ / 2;
    CanBus::Delivery delivery;
    while (next_event(end_us, delivery)) {
        const bool is_sync = delivery.sender == BusNode::guard && !delivery.is_lost &&
                             delivery.frame.id == guard_sync_id_;
        if (is_sync) {
            const std::span<const CanFrame> latched =
                board_.latch_on_sync(delivery.frame.data[0], delivery.frame.time_us);
            post_of_board(latched);
            return !latched.empty();
        }
    }
    board_.pass_without_sync();
    return true;
}

bool ClosedLoop::cycle() {
    if (guard_sync_id_ != 0) {
        return cycle_on_sync();
    }
    const std::span<const CanFrame> latched = board_.latch();
    post_of_board(latched);
    if (latched.empty()) {
        return false;
    }
    const std::int64_t end_us = board_.next_latch_us();
    CanBus::Delivery delivery;
    while (next_event(end_us, delivery)) {
    }
    if (guard_.on_time) {
        guard_.on_time(end_us, sent_);
        post_sent();
    }
    return true;
}

}  // namespace axg
