// SPDX-License-Identifier: Apache-2.0
// ctest-labels: night
// What each rule of permit, ack and cap is for: the approaches of cap_approach_test.cpp, drawn for
// what a rule prevents. As they are none touches; with the rule made wrong some do, or another rule
// catches it. AXG_COUNT: approaches of each; AXG_SEED: the first.
#include <gtest/gtest.h>

#include "tests/support/approach_tally.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualOfEachRule = 1000;

ApproachTally run(const char* name, Wrong wrong, Aim aim, std::uint64_t share = 1) {
    const std::uint64_t count =
        std::max<std::uint64_t>(1, count_from_environment(kUsualOfEachRule) / share);
    const ApproachTally tally = run_approaches(printed_seed(20261128), count, wrong, aim);
    print(name, tally);
    return tally;
}
bool is_telling() {
    return count_from_environment(kUsualOfEachRule) >= kUsualOfEachRule;
}

TEST(CapAblation, AsTheyAreNoneTouches) {
    for (const Aim aim :
         {Aim::straight, Aim::crawl, Aim::turn, Aim::tool, Aim::let_go, Aim::announce}) {
        const ApproachTally whole = run("whole", Wrong::nothing, aim);
        EXPECT_EQ(whole.touched, 0U);
        EXPECT_EQ(whole.breaches, 0U);
        EXPECT_EQ(whole.left_cap, 0U);
        EXPECT_EQ(whole.left_limits, 0U);
    }
}

TEST(CapAblation, ALongerPermitThanWasProven) {
    const ApproachTally more = run("n one too large", Wrong::one_more, Aim::straight, 4);
    const ApproachTally before =
        run("a raised cap with the n of before", Wrong::n_of_before, Aim::let_go);
    if (is_telling()) {
        EXPECT_GT(more.touched, 0U);
        EXPECT_GT(before.touched, 0U);
    }
}

TEST(CapAblation, TheOldToolForgottenByTheShortestPermit) {
    const ApproachTally tool = run("tool kept for H(n_min)", Wrong::tool_too_soon, Aim::tool);
    if (is_telling()) {
        EXPECT_GT(tool.touched, 0U);
    }
}

TEST(CapAblation, AnOrderBelievedBeforeItsAck) {
    const ApproachTally early = run("V of the order before its ack", Wrong::unacked, Aim::crawl);
    if (is_telling()) {
        EXPECT_GT(early.touched, 0U);
    }
}

// A raise waits until no older permit ends later (rule (iv) of the library): so a permit that
// rule (iii) would have refused extends nothing by more than its own proof has room for.
TEST(CapAblation, ARaiseThatDropsNoPermit) {
    const ApproachTally iii = run("rule (iii) left out", Wrong::no_rule_iii, Aim::let_go);
    const ApproachTally iv = run("rule (iv) left out", Wrong::no_rule_iv, Aim::let_go);
    const ApproachTally both = run("both left out", Wrong::no_rule_iii_iv, Aim::let_go);
    if (is_telling()) {
        EXPECT_GT(iii.uncovered, 0U);
        EXPECT_GT(iv.touched, 0U);
        EXPECT_GT(both.touched, 0U);
    }
}

TEST(CapAblation, ABoardThatAcknowledgesAndDoesNotSlowDown) {
    for (const auto& [name, wrong] :
         {std::pair{"late", Wrong::late}, std::pair{"half", Wrong::half},
          std::pair{"ignores", Wrong::ignores}}) {
        const ApproachTally lies = run(name, wrong, Aim::any, 2);
        if (is_telling()) {
            EXPECT_GT(lies.left_cap, 0U);
            EXPECT_GT(lies.touched, 0U);
        }
    }
    const ApproachTally reacts = run("a feed that reacts", Wrong::reacts, Aim::turn);
    if (is_telling()) {
        EXPECT_GT(reacts.left_cap, 0U);
        EXPECT_GT(reacts.touched, 0U);
    }
}

/// A second and a half of motion far from everything, while a frame of fifty is lost.
DriveResult drive_far(ApproachScene& scene, std::uint64_t seed, std::uint32_t stale_samples) {
    Dice dice(seed);
    Machine& machine = scene.loaded.machine;
    draw_limits(dice, machine);
    machine.guard.cap = CapPromise::none;
    machine.guard.free_jerk_limited = true;
    machine.can.sample_us = 1000;
    machine.can.permit_samples = kPermitSamplesUsual;
    machine.can.stale_after_us = 1000 * stale_samples;
    std::optional<StopCertificate> certificate = make_stop_certificate(scene.loaded);
    GuardChain chain(machine, scene.engine->engine(), *scene.containment_test, {&*certificate});
    Approach approach;
    approach.target = {-250, 200, 250};
    approach.speed_share.fill(0.2);
    const Positions start{250, -200, 200};
    DriveOptions options;
    options.board = promised_board(machine, seed);
    options.faults.lost = 0.02;
    options.time_us_max = 1'500'000;
    return drive(machine, chain, {start.data(), 3}, make_approach(machine, approach), options);
}

TEST(CapAblation, SamplesThatAreStaleAfterThreePeriods) {
    const std::uint64_t seed = printed_seed(20261128);
    const std::uint64_t count =
        std::max<std::uint64_t>(1, count_from_environment(kUsualOfEachRule) / 25);
    ApproachScene scene;
    const Machine as_made = scene.loaded.machine;
    // Three lost frames of one id have the receiver begin anew with it; further losses then may
    // take it longer than any permit.
    const auto stale_after = [&](std::uint32_t samples) {
        std::uint64_t stopped = 0, stale = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const DriveResult result = drive_far(scene, seed + i, samples);
            scene.loaded.machine = as_made;
            stopped += result.state == BoardState::stopped ? 1 : 0;
            stale += result.guard_stop.fault == ReceiverFault::stale ? 1 : 0;
        }
        std::printf(
            "stale after %u periods, 2 %% of all frames lost: of %llu runs of 1.5 s %llu "
            "were stopped, %llu for it\n",
            samples, static_cast<unsigned long long>(count),
            static_cast<unsigned long long>(stopped), static_cast<unsigned long long>(stale));
        return stale;
    };
    const std::uint64_t as_ever = stale_after(kPermitSamplesUsual.most), early = stale_after(3);
    if (is_telling()) {
        EXPECT_GT(early, 10 * as_ever);
    }
}

}  // namespace
}  // namespace axg::test
