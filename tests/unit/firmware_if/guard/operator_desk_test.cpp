// SPDX-License-Identifier: Apache-2.0
// Which message acts: one row for each way in which it may be wrong, by a clock that is passed in.
#include "firmware_if/guard/operator_desk.hpp"

#include <gtest/gtest.h>

#include <set>

namespace axg {
namespace {

constexpr OperatorRefusal kFree = OperatorRefusal::none;
constexpr std::int64_t kNowUs = 1'000'000;

class OperatorDeskTest : public testing::Test {
  protected:
    OperatorHearing say(OperatorStep step, OperatorAction action, std::uint32_t nonce,
                        std::int64_t now_us = kNowUs, OperatorRefusal hindrance = kFree) {
        counter = (counter + 1) & 15U;
        return hear(desk, {.action = action, .step = step, .counter = counter, .nonce = nonce},
                    hindrance, now_us);
    }
    OperatorHearing ask(OperatorAction action = OperatorAction::arm) {
        return say(OperatorStep::request, action, 0);
    }
    OperatorHearing confirm(std::uint32_t nonce, std::int64_t now_us = kNowUs,
                            OperatorRefusal hindrance = kFree) {
        return say(OperatorStep::confirm, OperatorAction::arm, nonce, now_us, hindrance);
    }
    OperatorStatus status(std::int64_t now_us = kNowUs) const {
        return status_of(desk, GuardPhase::ready, now_us);
    }

