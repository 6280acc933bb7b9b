// SPDX-License-Identifier: Apache-2.0
// The search for the fastest stoppable feed: exact where slower is never worse, for every such
// case there is; where it is not, the answer was asked itself; always the same number of questions.
#include "core/speed_cap.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <set>

#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

TEST(SpeedCap, IsTheLargestFeedWhereSlowerIsNeverWorse) {
    for (std::uint32_t largest = 0; largest <= kSpeedCapRapid; ++largest) {
        std::uint32_t asked = 0;
        const std::uint8_t cap = speed_cap([&](std::uint8_t feed) {
            ++asked;
            EXPECT_GE(feed, 1U);
            EXPECT_LE(feed, kSpeedCapRapid);
            return feed <= largest;
        });
        EXPECT_EQ(cap, largest);
        EXPECT_EQ(asked, kSpeedCapQuestions);
    }
}

// A machine that is stoppable at any feed up to a threshold, bisected to the last bit as a real
// number: the grid's answer is the next one below, so within 5 % from a twelfth of rapid on.
TEST(SpeedCap, IsWithinFivePercentOfBisectionFromATwelfthOfRapidOn) {
    std::mt19937_64 random(printed_seed(20261172));
    for (int i = 0; i < 10000; ++i) {
        const double threshold = std::uniform_real_distribution<double>(0.0, 1.0)(random);
        const auto is_stoppable = [&](double fraction) { return fraction <= threshold; };
        double low = 0, high = 1;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (low + high);
            (is_stoppable(middle) ? low : high) = middle;
        }
        const double cap =
            speed_cap([&](std::uint8_t feed) { return is_stoppable(feed / 250.0); }) / 250.0;
        EXPECT_LE(cap, high);
        EXPECT_GT(cap, low - 1 / 250.0 - 1e-12);
        if (low >= 1.0 / 12) {
            EXPECT_GE(cap, 0.95 * low);
        }
    }
}

TEST(SpeedCap, IsItselfProvenWhateverTheAnswers) {
    std::mt19937_64 random(printed_seed(20261173));
    std::uint32_t not_largest = 0;
    for (int i = 0; i < 20000; ++i) {
        std::array<bool, 256> is_stoppable{};
        const std::uint64_t share = 1 + random() % 9;
        for (bool& yes : is_stoppable) {
            yes = random() % 10 < share;
        }
        std::set<std::uint32_t> proven{0};
        std::uint32_t asked = 0;
        const std::uint8_t cap = speed_cap([&](std::uint8_t feed) {
            ++asked;
            if (is_stoppable[feed]) {
                proven.insert(feed);
            }
            return is_stoppable[feed];
        });
        EXPECT_EQ(cap, *proven.rbegin()) << "the largest of the feeds answered with yes";
        EXPECT_EQ(asked, kSpeedCapQuestions);
        std::uint32_t largest = kSpeedCapRapid;
        while (largest > 0 && !is_stoppable[largest]) {
            --largest;
        }
        not_largest += cap < largest ? 1U : 0U;
    }
    EXPECT_GT(not_largest, 0U) << "no case in which slower was worse";
}

}  // namespace
}  // namespace axg::test
