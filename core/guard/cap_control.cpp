// SPDX-License-Identifier: Apache-2.0
#include "core/guard/cap_control.hpp"

#include <algorithm>

namespace axg {
namespace {

constexpr std::uint32_t kRaiseShare = 32;

}  // namespace

std::uint8_t CapControl::raised_cap() const noexcept {
    const std::uint32_t cap = order_.cap;
    return static_cast<std::uint8_t>(
        std::min<std::uint32_t>(kCapRapid, cap + std::max(1U, cap / kRaiseShare)));
}

/// An eighth more than what is in force. Of hold nothing is wished for: the proof of a crawl is
/// enough.
bool CapControl::has_room(std::uint8_t wanted) const noexcept {
    return wanted == kCapRapid || 8U * wanted >= 9U * order_.cap;
}

bool CapControl::asks_raise(std::int64_t sample_us) const noexcept {
    const auto is_over = [sample_us](std::int64_t since_us) {
        return since_us == INT64_MIN || sample_us - since_us >= kCapRaiseUs;
    };
    return promise_ != CapPromise::none && order_.cap < kCapRapid && has_room_ &&
           sample_us - room_since_us_ >= kCapRoomUs && is_over(raised_us_) && is_over(asked_us_);
}

void CapControl::fall(const CapCycle& cycle) noexcept {
    const std::uint8_t before = order_.cap;
    order_.mask = kMaskOfAll;
    std::uint32_t cap = std::min(before, cycle.wanted);
    if (!cycle.is_proven) {  // no wish explains it: a quarter less a cycle
        cap = std::min(cap, before * 3U / 4);
    }
    // From more than a crawl the first step is down to it: hold is for what a crawl cannot.
    const std::uint32_t least = before > kCapCrawl ? kCapCrawl : kCapHold;
    order_.cap = static_cast<std::uint8_t>(std::max(cap, least));
    if (order_.cap == kCapHold) {
        held_since_us_ = cycle.sample_us;
    }
}

void CapControl::rise(const CapCycle& cycle) noexcept {
    order_.cap = raised_cap();
    raised_us_ = cycle.sample_us;
    if (order_.cap == kCapRapid) {
        order_.mask = 0;
    }
}

CapOrder CapControl::update(const CapCycle& cycle) noexcept {
    if (promise_ == CapPromise::none) {
        return order_;
    }
    const std::uint32_t cap = order_.cap;
    const bool is_wish_lower = 16U * cycle.wanted < 15U * cap;
    // What is wished for looks ahead, and with fewer boxes than the proof: alone it ends no crawl.
    const bool is_crawling = cap == kCapCrawl && (cycle.wanted >= kCapCrawl || cycle.is_proven);
    if ((is_wish_lower || !cycle.is_proven) && cap != kCapHold && !is_crawling) {
        has_room_ = false;
        fall(cycle);
        return order_;
    }
    asked_us_ = cycle.is_raise_asked ? cycle.sample_us : asked_us_;
    const bool had_room = has_room_;
    has_room_ = cycle.is_proven && has_room(cycle.wanted);
    if (!had_room) {
        room_since_us_ = cycle.sample_us;
    }
    const bool is_due = has_room_ && cap < kCapRapid &&
                        cycle.sample_us - room_since_us_ >= kCapRoomUs &&
                        (raised_us_ == INT64_MIN || cycle.sample_us - raised_us_ >= kCapRaiseUs);
    if (is_due && cycle.is_raise_proven) {
        rise(cycle);
    }
    return order_;
}

}  // namespace axg
