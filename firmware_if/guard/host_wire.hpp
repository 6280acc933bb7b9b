// SPDX-License-Identifier: Apache-2.0
// The wire of a guard whose host program drives the bus: queues frames in both directions.
#pragma once

#include "firmware_if/can/can_transport.hpp"
#include "firmware_if/guard/spsc_queue.hpp"

namespace axg {

class HostWire final : public CanTransport {
  public:
    /// False: full. The guard is notified and stops.
    [[nodiscard]] bool arrive(const CanArrival& arrival) noexcept {
        const bool is_taken = arrivals_.push(arrival);
        has_overflown_ = has_overflown_ || !is_taken;
        return is_taken;
    }
    void go_down() noexcept { is_down_ = true; }
    [[nodiscard]] bool take(CanFrame& out) noexcept { return departures_.pop(out); }

    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override {
        return departures_.push(frame) ? SendStatus::ok : SendStatus::busy;
    }
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override {
        if (is_down_) {
            is_down_ = false;
            return ReadStatus::down;
        }
        if (has_overflown_) {
            has_overflown_ = false;
            return ReadStatus::failed;
        }
        return arrivals_.pop(out) ? ReadStatus::frame : ReadStatus::none;
    }

  private:
    SpscQueue<CanArrival, 256> arrivals_;
    SpscQueue<CanFrame, 32> departures_;  // a stop, and a quick stop for each of 16 drives
    bool has_overflown_ = false, is_down_ = false;
};

}  // namespace axg
