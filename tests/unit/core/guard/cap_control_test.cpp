// SPDX-License-Identifier: Apache-2.0
// The cap falls at once, rises in small steps and only by what is proven, and ends at a crawl or in
// hold.
#include "core/guard/cap_control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::int64_t kPeriodUs = 1000;

struct Guard {
    explicit Guard(CapPromise promise = CapPromise::all_axes) : control(promise) {}

    CapOrder step(std::uint8_t wanted, bool is_proven = true, bool is_raise_proven = true) {
        cycle.sample_us += kPeriodUs;
        cycle.wanted = wanted;
        cycle.is_proven = is_proven;
        cycle.is_raise_proven = is_raise_proven;
        return control.update(cycle);
    }
    CapOrder steps(int count, std::uint8_t wanted, bool is_proven = true,
                   bool is_raise_proven = true) {
        CapOrder order = control.order();
        for (int i = 0; i < count; ++i) {
            order = step(wanted, is_proven, is_raise_proven);
        }
        return order;
    }
    CapControl control;
    CapCycle cycle;
};

TEST(CapControl, WithoutAPromiseNothingIsOrdered) {
    Guard guard(CapPromise::none);
    EXPECT_EQ(guard.step(10, false).cap, kCapRapid);
    EXPECT_EQ(guard.control.order().mask, 0);
}

TEST(CapControl, FallsAtOnceToWhatIsWanted) {
    Guard guard;
    EXPECT_EQ(guard.step(kCapRapid).cap, kCapRapid);
    EXPECT_EQ(guard.control.order().mask, 0);
    EXPECT_EQ(guard.step(235).cap, kCapRapid) << "less than a sixteenth is left alone";
    const CapOrder order = guard.step(100);
    EXPECT_EQ(order.cap, 100);
    EXPECT_EQ(order.mask, 0xFF);
}

TEST(CapControl, LosesAQuarterACycleWhileTooLittleIsProven) {
    Guard guard;
    EXPECT_EQ(guard.step(kCapRapid, false).cap, 187);
    EXPECT_EQ(guard.step(kCapRapid, false).cap, 140);
    EXPECT_EQ(guard.step(20, false).cap, 20);
}

TEST(CapControl, RisesByAThirtySecondEveryTenMillisecondsAfterRoom) {
    Guard guard;
    guard.step(64);
    EXPECT_EQ(guard.steps(100, kCapRapid).cap, 64) << "99 ms of room";
    EXPECT_EQ(guard.step(kCapRapid).cap, 66);
    EXPECT_EQ(guard.steps(9, kCapRapid).cap, 66);
    EXPECT_EQ(guard.step(kCapRapid).cap, 68);
    EXPECT_EQ(guard.steps(2000, kCapRapid).cap, kCapRapid);
    EXPECT_EQ(guard.control.order().mask, 0);
}

TEST(CapControl, RisesOnlyByWhatIsProvenInThisCycle) {
    Guard guard;
    guard.step(64);
    EXPECT_EQ(guard.control.raised_cap(), 66);
    EXPECT_EQ(guard.steps(300, kCapRapid, true, false).cap, 64);
    EXPECT_EQ(guard.step(kCapRapid).cap, 66);
}

TEST(CapControl, RoomThatEndsBeginsAnew) {
    Guard guard;
    guard.step(64);
    guard.steps(90, kCapRapid);
    EXPECT_EQ(guard.step(70).cap, 64) << "not an eighth more";
    EXPECT_EQ(guard.steps(100, 72).cap, 64);
    EXPECT_EQ(guard.step(72).cap, 66);
}

TEST(CapControl, CrawlsBeforeItHolds) {
    Guard guard;
    EXPECT_EQ(guard.step(0).cap, kCapCrawl);
    EXPECT_EQ(guard.step(kCapCrawl, false).cap, kCapCrawl) << "nothing is lowered at a crawl";
    EXPECT_EQ(guard.step(0, true).cap, kCapCrawl) << "as long as it is proven";
    EXPECT_EQ(guard.step(0, false).cap, kCapHold);
    EXPECT_FALSE(guard.control.is_held(guard.cycle.sample_us + kCapHeldUs - 1));
    EXPECT_TRUE(guard.control.is_held(guard.cycle.sample_us + kCapHeldUs));
}

TEST(CapControl, LeavesHoldByACrawlThatIsProven) {
    Guard guard;
    guard.step(0);
    guard.step(0, false);
    EXPECT_EQ(guard.steps(500, 0, true, false).cap, kCapHold);
    EXPECT_EQ(guard.control.raised_cap(), kCapCrawl);
    guard.step(0, false);
    EXPECT_EQ(guard.steps(100, 0).cap, kCapHold);
    EXPECT_EQ(guard.step(0).cap, kCapCrawl);
}

// Whatever the cycles say.
TEST(CapControl, NeverRisesFasterThanItsRule) {
    std::mt19937_64 random(test::printed_seed(27));
    const std::uint64_t count = test::count_from_environment(200'000);
    Guard guard;
    std::int64_t raised_us = -kCapRaiseUs, lowered_us = -kCapRoomUs;
    std::uint64_t raised = 0, lowered = 0;
    std::uint8_t wanted = kCapRapid;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint8_t before = guard.control.order().cap;
        if (random() % 300 == 0) {
            wanted = static_cast<std::uint8_t>(random() % 251);
        }
        const bool is_proven = random() % 500 != 0, is_raise_proven = random() % 4 != 0;
        const std::uint8_t cap = guard.step(wanted, is_proven, is_raise_proven).cap;
        const std::int64_t now_us = guard.cycle.sample_us;
        if (cap > before) {
            ++raised;
            ASSERT_TRUE(is_proven && is_raise_proven);
            ASSERT_LE(cap - before, std::max(1, before / 32));
            ASSERT_GE(now_us - raised_us, kCapRaiseUs);
            ASSERT_GE(now_us - lowered_us, kCapRoomUs);
            raised_us = now_us;
        } else if (cap < before) {
            ++lowered;
            lowered_us = now_us;
            ASSERT_TRUE(cap != kCapHold || before <= kCapCrawl);
        }
        ASSERT_LE(cap, kCapRapid);
    }
    EXPECT_GT(raised, count / 200);
    EXPECT_GT(lowered, count / 2000);
}

}  // namespace
}  // namespace axg
