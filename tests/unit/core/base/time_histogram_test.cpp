// SPDX-License-Identifier: Apache-2.0
// A share is never below the true one and at most a bucket's width (1/32) above it.
#include "core/base/time_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

/// What the histogram says of `ns`, when a much longer time stands behind it.
std::int64_t bucket_end(std::int64_t ns) {
    TimeHistogram times;
    times.add(ns);
    times.add(std::numeric_limits<std::int64_t>::max() / 2);
    return times.at_share_ns(0.5);
}

TEST(TimeHistogram, KnowsNothingBeforeTheFirstTime) {
    const TimeHistogram times;
    EXPECT_EQ(times.count(), 0U);
    EXPECT_EQ(times.mean_ns(), 0);
    EXPECT_EQ(times.at_share_ns(0.99), 0);
}

TEST(TimeHistogram, IsExactUpTo63) {
    for (std::int64_t ns = 0; ns < 64; ++ns) {
        EXPECT_EQ(bucket_end(ns), ns);
    }
}

TEST(TimeHistogram, KeepsBothSidesOfEveryBucketsEdge) {
    for (int octave = 1; octave < 56; ++octave) {
        for (std::int64_t step = 32; step < 64; ++step) {
            const std::int64_t first = step << octave;
            const std::int64_t last = ((step + 1) << octave) - 1;
            ASSERT_EQ(bucket_end(first), last);
            ASSERT_EQ(bucket_end(last), last);
            ASSERT_LT(bucket_end(first - 1), first);
            ASSERT_LE(static_cast<double>(last - first), static_cast<double>(first) / 32);
        }
    }
}

TEST(TimeHistogram, TakesTheLongestTimeThereIs) {
    TimeHistogram times;
    times.add(std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(times.at_share_ns(1), std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(times.most_ns(), std::numeric_limits<std::int64_t>::max());
}

TEST(TimeHistogram, AClockThatRanBackwardsCountsAsNoTime) {
    TimeHistogram times;
    times.add(-5);
    times.add(10);
    EXPECT_EQ(times.least_ns(), -5);
    EXPECT_EQ(times.most_ns(), 10);
    EXPECT_EQ(times.at_share_ns(0.5), 0);
}

TEST(TimeHistogram, NoShareIsTooSmallAndNoneIsMoreThanABucketTooLarge) {
    test::Draw draw(test::printed_seed(3));
    for (const std::size_t count : {1U, 2U, 99U, 100U, 101U, 5000U}) {
        TimeHistogram times;
        std::vector<std::int64_t> all;
        std::int64_t sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            all.push_back(static_cast<std::int64_t>(1000 * std::pow(draw.unit(), 4) * 1000) + 20);
            times.add(all.back());
            sum += all.back();
        }
        std::sort(all.begin(), all.end());
        EXPECT_EQ(times.least_ns(), all.front());
        EXPECT_EQ(times.most_ns(), all.back());
        EXPECT_DOUBLE_EQ(times.mean_ns(), static_cast<double>(sum) / static_cast<double>(count));
        for (const double share : {0.01, 0.29, 0.5, 0.9, 0.99, 0.999, 1.0}) {
            const auto rank =
                static_cast<std::size_t>(std::ceil(share * static_cast<double>(count) - 1e-9));
            const std::int64_t truth = all[std::max<std::size_t>(rank, 1) - 1];
            const std::int64_t told = times.at_share_ns(share);
            EXPECT_GE(told, truth) << share << " of " << count;
            EXPECT_LE(static_cast<double>(told), static_cast<double>(truth) * (1 + 1.0 / 32))
                << share << " of " << count;
        }
    }
}

}  // namespace
}  // namespace axg
