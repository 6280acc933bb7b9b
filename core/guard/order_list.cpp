// SPDX-License-Identifier: Apache-2.0
#include "core/guard/order_list.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kMaskBits = 8;
constexpr std::array<std::uint8_t, 4> kIdleCaps{32, 8, 3, kCapCrawl};
constexpr std::array<double, 3> kShares{1.5, 1.05, 0.5};  // of the speed of the fastest bound axis
constexpr std::array<double, 10> kSharesOfAll{4, 2, 1.5, 1.25, 1.05, 0.85, 0.65, 0.45, 0.25, 0.12};

struct BitUse {
    std::uint8_t bit = 0;  // of the mask
    double use = 0;        // of the fastest of its axes
};

/// Sorts; equal elements stay in order. std::stable_sort would allocate.
template <class T, class Less>
void put_in_order(std::span<T> of, Less less) noexcept {
    for (auto next = of.begin(); next != of.end(); ++next) {
        std::rotate(std::upper_bound(of.begin(), next, *next, less), next, next + 1);
    }
}

class Lister {
  public:
    Lister(std::span<const double> uses, const CapOrder& order) noexcept : order_(order) {
        AXG_ASSERT(!uses.empty() && uses.size() <= kAxesMax);
        for (std::uint32_t i = 0; i < uses.size(); ++i) {
            BitUse& of = bits_[std::min(i, kMaskBits - 1)];
            of.bit = static_cast<std::uint8_t>(1U << std::min(i, kMaskBits - 1));
            of.use = std::max(of.use, uses[i]);
        }
        count_ = std::min(static_cast<std::uint32_t>(uses.size()), kMaskBits);
        put_in_order(std::span(bits_).first(count_),
                     [](const BitUse& a, const BitUse& b) { return a.use < b.use; });
        for (const BitUse& of : slowest(count_)) {
            if (of.use >= kIdleUse) {
                slowed_ = static_cast<std::uint8_t>(slowed_ | (of.bit & order.mask));
            }
        }
    }

    [[nodiscard]] OrderList list(bool is_per_axis) noexcept {
        add(order_);
        if (is_per_axis) {
            add_of_axes();
        } else {
            const double fastest = std::max(bits_[count_ - 1].use, double{kCapCrawl});
            for (const double share : kSharesOfAll) {
                add({.cap = cap_of(share * fastest), .mask = kMaskOfAll});
            }
        }
        add({.cap = kCapCrawl, .mask = kMaskOfAll});
        out_.is_slowed = slowed_ != 0;
        put_in_order(std::span(out_.of).first(out_.count), costs_less);
        return out_;
    }

  private:
    void add_of_axes() noexcept {
        std::uint32_t idle = 0;
        std::uint8_t mask = 0;
        for (; idle < count_ && bits_[idle].use < kIdleUse; ++idle) {
            mask = static_cast<std::uint8_t>(mask | bits_[idle].bit);
        }
        for (const std::uint8_t cap : kIdleCaps) {
            add({.cap = cap, .mask = mask});
        }
        for (std::uint32_t i = idle; i < count_; ++i) {
            mask = static_cast<std::uint8_t>(mask | bits_[i].bit);
            for (const double share : kShares) {
                add({.cap = cap_of(share * bits_[i].use), .mask = mask});
            }
        }
    }

    static std::uint8_t cap_of(double use) noexcept {
        return static_cast<std::uint8_t>(std::min<double>(std::ceil(use), kCapRapid));
    }

    [[nodiscard]] std::span<const BitUse> slowest(std::uint32_t count) const noexcept {
        return {bits_.data(), count};
    }

    /// Orders that slow no axis now come first: those with the highest caps before the others, so
    /// that later caps only fall, and last those that prevent the whole motion from speeding up.
    static bool costs_less(const OrderTried& a, const OrderTried& b) noexcept {
        if (a.room < 1 || b.room < 1) {
            return a.room > b.room;
        }
        return a.binds_fastest != b.binds_fastest ? b.binds_fastest : a.order.cap > b.order.cap;
    }

    void add(const CapOrder& order) noexcept {
        const auto* const end = out_.of.begin() + out_.count;
        const bool is_listed =
            std::any_of(out_.of.cbegin(), end, [&order](const OrderTried& tried) {
                return tried.order.cap == order.cap && tried.order.mask == order.mask;
            });
        if (order.cap == kCapHold || order.cap >= kCapRapid || order.mask == 0 || is_listed ||
            out_.count == out_.of.size()) {
            return;
        }
        double fastest = kIdleUse;
        for (const BitUse& of : slowest(count_)) {
            fastest = (of.bit & order.mask) != 0 ? std::max(fastest, of.use) : fastest;
        }
        const double room = order.cap / fastest;
        const bool is_raise =
            slowed_ != 0 && ((slowed_ & ~order.mask) != 0 || order.cap > order_.cap);
        out_.of[out_.count++] = {.order = order,
                                 .binds_fastest = (bits_[count_ - 1].bit & order.mask) != 0,
                                 .room = room,
                                 .growth = is_raise ? std::max(1.0, room) : 1};
    }

    CapOrder order_;
    std::array<BitUse, kMaskBits> bits_{};
    std::uint32_t count_ = 0;
    std::uint8_t slowed_ = 0;
    OrderList out_;
};

}  // namespace

OrderList list_orders(std::span<const double> uses, const CapOrder& order,
                      bool is_per_axis) noexcept {
    return Lister(uses, order).list(is_per_axis);
}

}  // namespace axg
