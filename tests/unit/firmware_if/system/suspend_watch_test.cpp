// SPDX-License-Identifier: Apache-2.0
// A suspend is told from a thread that was held between two readings of the clocks.
#include "firmware_if/system/suspend_watch.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace axg {
namespace {

// What the clocks say, one reading after the other.
std::int64_t awake_us, asleep_us;
std::vector<std::int64_t> held_us;  // before each reading; none: it takes no time
std::size_t readings;

void pass_time() noexcept {
    awake_us += readings < held_us.size() ? held_us[readings] : 0;
    ++readings;
}

class Suspend : public testing::Test {
  protected:
    static SuspendWatch begin() {
        awake_us = 5'000'000;
        asleep_us = 70'000'000;
        held_us.clear();
        readings = 0;
        return SuspendWatch(kClocks);
    }
    /// `between` passes before each of its three readings.
    bool has_slept(std::vector<std::int64_t> between = {}) {
        held_us = std::move(between);
        readings = 0;
        return watch.has_slept();
    }
    static constexpr SuspendClocks kClocks{.monotonic_us =
                                               []() noexcept {
                                                   pass_time();
                                                   return awake_us;
                                               },
                                           .boottime_us =
                                               []() noexcept {
                                                   pass_time();
                                                   return awake_us + asleep_us;
                                               }};
    SuspendWatch watch = begin();
};

TEST_F(Suspend, IsSaidOnceAndOnBothSidesOfTheLeast) {
    EXPECT_FALSE(has_slept());
    awake_us += 1000;
    asleep_us += SuspendWatch::kSuspendUsMin - 1;
    EXPECT_FALSE(has_slept());
    asleep_us += 1;
    EXPECT_TRUE(has_slept()) << "both together are a millisecond";
    EXPECT_FALSE(has_slept()) << "once";
    asleep_us += 3'600'000'000;
    EXPECT_TRUE(has_slept());
    EXPECT_FALSE(has_slept());
}

TEST_F(Suspend, IsNoThreadThatWasHeldBetweenTheReadings) {
    for (const auto& between :
         {std::vector<std::int64_t>{900'000, 0, 0}, {0, 900'000, 0}, {0, 0, 900'000}}) {
        EXPECT_FALSE(has_slept(between));
        EXPECT_FALSE(has_slept());
    }
}

TEST_F(Suspend, IsSeenAlsoAfterAStartThatWasHeld) {
    held_us = {0, 400'000, 0};
    readings = 0;
    SuspendWatch held(kClocks);
    held_us.clear();
    EXPECT_FALSE(held.has_slept());
    asleep_us += 200'000;
    EXPECT_TRUE(held.has_slept());
}

TEST_F(Suspend, IsSeenAcrossAHoldInTheSameReading) {
    EXPECT_FALSE(has_slept());
    asleep_us += 2'000'000;
    EXPECT_TRUE(has_slept({0, 300'000, 300'000}));
    EXPECT_FALSE(has_slept());
}

TEST(SuspendClocks, OfTheSystemGoOnTogether) {
    SuspendWatch watch;
    for (int i = 0; i < 10'000; ++i) {
        ASSERT_FALSE(watch.has_slept());
    }
    const SuspendClocks clocks = system_suspend_clocks();
    EXPECT_GE(clocks.boottime_us(), clocks.monotonic_us() - 1000);
}

}  // namespace
}  // namespace axg
