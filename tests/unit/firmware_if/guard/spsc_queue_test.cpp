// SPDX-License-Identifier: Apache-2.0
// Order, the bound, and two threads: what one pushes the other pops, each item once.
#include "firmware_if/guard/spsc_queue.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <thread>

namespace axg {
namespace {

TEST(SpscQueue, RefusesTheNewestWhenFull) {
    SpscQueue<int, 4> queue;
    for (int i = 0; i < 4; ++i) {
        EXPECT_TRUE(queue.push(i));
    }
    EXPECT_FALSE(queue.push(4));
    int item = -1;
    for (int i = 0; i < 4; ++i) {
        EXPECT_TRUE(queue.pop(item));
        EXPECT_EQ(item, i);
    }
    EXPECT_FALSE(queue.pop(item));
    EXPECT_EQ(item, 3) << "untouched";
}

TEST(SpscQueue, TwoThreadsLoseNothingAndTearNothing) {
    struct Item {
        std::uint64_t number, square;
    };
    constexpr std::uint64_t kItems = 200'000;
    const auto queue = std::make_unique<SpscQueue<Item, 64>>();
    std::thread writer([&] {
        for (std::uint64_t i = 0; i < kItems; ++i) {
            while (!queue->push({i, i * i})) {
                std::this_thread::yield();
            }
        }
    });
    std::uint64_t wrong = 0;
    for (std::uint64_t i = 0; i < kItems; ++i) {
        Item item{};
        while (!queue->pop(item)) {
            std::this_thread::yield();
        }
        wrong += item.number != i || item.square != i * i ? 1U : 0U;
    }
    writer.join();
    EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace axg
