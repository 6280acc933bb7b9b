// SPDX-License-Identifier: Apache-2.0
#include "core/guard/cap_control.hpp"

#include <algorithm>
#include <cmath>

#include "core/guard/order_list.hpp"

namespace axg {
namespace {

constexpr CapOrder kCrawlOfAll{.cap = kCapCrawl, .mask = kMaskOfAll};
constexpr std::uint32_t kUnproven = 4;  // cycles: every longer validity was tried

bool are_same(const CapOrder& a, const CapOrder& b) noexcept {
    return a.cap == b.cap && a.mask == b.mask;
}

}  // namespace

bool is_within(const CapOrder& order, const AxisCaps& caps) noexcept {
    return higher_caps(caps_of_permit(order.cap, order.mask), caps) == caps;
}

CapOrder lower_order(const CapOrder& a, const CapOrder& b) noexcept {
    return {.cap = std::min(a.cap, b.cap), .mask = static_cast<std::uint8_t>(a.mask | b.mask)};
}

bool CapControl::asks(std::int64_t sample_us) const noexcept {
    return has_asked_ &&
           (is_urgent_ || asked_us_ == INT64_MIN || sample_us - asked_us_ >= kCapRaiseUs);
}

void CapControl::ask(const CapOrder& order, bool is_urgent) noexcept {
    asked_ = order;
    has_asked_ = true;
    is_urgent_ = is_urgent;
}

/// The search proved no order: orders a crawl of all axes, and a hold if the proof of the crawl
/// fails too.
void CapControl::crawl(const CapCycle& cycle) noexcept {
    if (!are_same(order_, kCrawlOfAll)) {
        order_ = kCrawlOfAll;
    } else if (unproven_ > kUnproven) {
        order_.cap = kCapHold;
        held_since_us_ = cycle.sample_us;
    }
}

void CapControl::fall(const CapCycle& cycle) noexcept {
    has_room_ = has_asked_ = is_urgent_ = false;
    if (!cycle.wish.is_any_proven) {
        crawl(cycle);
        return;
    }
    const CapOrder& wish = cycle.wish.best;
    const bool binds_more = (wish.mask & ~order_.mask) != 0;
    if (cycle.is_slowing && !binds_more && 2 * wish.cap > order_.cap) {
        return;  // each further order restarts the wait for its acknowledgement
    }
    if (is_within(wish, cycle.proven)) {
        order_ = wish;
    } else if (!cycle.is_asked) {  // some axis gets a higher cap
        ask(wish, true);
    } else {
        order_ = lower_order(order_, wish);
    }
}

CapOrder CapControl::update(const CapCycle& cycle) noexcept {
    asked_us_ = cycle.is_asked ? cycle.sample_us : asked_us_;
    unproven_ = cycle.is_proven ? 0 : unproven_ + 1;
    const bool is_wanted = !cycle.wish.is_kept_fine || has_room_ || order_.cap == kCapHold;
    if (cycle.is_asked && is_wanted && is_within(asked_, cycle.proven)) {
        order_ = asked_;
        has_asked_ = is_urgent_ = false;
        return order_;
    }
    if (order_.cap == kCapHold) {
        ask(kCrawlOfAll, false);
        return order_;
    }
    unkept_ = cycle.wish.is_kept_fine ? 0 : unkept_ + 1;
    if (unkept_ >= kCapPatience) {
        fall(cycle);
        return order_;
    }
    if (unkept_ != 0) {
        has_room_ = has_asked_ = is_urgent_ = false;
        return order_;
    }
    const bool had_room = has_room_, had_asked = has_asked_;
    has_room_ = !are_same(cycle.wish.best, order_);
    room_since_us_ = had_room ? room_since_us_ : cycle.sample_us;
    has_asked_ = has_room_ && cycle.sample_us - room_since_us_ >= kCapRoomUs;
    if (has_asked_) {
        ask(next_raise(cycle, had_asked), false);
    }
    return order_;
}

/// The wished order; once it has failed, lower ones, down to the order in force, and then the
/// wished one again: close to a body rapid is not proven, but a little more is, and each step away
/// from it more.
CapOrder CapControl::next_raise(const CapCycle& cycle, bool had_asked) const noexcept {
    const CapOrder& best = cycle.wish.best;
    const AxisCaps wished = caps_of_permit(best.cap, best.mask);
    if (!cycle.is_asked) {  // `asked_` still waits for its turn
        return had_asked && asked_.cap > order_.cap && is_within(asked_, wished) ? asked_ : best;
    }
    const auto middle =
        static_cast<std::uint8_t>(std::sqrt(static_cast<double>(order_.cap) * asked_.cap));
    const CapOrder lower{.cap = std::min(best.cap, middle),
                         .mask = static_cast<std::uint8_t>(order_.mask | best.mask)};
    return lower.cap > order_.cap ? lower : best;
}

}  // namespace axg
