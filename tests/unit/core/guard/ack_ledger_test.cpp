// SPDX-License-Identifier: Apache-2.0
// Four bits name a permit: every permit that they may mean counts, and none of before. The whole
// with a board that loses permits: tests/property/core/guard/ack_ledger_test.cpp.
#include "core/guard/ack_ledger.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

AxisCaps equal_caps(std::uint8_t cap) {
    return caps_of_permit(cap, 0xFF);
}

/// Permits with these numbers, all with one cap.
void send(AckLedger& ledger, unsigned first, unsigned last, std::uint8_t cap) {
    for (unsigned i = first; i <= last; ++i) {
        ledger.note_sent(static_cast<std::uint8_t>(i), equal_caps(cap));
    }
}

std::uint8_t cap_of(const AckedCaps& acked) {
    EXPECT_EQ(acked.status, AckStatus::known);
    return acked.caps[0];
}

TEST(AckLedger, ThePermitsMaskBindsItsAxes) {
    const AxisCaps caps = caps_of_permit(60, 0b1000'0110);
    EXPECT_EQ(caps[0], kCapRapid);
    EXPECT_EQ(caps[1], 60);
    EXPECT_EQ(caps[2], 60);
    EXPECT_EQ(caps[6], kCapRapid);
    EXPECT_EQ(caps[7], 60);
    EXPECT_EQ(caps[12], 60);
    EXPECT_EQ(higher_caps(caps, equal_caps(100))[0], kCapRapid);
    EXPECT_EQ(higher_caps(caps, equal_caps(100))[1], 100);
}

TEST(AckLedger, WithoutAnAckEveryAxisMayRunAtRapid) {
    AckLedger ledger;
    send(ledger, 1, 4, 10);
    const AckedCaps none = ledger.note_ack({});
    EXPECT_EQ(none.status, AckStatus::none);
    EXPECT_EQ(none.caps, rapid_caps());
}

TEST(AckLedger, APermitThatIsNamedCounts) {
    AckLedger ledger;
    send(ledger, 1, 4, 100);
    EXPECT_EQ(cap_of(ledger.note_ack(3)), 100);
    EXPECT_EQ(ledger.behind(), 1U);
    ledger.note_sent(5, caps_of_permit(40, 1));
    EXPECT_EQ(cap_of(ledger.note_ack(4)), 100) << "the order is not in force yet";
    const AckedCaps acked = ledger.note_ack(5);
    EXPECT_EQ(cap_of(acked), 40);
    EXPECT_EQ(acked.caps[1], kCapRapid);
}

TEST(AckLedger, APermitOfBeforeIsUnknown) {
    AckLedger ledger;
    EXPECT_EQ(ledger.note_ack(3).status, AckStatus::unknown);
    send(ledger, 1, 4, 100);
    EXPECT_EQ(ledger.note_ack(0).status, AckStatus::unknown);
    EXPECT_EQ(cap_of(ledger.note_ack(3)), 100);
    EXPECT_EQ(ledger.note_ack(2).status, AckStatus::unknown);
    EXPECT_EQ(ledger.note_ack(2).caps, rapid_caps());
    ledger.clear();
    EXPECT_EQ(ledger.note_ack(3).status, AckStatus::unknown);
}

// A cap that was in force when old positions were true counts until no position is of that time.
TEST(AckLedger, PositionsOfBeforeMayHaveBeenTakenUnderTheCapOfThen) {
    for (const unsigned age : {0U, 1U, 3U}) {
        AckLedger ledger;
        send(ledger, 1, 1, 200);
        for (unsigned i = 0; i < 8; ++i) {
            (void)ledger.note_sample(1, 0, age);
        }
        send(ledger, 2, 2, 40);
        for (unsigned i = 0; i < 8; ++i) {  // it has slowed down, and names the order
            const CapFacts facts = ledger.note_sample(2, 0, age);
            EXPECT_EQ(facts.acked[0], i < age ? 200 : 40) << age << ' ' << i;
            EXPECT_EQ(facts.status, AckStatus::known);
        }
    }
}

// Between two samples it may have kept more than either of them names.
TEST(AckLedger, WithAnAgeEveryPermitInBetweenCounts) {
    AckLedger ledger;
    send(ledger, 1, 1, 40);
    for (unsigned i = 0; i < 20; ++i) {
        (void)ledger.note_sample(1, 0, 1);
    }
    send(ledger, 2, 2, 120);
    send(ledger, 3, 3, 40);
    EXPECT_EQ(ledger.note_sample(3, 0, 1).acked[0], 120);
    EXPECT_EQ(ledger.note_sample(3, 0, 1).acked[0], 40);
    EXPECT_EQ(ledger.note_sample({}, 0, 1).acked, rapid_caps());
    EXPECT_EQ(ledger.note_sample(3, 0, 1).acked, rapid_caps()) << "a sample named no permit";
    EXPECT_EQ(ledger.note_sample(3, 0, 1).acked[0], 40);
}

// What is known of 16 samples before is about positions that were older still.
TEST(AckLedger, TheWindowOfSpeedsIsLongerByTheAge) {
    for (const unsigned age : {0U, 2U, kAgeSamplesMax, kAgeSamplesMax + 1}) {
        AckLedger ledger;
        send(ledger, 1, 1, 200);
        for (unsigned i = 0; i < 60; ++i) {
            (void)ledger.note_sample(1, 0, age);
        }
        send(ledger, 2, 2, 40);
        for (unsigned i = 0; i < 60; ++i) {
            const std::uint8_t since = ledger.note_sample(2, 0, age).since[0];
            const std::uint8_t known = i < 16 + age ? 200 : 40;
            EXPECT_EQ(since, age > kAgeSamplesMax ? kCapRapid : known) << age << ' ' << i;
        }
    }
}

// The board takes 95 periods to slow down, and names the last permit without the cap meanwhile.
TEST(AckLedger, ABoardThatSlowsDownIsNotTakenForOneThatHas) {
    AckLedger ledger;
    send(ledger, 15, 20, kCapRapid);
    for (unsigned i = 21; i <= 115; ++i) {
        ledger.note_sent(static_cast<std::uint8_t>(i), equal_caps(60));
        EXPECT_EQ(cap_of(ledger.note_ack(20 % 16)), kCapRapid) << i;
    }
    EXPECT_EQ(cap_of(ledger.note_ack(115 % 16)), 60);
}

// What is known is no more than the bits say: the ledger stays behind by whole rounds of them, and
// takes so long longer to believe the next slow-down.
TEST(AckLedger, StaysBehindByWholeRounds) {
    AckLedger ledger;
    send(ledger, 15, 20, kCapRapid);
    EXPECT_EQ(cap_of(ledger.note_ack(20 % 16)), kCapRapid);
    send(ledger, 21, 115, 60);
    EXPECT_EQ(cap_of(ledger.note_ack(115 % 16)), 60);
    EXPECT_EQ(ledger.behind(), 80U);
    send(ledger, 116, 116, 10);
    for (unsigned i = 117; i <= 195; ++i) {
        send(ledger, i, i, 10);
        EXPECT_EQ(cap_of(ledger.note_ack(i % 16)), 60) << i;
    }
    send(ledger, 196, 196, 10);
    EXPECT_EQ(cap_of(ledger.note_ack(196 % 16)), 10);
    EXPECT_EQ(ledger.behind(), 80U);
}

TEST(AckLedger, IsNotBehindABoardThatNamesRecentPermitsAlone) {
    AckLedger ledger;
    send(ledger, 15, 20, kCapRapid);
    EXPECT_EQ(cap_of(ledger.note_recent_ack(20 % 16)), kCapRapid);
    for (unsigned i = 21; i <= 115; ++i) {
        ledger.note_sent(static_cast<std::uint8_t>(i), equal_caps(60));
        EXPECT_EQ(ledger.note_recent_ack({}).caps, rapid_caps());
    }
    EXPECT_EQ(cap_of(ledger.note_recent_ack(115 % 16)), 60);
    EXPECT_EQ(ledger.behind(), 0U);
    send(ledger, 116, 117, 10);
    EXPECT_EQ(cap_of(ledger.note_recent_ack(115 % 16)), 60);
    EXPECT_EQ(cap_of(ledger.note_recent_ack(116 % 16)), 10);
}

// u may have been as high as any permit allowed that was named, or sent since, 16 samples ago.
TEST(AckLedger, ASampleKnowsTheHighestCapOfSixteenSamples) {
    AckLedger ledger;
    send(ledger, 1, 1, 200);
    EXPECT_EQ(ledger.note_sample({}).since, rapid_caps());
    CapFacts facts = ledger.note_sample(1);
    EXPECT_EQ(facts.status, AckStatus::known);
    EXPECT_EQ(facts.acked, equal_caps(200));
    EXPECT_EQ(facts.since, rapid_caps()) << "not every one of 17 samples names a permit";
    for (unsigned i = 2; i <= 18; ++i) {
        send(ledger, i, i, 40);
        facts = ledger.note_sample(i % 16);
        EXPECT_EQ(facts.acked, equal_caps(40));
        const bool is_whole = i >= 17;
        EXPECT_EQ(facts.since, is_whole && i < 18 ? equal_caps(200)
                               : is_whole         ? equal_caps(40)
                                                  : rapid_caps())
            << i;
    }
    send(ledger, 19, 19, 90);
    EXPECT_EQ(ledger.note_sample(18 % 16).since, equal_caps(90)) << "it may be in force already";
    EXPECT_EQ(ledger.note_sample(1).status, AckStatus::unknown);
}

// A board names a permit first within 15 samples, and then for as long as it slows down.
TEST(AckLedger, ANewNumberIsOneOfTheNewestPermits) {
    AckLedger ledger;
    send(ledger, 15, 20, 200);
    EXPECT_EQ(ledger.note_sample(20 % 16).acked, equal_caps(200));
    for (unsigned i = 21; i <= 115; ++i) {
        send(ledger, i, i, 60);
        EXPECT_EQ(ledger.note_sample(20 % 16).acked, equal_caps(200)) << "it may still be that one";
    }
    EXPECT_EQ(ledger.note_sample(115 % 16).acked, equal_caps(60));
    EXPECT_EQ(ledger.behind(), 0U) << "and nothing is left behind";
    send(ledger, 116, 116, 100);
    for (unsigned i = 117; i <= 132; ++i) {
        send(ledger, i, i, 60);
    }
    EXPECT_EQ(ledger.note_sample(116 % 16).acked, equal_caps(60)) << "132, not 116";
}

// The sample that named it first may be one that was lost.
TEST(AckLedger, AfterLostSamplesANewNumberMayBeAnOlderPermit) {
    AckLedger ledger;
    send(ledger, 1, 1, 40);
    EXPECT_EQ(ledger.note_sample(1).acked, equal_caps(40));
    send(ledger, 2, 3, 40);
    send(ledger, 4, 4, 100);
    send(ledger, 5, 20, 40);
    AckLedger lost = ledger;
    EXPECT_EQ(ledger.note_sample(4).acked, equal_caps(40)) << "20";
    EXPECT_EQ(lost.note_sample(4, 4).acked, equal_caps(100)) << "4 or 20";
}

TEST(AckLedger, RemembersBeyondWhatItKeeps) {
    AckLedger ledger;
    send(ledger, 250, 260, kCapRapid);  // the counter wraps
    EXPECT_EQ(cap_of(ledger.note_ack(260 % 16)), kCapRapid);
    send(ledger, 261, 1000, 60);
    EXPECT_EQ(cap_of(ledger.note_ack(260 % 16)), kCapRapid);
    EXPECT_EQ(cap_of(ledger.note_ack(261 % 16)), 60);
    EXPECT_EQ(cap_of(ledger.note_ack(260 % 16)), kCapRapid) << "higher than it may be, not lower";
}

TEST(AckLedger, AGapInTheNumbersForgetsWhatWasBefore) {
    AckLedger ledger;
    send(ledger, 1, 4, 10);
    send(ledger, 9, 9, 60);
    EXPECT_EQ(ledger.note_ack(4).status, AckStatus::unknown);
    EXPECT_EQ(cap_of(ledger.note_ack(9)), 60);
}

}  // namespace
}  // namespace axg
