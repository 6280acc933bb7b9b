// SPDX-License-Identifier: Apache-2.0
// Which caps of single axes are tried, and in which order.
#include "core/guard/order_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace axg {
namespace {

std::span<const OrderTried> tried(const OrderList& list) {
    return {list.of.data(), list.count};
}

bool has(const OrderList& list, std::uint8_t cap, std::uint8_t mask) {
    const auto of = tried(list);
    return std::any_of(of.begin(), of.end(), [&](const OrderTried& one) {
        return one.order.cap == cap && one.order.mask == mask;
    });
}

TEST(OrderList, IdleAxesAreBoundFirstAndTheFastestLast) {
    const OrderList list = list_orders(std::array{0.0, 3.1, 36.5, 4.9}, {}, true);
    ASSERT_GT(list.count, 0U);
    EXPECT_EQ(list.of[0].order.cap, 32);
    EXPECT_EQ(list.of[0].order.mask, 0b0001) << "X stands";
    EXPECT_TRUE(has(list, 5, 0b0011)) << "the slowest that moves, 1.5 times as fast";
    EXPECT_TRUE(has(list, 8, 0b1011));
    EXPECT_TRUE(has(list, 39, 0b1111));
    EXPECT_EQ(list.of[list.count - 1].order.mask, kMaskOfAll);
    EXPECT_EQ(list.of[list.count - 1].order.cap, kCapCrawl);
    bool was_free = true, bound_fastest = false;
    std::uint8_t cap = kCapRapid;
    for (const OrderTried& one : tried(list)) {
        const bool is_free = one.room >= 1;
        EXPECT_TRUE(was_free || !is_free) << "what costs nothing comes first";
        if (is_free && one.binds_fastest == bound_fastest) {
            EXPECT_LE(one.order.cap, cap) << "so that a later one only falls";
        }
        EXPECT_FALSE(is_free && bound_fastest && !one.binds_fastest);
        was_free = is_free;
        bound_fastest = one.binds_fastest;
        cap = one.order.cap;
    }
}

TEST(OrderList, WhatWasOrderedIsTriedAgain) {
    EXPECT_TRUE(has(list_orders(std::array{0.0, 10.0}, {.cap = 77, .mask = 2}, true), 77, 2));
    const OrderList free = list_orders(std::array{0.0, 10.0}, {}, true);
    for (const OrderTried& one : tried(free)) {
        EXPECT_LT(one.order.cap, kCapRapid);
        EXPECT_NE(one.order.mask, 0);
    }
    const OrderList after_hold = list_orders(std::array{0.0, 0.0}, {.cap = 0, .mask = 3}, true);
    for (const OrderTried& one : tried(after_hold)) {
        EXPECT_GT(one.order.cap, kCapHold) << "a hold is no wish";
    }
}

// An axis that a cap slows down speeds up where it is let, and all others with it.
TEST(OrderList, WhoeverIsSlowedDownMayGrow) {
    const CapOrder order{.cap = 4, .mask = 0b10};
    const OrderList slowed = list_orders(std::array{20.0, 3.9}, order, true);
    EXPECT_TRUE(slowed.is_slowed);
    for (const OrderTried& one : tried(slowed)) {
        const bool is_raise = one.order.cap > 4 || (one.order.mask & 0b10) == 0;
        EXPECT_EQ(one.growth > 1, is_raise && one.room > 1)
            << int{one.order.cap} << " of " << int{one.order.mask};
    }
    EXPECT_FALSE(list_orders(std::array{20.0, 0.1}, order, true).is_slowed) << "it does not move";
}

TEST(OrderList, AxesBeyondTheMaskShareItsLastBit) {
    std::array<double, 9> uses{};
    uses.fill(50);
    uses[7] = 0;
    uses[8] = 2;
    EXPECT_TRUE(has(list_orders(uses, {}, true), 3, 0x80)) << "the faster one of the two counts";
}

TEST(OrderList, WhoeverCanOnlyScaleEverythingBindsAllAxesTheHighestCapFirst) {
    const CapOrder order{.cap = 7, .mask = kMaskOfAll};
    for (const double use : {0.0, 0.9, 20.0, 249.0}) {
        const OrderList list = list_orders(std::array{0.0, use}, order, false);
        std::uint8_t cap = kCapRapid;
        for (const OrderTried& one : tried(list)) {
            EXPECT_EQ(one.order.mask, kMaskOfAll);
            EXPECT_LT(one.order.cap, cap);
            cap = one.order.cap;
        }
        EXPECT_EQ(cap, kCapCrawl);
        EXPECT_TRUE(has(list, 7, kMaskOfAll));
    }
}

}  // namespace
}  // namespace axg