    OperatorDesk desk;
    std::uint8_t counter = 3;
};

TEST_F(OperatorDeskTest, ARequestDrawsANonceAndItsConfirmationActs) {
    EXPECT_EQ(status().nonce, 0U);
    EXPECT_EQ(ask(), OperatorHearing::asked);
    const std::uint32_t nonce = status().nonce;
    EXPECT_NE(nonce, 0U);
    EXPECT_LT(nonce, 1U << 24U);
    EXPECT_EQ(status().action, OperatorAction::arm);
    EXPECT_EQ(status().phase, GuardPhase::ready);
    EXPECT_EQ(confirm(nonce), OperatorHearing::confirmed);
    EXPECT_EQ(status().action, OperatorAction::none);
    EXPECT_EQ(status().nonce, 0U);
    EXPECT_EQ(status().refusal, OperatorRefusal::none);
    EXPECT_EQ(confirm(nonce), OperatorHearing::refused) << "it serves once";
    EXPECT_EQ(status().refusal, OperatorRefusal::nonce);
}

TEST_F(OperatorDeskTest, AConfirmationWithoutARequestIsRefused) {
    EXPECT_EQ(confirm(0), OperatorHearing::refused);
    EXPECT_EQ(desk.refusal, OperatorRefusal::nonce);
}

TEST_F(OperatorDeskTest, AWrongNonceIsRefusedAndUsesTheRightOneUp) {
    (void)ask();
    const std::uint32_t nonce = desk.nonce;
    EXPECT_EQ(confirm(nonce ^ 1U), OperatorHearing::refused);
    EXPECT_EQ(desk.refusal, OperatorRefusal::nonce);
    EXPECT_EQ(confirm(nonce), OperatorHearing::refused) << "one guess a request";
}

TEST_F(OperatorDeskTest, AnotherActionThanTheOneAskedForIsRefused) {
    (void)ask(OperatorAction::reset);
    EXPECT_EQ(confirm(desk.nonce), OperatorHearing::refused);
    EXPECT_EQ(desk.refusal, OperatorRefusal::nonce);
    EXPECT_FALSE(has_request(desk, kNowUs));
}

TEST_F(OperatorDeskTest, FiveSecondsAreKeptOnBothSides) {
    (void)ask();
    EXPECT_NE(status(kNowUs + 5'000'000).nonce, 0U);
    EXPECT_EQ(confirm(desk.nonce, kNowUs + 5'000'000), OperatorHearing::confirmed);
    (void)ask();
    EXPECT_EQ(status(kNowUs + 5'000'001).nonce, 0U);
    EXPECT_EQ(status(kNowUs + 5'000'001).action, OperatorAction::none);
    EXPECT_EQ(confirm(desk.nonce, kNowUs + 5'000'001), OperatorHearing::refused);
    EXPECT_EQ(desk.refusal, OperatorRefusal::too_late);
}

TEST_F(OperatorDeskTest, ANewRequestEndsTheOneBefore) {
    (void)ask();
    const std::uint32_t nonce = desk.nonce;
    (void)ask();
    EXPECT_NE(desk.nonce, nonce);
    EXPECT_EQ(confirm(nonce), OperatorHearing::refused);
}

TEST_F(OperatorDeskTest, WhatHindersTheGuardIsSaidAndLeavesNothingWaiting) {
    for (const OperatorRefusal hindrance :
         {OperatorRefusal::moves, OperatorRefusal::cause, OperatorRefusal::phase}) {
        EXPECT_EQ(say(OperatorStep::request, OperatorAction::arm, 0, kNowUs, hindrance),
                  OperatorHearing::refused);
        EXPECT_EQ(desk.refusal, hindrance);
        EXPECT_FALSE(has_request(desk, kNowUs));
        (void)ask();
        EXPECT_EQ(desk.refusal, OperatorRefusal::none);
        const std::uint32_t nonce = desk.nonce;
        EXPECT_EQ(confirm(nonce, kNowUs, hindrance), OperatorHearing::refused);
        EXPECT_EQ(desk.refusal, hindrance);
        EXPECT_EQ(confirm(nonce), OperatorHearing::refused) << "ask again";
    }
}

TEST_F(OperatorDeskTest, ARequestIsForThePhaseItWasMadeIn) {
    (void)ask();
    forget_request(desk);
    EXPECT_EQ(status().action, OperatorAction::none);
    EXPECT_EQ(confirm(desk.nonce), OperatorHearing::refused);
    EXPECT_EQ(desk.refusal, OperatorRefusal::nonce);
}

TEST_F(OperatorDeskTest, OnlyTheNextCounterIsHeard) {
    (void)ask();
    const OperatorDesk before = desk;
    for (unsigned ahead = 0; ahead < 16; ++ahead) {
        if (ahead == 1) {
            continue;
        }
        desk = before;
        const auto wrong = static_cast<std::uint8_t>((before.counter + ahead) & 15U);
        const OperatorMessage message{.action = OperatorAction::arm,
                                      .step = OperatorStep::confirm,
                                      .counter = wrong,
                                      .nonce = before.nonce};
        EXPECT_EQ(hear(desk, message, kFree, kNowUs), OperatorHearing::ignored) << ahead;
        EXPECT_TRUE(has_request(desk, kNowUs)) << "nothing but the counter is remembered";
        OperatorMessage next = message;
        next.counter = (wrong + 1) & 15U;
        EXPECT_EQ(hear(desk, next, kFree, kNowUs), OperatorHearing::confirmed)
            << "a panel that starts again finds its way";
    }
}

TEST_F(OperatorDeskTest, NoncesAreOfTheClockAloneNeverZeroNeverTheLastOne) {
    std::set<std::uint32_t> drawn;
    std::uint32_t last = 0;
    for (std::int64_t now_us = 0; now_us < 100'000; ++now_us) {
        const std::uint32_t nonce = draw_nonce(now_us, last);
        ASSERT_NE(nonce, 0U);
        ASSERT_NE(nonce, last);
        ASSERT_LT(nonce, 1U << 24U);
        EXPECT_EQ(draw_nonce(now_us, last), nonce);
        const std::uint32_t other = draw_nonce(now_us, nonce);
        ASSERT_NE(other, nonce) << "asked twice in one instant";
        drawn.insert(last = nonce);
    }
    // So many draws of 2^24 meet some 300 times.
    EXPECT_GT(drawn.size(), 99'500U);
}

}  // namespace
}  // namespace axg
