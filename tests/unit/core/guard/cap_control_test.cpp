// SPDX-License-Identifier: Apache-2.0
// Caps of single axes: down after kCapPatience cycles, up and across only by what is proven.
#include "core/guard/cap_control.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/seed.hpp"

namespace axg {
namespace {

CapWish wish_of(CapOrder best, bool is_kept_fine = false) {
    return {.best = best, .is_kept_fine = is_kept_fine};
}

struct ControlBench {
    /// A cycle in which what was asked is proven, or not.
    CapOrder step(const CapWish& wish, bool is_asked_proven = true, bool is_proven = true,
                  bool is_slowing = false) {
        const CapOrder before = control.order();
        CapCycle cycle{.sample_us = now_us, .wish = wish};
        cycle.is_asked = control.asks(now_us);
        asked += cycle.is_asked ? 1 : 0;
        cycle.is_proven = is_proven;
        cycle.is_slowing = is_slowing;
        cycle.proven = caps_of_permit(before.cap, before.mask);
        if (cycle.is_asked && is_asked_proven) {
            const CapOrder& order = control.asked();
            cycle.proven = higher_caps(cycle.proven, caps_of_permit(order.cap, order.mask));
        }
        now_us += 1000;
        const CapOrder order = control.update(cycle);
        EXPECT_TRUE(is_within(order, cycle.proven)) << "ordered and not proven";
        return order;
    }
    CapOrder steps(int count, const CapWish& wish, bool is_asked_proven = true) {
        for (int i = 1; i < count; ++i) {
            step(wish, is_asked_proven);
        }
        return step(wish, is_asked_proven);
    }

    /// As many cycles as a fall needs.
    CapOrder fall(const CapWish& wish, bool is_slowing = false) {
        for (std::uint32_t i = 1; i < kCapPatience; ++i) {
            step(wish, true, true, is_slowing);
        }
        return step(wish, true, true, is_slowing);
    }

    CapControl control;
    std::int64_t now_us = 0;
    int asked = 0;
};

void expect_order(const CapOrder& order, int cap, int mask) {
    EXPECT_EQ(order.cap, cap);
    EXPECT_EQ(order.mask, mask);
}

TEST(CapControl, FallsToWhatBindsMore) {
    ControlBench bench;
    expect_order(bench.step(wish_of({}, true)), kCapRapid, 0);
    expect_order(bench.fall(wish_of({.cap = 32, .mask = 1})), 32, 1);
    expect_order(bench.step(wish_of({.cap = 8, .mask = 3})), 8, 3);  // it fails since long
    EXPECT_EQ(bench.asked, 0);
}

// A search that fails now and then is noise.
TEST(CapControl, FallsOnlyAfterCyclesInARow) {
    ControlBench bench;
    for (int i = 0; i < 10; ++i) {
        for (std::uint32_t k = 1; k < kCapPatience; ++k) {
            expect_order(bench.step(wish_of({.cap = 8, .mask = 1})), kCapRapid, 0);
        }
        expect_order(bench.step(wish_of({}, true)), kCapRapid, 0);
    }
    expect_order(bench.fall(wish_of({.cap = 8, .mask = 1})), 8, 1);
}

// X may be faster again and Y is bound in its place: one permit cannot do that unproven.
TEST(CapControl, AcrossItAsksAndOtherwiseBindsBoth) {
    ControlBench bench;
    bench.fall(wish_of({.cap = 1, .mask = 1}));
    const CapWish across = wish_of({.cap = 6, .mask = 2});
    expect_order(bench.step(across), 1, 1);
    expect_order(bench.step(across), 6, 2);
    EXPECT_EQ(bench.asked, 1);
    ControlBench other;
    other.fall(wish_of({.cap = 1, .mask = 1}));
    other.step(across);
    expect_order(other.step(across, false), 1, 3);
}

TEST(CapControl, RisesAfterAWhileAndOnlyIfThatIsProven) {
    ControlBench bench;
    bench.fall(wish_of({.cap = 8, .mask = 1}));
    const CapWish rapid = wish_of({}, true);
    expect_order(bench.steps(100, rapid), 8, 1);
    expect_order(bench.steps(200, rapid, false), 8, 1);
    EXPECT_NEAR(bench.asked, 20, 2) << "every 10 ms";
    expect_order(bench.steps(40, rapid), kCapRapid, 0);
}

// Close to a body the wished order is not proven, and a little more than the one in force is.
TEST(CapControl, RisesInStepsWhereTheWishedOrderIsNotProven) {
    ControlBench bench;
    bench.fall(wish_of({.cap = 1, .mask = 3}));
    const CapWish rapid = wish_of({}, true);
    bench.steps(100, rapid);
    std::vector<int> asked;
    for (int i = 0; i < 80; ++i) {
        if (bench.control.asks(bench.now_us)) {
            asked.push_back(bench.control.asked().cap);
            EXPECT_EQ(bench.control.asked().mask, asked.back() == kCapRapid ? 0 : 3);
        }
        bench.step(rapid, false);
    }
    const std::vector<int> tried{250, 15, 3, 250, 15, 3};
    ASSERT_GE(asked.size(), tried.size());
    asked.resize(tried.size());
    EXPECT_EQ(asked, tried);
    while (bench.control.order().cap == 1) {
        bench.step(rapid, bench.control.asked().cap == 15);
    }
    expect_order(bench.control.order(), 15, 3);
    expect_order(bench.steps(20, rapid), kCapRapid, 0);
}

TEST(CapControl, WhileTheBoardSlowsDownItOrdersLessOnlyByHalf) {
    ControlBench bench;
    bench.fall(wish_of({.cap = 20, .mask = 3}));
    expect_order(bench.step(wish_of({.cap = 11, .mask = 3}), true, true, true), 20, 3);
    expect_order(bench.step(wish_of({.cap = 10, .mask = 3}), true, true, true), 10, 3);
    expect_order(bench.step(wish_of({.cap = 9, .mask = 7}), true, true, true), 9, 7);
}

TEST(CapControl, CrawlsThenHoldsAndGoesOn) {
    ControlBench bench;
    const CapWish none{
        .best = {.cap = 1, .mask = 0xFF}, .is_kept_fine = false, .is_any_proven = false};
    expect_order(bench.fall(none), kCapCrawl, 0xFF);
    expect_order(bench.steps(100, none), kCapCrawl, 0xFF);
    for (int i = 0; i < 5; ++i) {
        bench.step(none, false, false);
    }
    expect_order(bench.control.order(), kCapHold, 0xFF);
    expect_order(bench.steps(2500, none, false), kCapHold, 0xFF);
    EXPECT_TRUE(bench.control.is_held(bench.now_us));
    expect_order(bench.steps(12, none), kCapCrawl, 0xFF);
}

// Whatever the cycles say: `step` checks each order.
TEST(CapControl, NeverOrdersWhatIsNotProven) {
    std::mt19937_64 random(test::printed_seed(2711));
    ControlBench bench;
    for (int i = 0; i < 200'000; ++i) {
        const auto cap = static_cast<std::uint8_t>(1 + random() % kCapRapid);
        CapWish wish = wish_of({.cap = cap, .mask = static_cast<std::uint8_t>(random() % 32)},
                               random() % 4 != 0);
        wish.is_any_proven = random() % 8 != 0;
        if (!wish.is_any_proven) {
            wish.best = {.cap = kCapCrawl, .mask = 0xFF};
            wish.is_kept_fine = false;
        }
        bench.step(wish, random() % 2 == 0, random() % 2 == 0, random() % 3 == 0);
    }
    EXPECT_GT(bench.asked, 1000);
}

}  // namespace
}  // namespace axg
