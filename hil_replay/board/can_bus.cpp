// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/can_bus.hpp"

#include <algorithm>

#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

CanBus::CanBus(const BusOptions& options) : options_(options), random_(options.seed) {
    waiting_.reserve(64);
    frames_.reserve(64);
    free_slots_.reserve(64);
}

bool CanBus::chance(double share) {
    // Equal on every library, unlike std::bernoulli_distribution.
    return share > 0 && static_cast<double>(random_() >> 11U) * 0x1p-53 < share;
}

CanBus::Fate CanBus::spoil(BusNode sender, CanFrame& frame) {
    const BusFaults& faults = options_.faults;
    if (frame.time_us >= faults.silent_from_us) {
        return Fate::unsent;
    }
    const bool is_lost = chance(faults.lost);
    if (sender == BusNode::board) {
        return is_lost ? Fate::lost : Fate::sent;
    }
    const bool is_permit = frame.id == options_.permit_id || frame.id == options_.permit_id + 1;
    const bool is_stuck =
        frame.time_us >= faults.stuck_from_us && frame.id != options_.heartbeat_id;
    if (frame.time_us >= faults.killed_from_us || is_stuck) {
        return Fate::unsent;
    }
    if (is_lost || (is_permit && chance(faults.permit_lost))) {
        return Fate::lost;
    }
    if (frame.time_us >= faults.late_from_us || chance(faults.late)) {
        frame.time_us += options_.period_us;
    }
    if (frame.id == options_.permit_id && frame.length_bytes > 0 && chance(faults.corrupted)) {
        const std::uint64_t bits = 8U * frame.length_bytes, first = random_();
        for (std::uint64_t n = 1 + random_() % 3; n > 0; --n) {  // three that differ
            const std::uint64_t bit = (first + n * (bits / 3)) % bits;
            frame.data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        }
    }
    return Fate::sent;
}

void CanBus::post(BusNode sender, const CanFrame& frame) {
    Delivery delivery{.sender = sender, .frame = frame, .sent = frame};
    const Fate fate = spoil(sender, delivery.frame);
    lost_ += fate == Fate::sent ? 0 : 1;
    delivery.is_lost = fate == Fate::lost;
    if (fate == Fate::unsent || (delivery.is_lost && sender == BusNode::board)) {
        return;  // no node receives it
    }
    if (free_slots_.empty()) {
        free_slots_.push_back(static_cast<std::uint32_t>(frames_.size()));
        frames_.emplace_back();
    }
    const std::uint32_t slot = free_slots_.back();
    free_slots_.pop_back();
    frames_[slot] = delivery;
    waiting_.push_back({delivery.frame.time_us, frame.id, slot, sender});
}

bool CanBus::next(std::int64_t until_us, Delivery& out) {
    if (waiting_.empty()) {
        return false;
    }
    std::int64_t start_us = INT64_MAX;
    for (const Waiting& frame : waiting_) {
        start_us = std::min(start_us, frame.ready_us);
    }
    start_us = std::max(start_us, free_us_);
    std::size_t first = waiting_.size();
    for (std::size_t i = 0; i < waiting_.size(); ++i) {  // equal ids in the order of posting
        if (waiting_[i].ready_us <= start_us &&
            (first == waiting_.size() || waiting_[i].id < waiting_[first].id)) {
            first = i;
        }
    }
    const Waiting chosen = waiting_[first];
    const std::int64_t length_us = bus_time_us(frames_[chosen.slot].frame, options_.bit_rate);
    if (start_us + length_us > until_us) {
        return false;
    }
    free_us_ = start_us + length_us;
    busy_us_ += static_cast<std::uint64_t>(length_us);
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(first));
    free_slots_.push_back(chosen.slot);
    out = frames_[chosen.slot];
    out.frame.time_us = out.sent.time_us = free_us_;
    return true;
}

}  // namespace axg
