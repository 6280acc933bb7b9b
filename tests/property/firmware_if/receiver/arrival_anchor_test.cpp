// SPDX-License-Identifier: Apache-2.0
// Signals that arrive late at random, up to the jitter that is assumed, with a period that is off
// and samples lost: over the samples of a motion history no number is off by more than that jitter,
// and nothing that is in time stops. AXG_COUNT: boards.
#include "firmware_if/receiver/arrival_anchor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/reach/motion_history.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

struct Board {
    double period_us = 1000, jitter_us = 0, often = 0;  // how often it is fully late
    std::uint64_t loses = 0;                            // one in so many; 0: none
};

double delay_us(Random& random, const Board& board) {
    const double choice = between(random, 0, 1);
    return choice < board.often             ? board.jitter_us
           : choice < 1 - 0.5 * board.often ? 0
                                            : between(random, 0, board.jitter_us);
}

struct Numbered {
    double worst_us = 0;  // of the time between two numbers, beyond the period's share
    std::uint64_t refused = 0, wrong = 0;
};

Numbered number_board(Random& random, const Board& board) {
    struct Sample {
        double true_us;
        std::int64_t number;
    };
    ArrivalAnchor anchor{.period_us = 1000,
                         .jitter_us = static_cast<std::int64_t>(board.jitter_us) + 2};
    std::vector<Sample> samples;
    Numbered out;
    std::int64_t number = 0, arrived_us = 0;
    for (std::int64_t k = 0; k < 2000; ++k) {
        if (board.loses != 0 && random() % board.loses == 0) {
            continue;
        }
        const double true_us = 1e6 + static_cast<double>(k) * board.period_us;
        arrived_us =
            std::max(arrived_us, static_cast<std::int64_t>(true_us + delay_us(random, board)));
        const ArrivalNumber got = number_arrival(anchor, arrived_us);
        number += got.steps;
        out.refused += got.is_in_time ? 0 : 1;
        samples.push_back({true_us, number});
        const std::size_t kept = std::min<std::size_t>(samples.size(), kSamplesKept);
        for (std::size_t back = 1; back < kept; ++back) {
            const Sample& older = samples[samples.size() - 1 - back];
            const double nominal_us = 1000.0 * static_cast<double>(number - older.number);
            const double off_us = std::fabs(true_us - older.true_us - nominal_us);
            const double share_us = kPeriodShare * nominal_us;
            out.worst_us = std::max(out.worst_us, off_us - share_us);
        }
    }
    out.wrong = static_cast<std::uint64_t>(
        std::llabs(number - std::llround((samples.back().true_us - 1e6) / board.period_us) - 1));
    return out;
}

Board random_board(Random& random) {
    return {.period_us = 1000 * (1 + between(random, -0.0098, 0.0098)),
            .jitter_us = between(random, 0, 1000 * kArrivalJitterShareMax - 2),
            .often = between(random, 0, 1),
            .loses = (random() & 1U) != 0 ? 4 + random() % 200 : 0};
}

TEST(ArrivalAnchor, NoNumberIsOffByMoreThanWhatSpeedsAreBoundedFor) {
    Random random(printed_seed(20261220));
    const auto boards = count_from_environment(1000);
    double worst_us = 0;
    std::uint64_t exact = 0;
    for (std::uint64_t n = 0; n < boards && !testing::Test::HasFailure(); ++n) {
        const Board board = random_board(random);
        const Numbered numbered = number_board(random, board);
        // Two numbers too small, and the share of those periods.
        EXPECT_LE(numbered.worst_us, 2000 * (1 + kPeriodShare))  // sample_errors()
            << board.period_us << " " << board.jitter_us << " " << board.loses;
        EXPECT_EQ(numbered.refused, 0U)
            << board.period_us << " " << board.jitter_us << " " << board.loses;
        EXPECT_TRUE(board.loses != 0 || numbered.wrong == 0);
        worst_us = std::max(worst_us, numbered.worst_us);
        exact += numbered.wrong == 0 ? 1 : 0;
    }
    std::printf("%llu of %llu boards numbered exactly to the end; at most %.0f us off\n",
                static_cast<unsigned long long>(exact), static_cast<unsigned long long>(boards),
                worst_us);
}

}  // namespace
}  // namespace axg::test
