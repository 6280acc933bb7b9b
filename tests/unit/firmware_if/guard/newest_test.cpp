// SPDX-License-Identifier: Apache-2.0
// The reader has the newest and each at most once, and of two threads it reads nothing torn.
#include "firmware_if/guard/newest.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <thread>

namespace axg {
namespace {

TEST(Newest, TheReaderHasTheLastOnce) {
    Newest<int> newest;
    int item = -1;
    EXPECT_FALSE(newest.take(item));
    EXPECT_EQ(item, -1) << "untouched";
    for (int i = 0; i < 5; ++i) {
        newest.write(i);
    }
    EXPECT_TRUE(newest.take(item));
    EXPECT_EQ(item, 4);
    EXPECT_FALSE(newest.take(item));
    newest.write(5);
    EXPECT_TRUE(newest.take(item));
    EXPECT_EQ(item, 5);
}

TEST(Newest, TwoThreadsTearNothingAndGoForward) {
    struct Item {
        std::uint64_t number, square, cube;
    };
    constexpr std::uint64_t kItems = 200'000;
    const auto newest = std::make_unique<Newest<Item>>();
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= kItems; ++i) {
            newest->write({i, i * i, i * i * i});
        }
    });
    std::uint64_t wrong = 0, last = 0;
    while (last < kItems) {
        Item item{};
        if (newest->take(item)) {
            const std::uint64_t i = item.number;
            wrong += i <= last || item.square != i * i || item.cube != i * i * i ? 1U : 0U;
            last = i;
        } else {
            std::this_thread::yield();
        }
    }
    writer.join();
    EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace axg
