// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/outbox.hpp"

#include <algorithm>

namespace axg {
namespace {

bool is_same(const CanFrame& a, const CanFrame& b) noexcept {
    return a.id == b.id && a.length_bytes == b.length_bytes && a.fd == b.fd &&
           std::equal(a.data.begin(), a.data.begin() + a.length_bytes, b.data.begin());
}

}  // namespace

void Outbox::put(Rank rank, const CanFrame& frame) noexcept {
    Slot& slot = slots_[rank];
    slot.refused_us = slot.is_waiting ? slot.refused_us : 0;  // a newer frame gets no longer limit
    slot.frame = frame;
    slot.is_waiting = true;
}

void Outbox::put_stop(const CanFrame& frame) noexcept {
    if (!is_stop_word_) {
        withdraw_permit();
    }
    put(kStop, frame);
    retry_us_ = 0;  // the queue may have been full for a permit
    slots_[kQuickStop].is_waiting = false;
    quick_next_ = quick_end_ = 0;
}

void Outbox::put_quick_stop(const CanFrame& frame) noexcept {
    if (quick_end_ < quick_stops_.size()) {
        quick_stops_[quick_end_++] = frame;
        put(kQuickStop, quick_stops_[quick_next_]);
    }
}

void Outbox::put_permit(const std::array<CanFrame, 2>& pair) noexcept {
    if (!owes_twin_) {
        put(kPlain, pair[0]);
        put(kTwin, pair[1]);
        is_stop_word_ = false;
    }
}

void Outbox::put_stop_word(const std::array<CanFrame, 2>& pair) noexcept {
    withdraw_permit();
    put_permit(pair);
    is_stop_word_ = true;
}

void Outbox::withdraw_permit() noexcept {
    slots_[kPlain].is_waiting = slots_[kTwin].is_waiting = false;
    owes_twin_ = false;
}

void Outbox::on_echo(const CanFrame& frame) noexcept {
    for (Flight* const flight : {&urgent_, &background_}) {
        if (flight->is_on && is_same(frame, flight->frame)) {
            flight->is_on = false;
            was_heard_ = true;
            return;
        }
    }
}

/// kRanks: no frame is waiting, or those that wait have to wait on.
Outbox::Rank Outbox::next() const noexcept {
    const bool has_stop = slots_[kStop].is_waiting;
    const bool is_in_flight =
        has_stop && urgent_.is_on && is_same(urgent_.frame, slots_[kStop].frame);
    if (has_stop && !is_in_flight) {
        return kStop;
    }
    if (slots_[kQuickStop].is_waiting) {
        return kQuickStop;
    }
    for (const Rank rank : {kPlain, kTwin}) {
        if (is_of_stop(rank) && slots_[rank].is_waiting) {
            return rank;
        }
    }
    if (has_stop || urgent_.is_on) {
        return kRanks;
    }
    if (owes_twin_) {
        return kTwin;
    }
    if (slots_[kPlain].is_waiting) {
        return kPlain;
    }
    for (std::uint8_t rank = kEmergency; rank < kRanks && !background_.is_on; ++rank) {
        if (slots_[rank].is_waiting) {
            return static_cast<Rank>(rank);
        }
    }
    return kRanks;
}

bool Outbox::is_of_stop(Rank rank) const noexcept {
    return rank == kStop || rank == kQuickStop ||
           (is_stop_word_ && (rank == kPlain || rank == kTwin));
}

/// Discards all waiting frames: the callers decide anew what to send when the bus works again.
void Outbox::fail(OutboxResult& result, SendStatus status) noexcept {
    for (Slot& slot : slots_) {
        slot.is_waiting = false;
    }
    urgent_.is_on = background_.is_on = owes_twin_ = false;
    result.has_failed = true;
    result.status = status;
}

/// False: the wire accepts no more frames now.
bool Outbox::send_one(Rank rank, std::int64_t now_us, OutboxResult& result) noexcept {
    Slot& slot = slots_[rank];
    const SendStatus status = wire_.send(slot.frame);
    if (status == SendStatus::busy) {
        slot.refused_us = slot.refused_us == 0 ? now_us : slot.refused_us;
        retry_us_ = now_us + kSendRetryUs;
        if (now_us - slot.refused_us > limit_us_) {
            fail(result, status);
        }
        return false;
    }
    if (status != SendStatus::ok) {
        fail(result, status);
        return false;
    }
    slot.is_waiting = false;
    slot.refused_us = 0;
    if (rank == kQuickStop && ++quick_next_ < quick_end_) {
        put(kQuickStop, quick_stops_[quick_next_]);
    }
    if (rank == kPlain || rank == kTwin) {  // a stop may go between the stop word and its twin
        owes_twin_ = rank == kPlain;
    }
    if (rank == kStop || !is_of_stop(rank)) {  // the stop's echo covers the others
        (rank < kEmergency ? urgent_ : background_) = {slot.frame, now_us, true};
    }
    return true;
}

void Outbox::send_stop(std::int64_t now_us) noexcept {
    Rank rank = next();
    while (is_of_stop(rank) && now_us >= retry_us_ && send_one(rank, now_us, untold_)) {
        rank = next();
    }
}

OutboxResult Outbox::work(std::int64_t now_us) noexcept {
    OutboxResult result = untold_;
    untold_ = {};
    result.was_heard = was_heard_;
    was_heard_ = false;
    if (is_missing(urgent_, now_us) || is_missing(background_, now_us)) {
        const bool has_stop = slots_[kStop].is_waiting;
        const bool has_quick_stop = slots_[kQuickStop].is_waiting;
        fail(result, SendStatus::ok);
        // These had not been tried: the bus may work again.
        slots_[kStop].is_waiting = has_stop;
        slots_[kQuickStop].is_waiting = has_quick_stop;
    }
    Rank rank = next();
    while (rank != kRanks && now_us >= retry_us_ && send_one(rank, now_us, result)) {
        rank = next();
    }
    return result;
}

std::int64_t Outbox::next_due_us() const noexcept {
    std::int64_t due_us = INT64_MAX;
    for (const Flight& flight : {urgent_, background_}) {
        due_us = flight.is_on ? std::min(due_us, flight.sent_us + limit_us_ + 1) : due_us;
    }
    if (next() != kRanks) {
        due_us = std::min(due_us, retry_us_);
    }
    return due_us;
}

}  // namespace axg
