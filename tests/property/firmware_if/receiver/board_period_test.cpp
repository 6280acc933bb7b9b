// SPDX-License-Identifier: Apache-2.0
// Random boards of every format: one whose period is off by more than 1 % is never VALID, whatever
// its stamps do within a period; one that is off by up to 0.9 % becomes VALID and is never stopped,
// with worst legal jitter and lost samples. AXG_COUNT: boards of each kind.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/count.hpp"
#include "tests/support/period_board.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

constexpr CanFormat kFormats[] = {CanFormat::classical, CanFormat::fd, CanFormat::cia402,
                                  CanFormat::signals};

/// What a SYNC, or an arrival, may be late: of a period.
double most_late(CanFormat format) {
    // Drives answer within their window: what follows a SYNC that is late would come after the
    // next one.
    return format == CanFormat::cia402 ? 0.3 : format == CanFormat::signals ? 0.24 : 0.5;
}

/// The worst of all: late by nothing or by all, as long as it hides or shows a period best; or at
/// random.
std::function<std::int64_t(std::uint64_t)> random_delays(Random& random, double most_us) {
    const auto most = static_cast<std::int64_t>(most_us);
    const std::uint64_t stretch = 1U << (random() % 11);
    const std::uint64_t seed = random();
    switch (random() % 4) {
        case 0:
            return [](std::uint64_t) { return std::int64_t{0}; };
        case 1:
            return [=](std::uint64_t k) { return k / stretch % 2 == 0 ? most : 0; };
        case 2:  // a slow saw, as of a bridge that collects frames
            return [=](std::uint64_t k) {
                return static_cast<std::int64_t>(k % stretch * static_cast<std::uint64_t>(most) /
                                                 stretch);
            };
        default:
            return [=](std::uint64_t k) {
                Random of_sample(seed + k);
                return static_cast<std::int64_t>(of_sample() % static_cast<std::uint64_t>(most));
            };
    }
}

PeriodBoard random_board(Random& random, CanFormat format, double share) {
    PeriodBoard board{.format = format, .period_us = 1000 * (1 + share), .samples = 9000};
    board.late_us = random_delays(random, most_late(format) * 1000);
    if (random() % 2 == 0) {
        const std::uint64_t often = 20 + random() % 200, seed = random();
        board.is_lost = [=](std::uint64_t k) { return k > 20 && Random(seed + k)() % often == 0; };
    }
    return board;
}

Machine machine_of(CanFormat format) {
    Machine machine = five_axis_machine(format);
    machine.can.stale_after_us = 12'000;  // of permits of 12 samples
    machine.can.arrival_jitter_us = format == CanFormat::signals ? 250 : 0;
    return machine;
}

TEST(BoardPeriodProperty, AnyThatIsOffByMoreThanOnePercentIsNeverValid) {
    Random random(printed_seed(3120));
    const std::uint64_t boards = count_from_environment(25);
    for (const CanFormat format : kFormats) {
        for (std::uint64_t i = 0; i < boards; ++i) {
            // What is numbered by its arrival has no longer period: it has lost samples.
            const bool is_long = format != CanFormat::signals && random() % 4 == 0;
            const double share =
                is_long ? between(random, 0.0101, 0.05) : -between(random, 0.0101, 0.2);
            const PeriodHeard heard =
                hear_period(random_board(random, format, share), machine_of(format));
            ASSERT_FALSE(heard.valid_at) << share << ", board " << i;
        }
    }
}

TEST(BoardPeriodProperty, OneWithinNinetyPartsOfTheOnePercentIsShownAndNeverStopped) {
    Random random(printed_seed(3121));
    const std::uint64_t boards = count_from_environment(25);
    for (const CanFormat format : kFormats) {
        for (std::uint64_t i = 0; i < boards; ++i) {
            const double share = between(random, -0.009, 0.009);
            const PeriodHeard heard =
                hear_period(random_board(random, format, share), machine_of(format));
            ASSERT_EQ(heard.stop, ReceiverFault::none)
                << fault_row(heard.stop).name << ", " << share << ", board " << i;
            ASSERT_TRUE(heard.valid_at) << share << ", board " << i;
        }
    }
}

// The sweep of the machine file's 1000 us, without jitter: what is right and what is not, to 0.1 %.
// Without SYNC the arrivals drift apart, which is named so.
TEST(BoardPeriodProperty, ASweepOfShortPeriods) {
    for (const CanFormat format : kFormats) {
        for (int per_mille = 5; per_mille <= 200; per_mille += per_mille < 20 ? 1 : 7) {
            const PeriodHeard heard =
                hear_period({.format = format, .period_us = 1000.0 - per_mille, .samples = 9000});
            ASSERT_EQ(heard.valid_at.has_value(), per_mille < 10) << per_mille;
            ASSERT_EQ(heard.stop != ReceiverFault::none, per_mille > 10) << per_mille;
        }
    }
}

}  // namespace
}  // namespace axg::test
