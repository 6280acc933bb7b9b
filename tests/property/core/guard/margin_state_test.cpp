// SPDX-License-Identifier: Apache-2.0
// Clearance levels that do not flap, against random approaches and retreats with bounded noise;
// and each edge of the rule from both sides. AXG_COUNT: runs.
#include "core/guard/margin_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

constexpr MarginRule kRule{
    .stop_mm = 1, .slow_mm = 2, .warn_mm = 4, .band_mm = 0.5, .hold_cycles = 3};
using enum ClearanceLevel;

unsigned run_count() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? 20000U : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

ClearanceLevel after(const std::vector<double>& clearances_mm) {
    MarginState state;
    for (const double clearance_mm : clearances_mm) {
        update_margin(state, kRule, clearance_mm);
    }
    return state.level;
}

TEST(MarginState, AMarginIsKeptUpToItselfAndNoNumberIsStop) {
    const double inf = std::numeric_limits<double>::infinity();
    for (const auto& [clearance_mm, level] :
         std::vector<std::pair<double, ClearanceLevel>>{{inf, clear},
                                                        {4, clear},
                                                        {std::nextafter(4, 0), warn},
                                                        {2, warn},
                                                        {std::nextafter(2, 0), slow},
                                                        {1, slow},
                                                        {std::nextafter(1, 0), stop},
                                                        {0, stop},
                                                        {-1, stop},
                                                        {-inf, stop},
                                                        {std::nan(""), stop}}) {
        EXPECT_EQ(clearance_level(kRule, clearance_mm), level) << clearance_mm;
        MarginState state{.level = clear};
        EXPECT_EQ(update_margin(state, kRule, clearance_mm), level) << "at once " << clearance_mm;
    }
}

TEST(MarginState, ABetterLevelNeedsTheBandAndTheCyclesInARow) {
    EXPECT_EQ(after({9, 9}), stop);
    EXPECT_EQ(after({9, 9, 9}), clear);
    EXPECT_EQ(after({4.5, 4.5, 4.5}), clear);
    EXPECT_EQ(after({4.25, 4.25, 4.25, 4.25}), warn) << "clear, but not beyond the band";
    EXPECT_EQ(after({9, 9, 1.25, 9, 9}), stop) << "not in a row";
    EXPECT_EQ(after({9, 9, std::nan(""), 9, 9}), stop);
    EXPECT_EQ(after({9, 3, 9}), warn) << "no better than the worst of the three";
    EXPECT_EQ(after({9, 3, 9, 9, 9}), warn) << "what counted once does not count again";
    EXPECT_EQ(after({9, 3, 9, 9, 9, 9}), clear);
    EXPECT_EQ(after({9, 9, 9, 0.5, 9, 9}), stop);
    MarginState state;
    MarginRule at_once = kRule;
    at_once.hold_cycles = 0;
    EXPECT_EQ(update_margin(state, at_once, 9), clear);
    EXPECT_EQ(MarginState{}.level, stop) << "zeroed memory";
}

MarginRule random_rule(std::mt19937_64& random) {
    MarginRule rule;
    rule.stop_mm = between(random, 0, 2);
    rule.slow_mm = rule.stop_mm + between(random, 0, 2);
    rule.warn_mm = rule.slow_mm + between(random, 0, 2);
    rule.band_mm = between(random, 0.01, 1);
    rule.hold_cycles = static_cast<std::uint32_t>(between(random, 1, 10));
    return rule;
}

// Any clearances at all: the level is never better than without memory, and a level that is left
// upwards was beyond its band for all the cycles that the rule asks for.
TEST(MarginState, NeverWarnsLaterThanWithoutMemory) {
    std::mt19937_64 random(printed_seed(20261170));
    unsigned better = 0;
    for (unsigned run = 0; run < run_count() && !HasFailure(); ++run) {
        const MarginRule rule = random_rule(random);
        MarginState state;
        std::uint32_t beyond = 0;  // cycles in a row, counted anew at each change of level
        for (int cycle = 0; cycle < 60 && !HasFailure(); ++cycle) {
            const double clearance_mm = between(random, 0, 7);
            const ClearanceLevel before = state.level;
            const bool is_beyond = clearance_level(rule, clearance_mm - rule.band_mm) > before;
            beyond = is_beyond ? beyond + 1 : 0;
            const ClearanceLevel level = update_margin(state, rule, clearance_mm);
            EXPECT_LE(level, clearance_level(rule, clearance_mm));
            EXPECT_EQ(level > before, beyond == rule.hold_cycles) << "run " << run;
            better += level > before ? 1U : 0U;
            beyond = level != before ? 0 : beyond;
        }
    }
    if (run_count() >= 20000) {
        EXPECT_GT(better, run_count() / 2) << "too few retreats to tell anything";
    }
}

// The clearance goes one way; noise of up to half a band is on it. The level goes one way as well,
// where one without memory goes back and forth.
TEST(MarginState, DoesNotFlapUnderNoiseOfHalfABand) {
    std::mt19937_64 random(printed_seed(20261171));
    std::uint64_t memoryless = 0;
    for (unsigned run = 0; run < run_count() && !HasFailure(); ++run) {
        const MarginRule rule = random_rule(random);
        const bool is_retreat = (random() & 1U) != 0;
        const double speed_mm = between(random, 0, 0.2) * (is_retreat ? 1 : -1);
        double true_mm = is_retreat ? 0.0 : 7.0;
        // 0.499: the sums are rounded.
        const auto noisy_mm = [&] {
            return true_mm + between(random, -0.499, 0.499) * rule.band_mm;
        };
        double clearance_mm = noisy_mm();
        MarginState state{.level = clearance_level(rule, clearance_mm)};
        ClearanceLevel last = state.level;
        if (is_retreat) {  // it comes from an approach: no better than the noise can make it
            state.level = last = clearance_level(rule, true_mm - 0.5 * rule.band_mm);
        }
        for (int cycle = 0; cycle < 60 && !HasFailure(); ++cycle) {
            true_mm += speed_mm;
            const ClearanceLevel raw_before = clearance_level(rule, clearance_mm);
            clearance_mm = noisy_mm();
            const ClearanceLevel raw = clearance_level(rule, clearance_mm);
            memoryless += (is_retreat ? raw < raw_before : raw > raw_before) ? 1U : 0U;
            const ClearanceLevel level = update_margin(state, rule, clearance_mm);
            EXPECT_TRUE(is_retreat ? level >= last : level <= last) << "run " << run;
            last = level;
        }
    }
    std::printf("without memory the level went back %llu times in %u runs\n",
                static_cast<unsigned long long>(memoryless), run_count());
    if (run_count() >= 20000) {
        EXPECT_GT(memoryless, run_count() / 2) << "too little noise to tell anything";
    }
}

}  // namespace
}  // namespace axg::test
