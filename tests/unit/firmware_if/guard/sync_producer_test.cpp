// SPDX-License-Identifier: Apache-2.0
// The grid of a guard's SYNC: it does not drift with late calls, its counter counts periods, and
// the jitter is enforced from both sides.
#include "firmware_if/guard/sync_producer.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

SyncProducer producer() {
    return {.period_us = 1000, .jitter_us = 300, .due_us = 5000};
}

TEST(SyncProducer, CountsOneTo240OnAGridThatLateCallsDoNotMove) {
    SyncProducer sync = producer();
    for (std::int64_t k = 0; k < 1000; ++k) {
        const std::int64_t instant_us = 5000 + 1000 * k;
        EXPECT_EQ(next_sync_us(sync), instant_us);
        EXPECT_EQ(take_sync(sync, instant_us - 1), 0);
        EXPECT_EQ(take_sync(sync, instant_us + k % 151), 1 + k % 240) << k;
        EXPECT_EQ(take_sync(sync, instant_us + 151), 0) << "once a period";
    }
}

TEST(SyncProducer, WhatIsTooLateIsNotSentAndItsNumberIsLost) {
    SyncProducer sync = producer();
    EXPECT_EQ(take_sync(sync, 5000), 1);
    EXPECT_EQ(take_sync(sync, 6151), 0) << "more than half of the jitter";
    EXPECT_EQ(take_sync(sync, 7150), 3);
    EXPECT_EQ(take_sync(sync, 12'100), 8) << "periods that were slept through";
    EXPECT_EQ(next_sync_us(sync), 13'000);
}

TEST(SyncProducer, AnEchoIsInTimeUpToTheJitterAfterItsOwnInstant) {
    SyncProducer sync = producer();
    for (std::int64_t k = 0; k < 500; ++k) {
        const std::int64_t instant_us = 5000 + 1000 * k;
        const std::uint8_t counter = take_sync(sync, instant_us + 20);
        EXPECT_TRUE(is_sync_in_time(sync, counter, instant_us));
        EXPECT_TRUE(is_sync_in_time(sync, counter, instant_us + 300));
        EXPECT_FALSE(is_sync_in_time(sync, counter, instant_us + 301));
        EXPECT_FALSE(is_sync_in_time(sync, counter, instant_us - 1));
        const std::uint8_t last = counter == 1 ? 240 : static_cast<std::uint8_t>(counter - 1);
        EXPECT_FALSE(is_sync_in_time(sync, last, instant_us + 100)) << "of the period before";
        EXPECT_TRUE(is_sync_in_time(sync, last, instant_us - 900));
    }
}

TEST(SyncProducer, IsNobodyWhereTheBoardIsTheProducer) {
    SyncProducer nobody = make_sync_producer({}, 5000);
    EXPECT_EQ(next_sync_us(nobody), INT64_MAX);
    EXPECT_EQ(take_sync(nobody, 5000), 0);
}

}  // namespace
}  // namespace axg
