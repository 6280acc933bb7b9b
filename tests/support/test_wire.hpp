// SPDX-License-Identifier: Apache-2.0
// A wire with faults, by a counter for time, in the place of a socket: what was sent, when, and
// whether its echo comes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "firmware_if/can/can_transport.hpp"

namespace axg::test {

class TestWire final : public CanTransport {
  public:
    std::int64_t now_us = 0;
    std::vector<CanFrame> sent;                    // taken by the kernel; time_us: when
    SendStatus reply = SendStatus::ok;             // to the next frames
    bool is_deaf = false;                          // taken, and never on the wire: no echo
    std::int64_t echo_us = 150;                    // how long a frame takes
    std::uint64_t applied = 0;                     // how often a fault had an effect
    std::function<void(const CanFrame&)> on_send;  // as it is handed over; empty: nothing

    void arrive(const CanFrame& frame) { add({.frame = frame}); }
    void inject(ReadStatus status) { injected_.push_back(status); }

    [[nodiscard]] bool has_arrivals() const {
        return !injected_.empty() || (!queue_.empty() && queue_.front().frame.time_us <= now_us);
    }

    /// When a read will have something; INT64_MAX: as it is, never.
    [[nodiscard]] std::int64_t next_us() const {
        return !injected_.empty() ? now_us
               : queue_.empty()   ? INT64_MAX
                                  : queue_.front().frame.time_us;
    }

    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override {
        if (on_send) {
            on_send(frame);
        }
        if (reply != SendStatus::ok) {
            ++applied;
            return reply;
        }
        sent.push_back(frame);
        sent.back().time_us = now_us;
        if (is_deaf) {
            ++applied;
            return SendStatus::ok;
        }
        CanArrival echo{.frame = frame, .is_own = true};
        echo.frame.time_us = now_us + echo_us;
        echo.frame.sent_by_host = true;
        add(echo);
        return SendStatus::ok;
    }

    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override {
        if (!injected_.empty()) {
            const ReadStatus status = injected_.front();
            injected_.pop_front();
            ++applied;
            return status;
        }
        if (!has_arrivals()) {
            return ReadStatus::none;
        }
        out = queue_.front();
        queue_.pop_front();
        return ReadStatus::frame;
    }

  private:
    void add(const CanArrival& arrival) {
        auto place = queue_.end();
        while (place != queue_.begin() && (place - 1)->frame.time_us > arrival.frame.time_us) {
            --place;
        }
        queue_.insert(place, arrival);
    }

    std::deque<CanArrival> queue_;  // in order of time
    std::deque<ReadStatus> injected_;
};

}  // namespace axg::test
