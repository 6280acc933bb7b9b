// SPDX-License-Identifier: Apache-2.0
// Random approaches of a tool to a plate with a wall, in closed loop with the deployed guard's
// chain: with caps and without, permits of 3 to 15 samples, frames lost, late, overtaken and
// repeated, a guard that falls silent at the worst instant, orders raised against the law, boards
// that slow down late, turns, tools that change. Tool and plate never touch; without the guard, or
// with a rule made wrong, some do. What is rarer: cap_ablation_test.cpp. AXG_COUNT: approaches;
// AXG_SEED: the first; each has a seed of its own.
#include <gtest/gtest.h>

#include "tests/support/approach_tally.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsual = 160;

TEST(CapApproach, NeverTouchesWhateverTheWireDoes) {
    const std::uint64_t seed = printed_seed(20261128);
    const std::uint64_t count = count_from_environment(kUsual);
    const ApproachTally whole = run_approaches(seed, count, Wrong::nothing, Aim::any);
    print("whole", whole);
    EXPECT_EQ(whole.touched, 0U);
    EXPECT_EQ(whole.breaches, 0U) << "every board kept its cap";
    EXPECT_EQ(whole.left_limits, 0U) << "and its limits";
    EXPECT_EQ(whole.left_cap, 0U);
    // The same approaches, and nobody stops them.
    const ApproachTally ignored = run_approaches(
        seed, std::clamp<std::uint64_t>(count / 4, 1, 2000), Wrong::ignored, Aim::any);
    print("guard ignored", ignored);
    if (count >= kUsual) {
        EXPECT_GT(2 * whole.moved, count) << "too weak to tell anything";
        EXPECT_GT(2 * ignored.touched, ignored.moved) << "too weak to tell anything";
        EXPECT_GT(whole.slowed, 0U);
    }
}

// An order acts behind what is announced, and the ack follows when the axes have come there.
TEST(CapApproach, NorWhereTheBoardAnnouncesItsPath) {
    const std::uint64_t seed = printed_seed(20261128);
    const std::uint64_t count = std::max<std::uint64_t>(1, count_from_environment(kUsual) / 8);
    const ApproachTally whole = run_approaches(seed, count, Wrong::nothing, Aim::announce);
    print("announced", whole);
    EXPECT_EQ(whole.touched, 0U);
    EXPECT_EQ(whole.breaches, 0U);
    EXPECT_EQ(whole.left_limits, 0U);
    EXPECT_EQ(whole.left_cap, 0U);
    const ApproachTally lies = run_approaches(seed, count, Wrong::ignores, Aim::announce);
    print("announced, acknowledged at once, not kept", lies);
    EXPECT_EQ(lies.touched, 0U) << "the path bounds the motion, whatever the ack says";
    if (count >= kUsual / 8) {
        EXPECT_GT(whole.slowed, 0U);
        EXPECT_GT(lies.left_cap, 0U);
    }
}

// Of 100,000 these were faster than what they named, in a stop along their path: that takes longer
// than the path was announced for, and what was told meanwhile is for later.
TEST(CapApproach, AStopAlongThePathKeepsWhatWasNamedBefore) {
    for (const std::uint64_t seed : {20315346U, 20330999U, 20345929U, 20357385U, 20359082U}) {
        const ApproachTally one = run_approaches(seed, 1, Wrong::nothing, Aim::any);
        EXPECT_EQ(one.moved, 1U);
        EXPECT_EQ(one.breaches, 0U) << seed;
        EXPECT_EQ(one.touched, 0U);
    }
}

TEST(CapApproach, TouchesWhereARuleIsWrong) {
    const std::uint64_t seed = printed_seed(20261128);
    const std::uint64_t count = count_from_environment(kUsual) / 2;
    const auto run = [&](const char* name, Wrong wrong, Aim aim) {
        const ApproachTally tally = run_approaches(seed, count, wrong, aim);
        print(name, tally);
        return tally;
    };
    const ApproachTally more = run("n one too large", Wrong::one_more, Aim::straight);
    const ApproachTally late = run("acknowledges, slows down later", Wrong::late, Aim::any);
    if (count >= kUsual / 2) {
        EXPECT_GT(more.touched, 0U);
        EXPECT_GT(late.touched + late.left_cap, 0U);
    }
}

}  // namespace
}  // namespace axg::test
