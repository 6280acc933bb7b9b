// SPDX-License-Identifier: Apache-2.0
// Receiver rule 6: what a window of samples shows of the period, and what the receiver makes of it.
#include "firmware_if/receiver/period_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/period_board.hpp"

namespace axg {
namespace {

using namespace test;

constexpr PeriodTerms kTerms{.period_us = 1000, .right_us = 30, .wrong_us = 200};
constexpr CanFormat kFormats[] = {CanFormat::classical, CanFormat::fd, CanFormat::cia402,
                                  CanFormat::signals};
constexpr CanFormat kSyncFormats[] = {CanFormat::classical, CanFormat::fd, CanFormat::cia402};

// A window of 100 samples may be off by 1000 us; 20 us are the clocks', 30 us the stamps'.
TEST(PeriodWatch, AWindowShowsNoMoreThanItsStampsLeave) {
    for (const int sign : {-1, 1}) {
        const auto judged = [sign](std::int64_t off_us) {
            return judge_window(kTerms, 100, 100'000 + sign * off_us);
        };
        EXPECT_EQ(judged(0), PeriodVerdict::right);
        EXPECT_EQ(judged(949), PeriodVerdict::right);
        EXPECT_EQ(judged(950), PeriodVerdict::unknown);
        EXPECT_EQ(judged(1220), PeriodVerdict::unknown);
        EXPECT_EQ(judged(1221), PeriodVerdict::wrong);
    }
}

// Alone it shows nothing: 1 % of a period is less than the stamps may be off.
TEST(PeriodWatch, OnePeriodShowsNothing) {
    EXPECT_EQ(judge_window(kTerms, 1, 1000), PeriodVerdict::unknown);
    EXPECT_EQ(judge_window(kTerms, 1, 800), PeriodVerdict::unknown);
}

// 1.2 % off for ever: short windows cannot tell, a long one does.
TEST(PeriodWatch, AWindowIsFoundThatIsLongEnough) {
    PeriodWatch watch{.terms = {.period_us = 1000, .right_us = 1021, .wrong_us = 1021, .unit = 8}};
    PeriodVerdict verdict = PeriodVerdict::unknown;
    std::int64_t k = 0;
    for (; k < 4096 && verdict == PeriodVerdict::unknown; ++k) {
        verdict = judge_stamp(watch, 1, 988 * k);
    }
    EXPECT_EQ(verdict, PeriodVerdict::wrong);
    EXPECT_EQ(watch.measured_ns, 988'000);
    EXPECT_GT(k, 512) << "(0.012 - 0.0102) m > 1.021: 568 samples";
    EXPECT_LE(k, 1024 + 8);
}

// A host that stood still stamps late by any time; seven SYNCs in a row may be such.
TEST(PeriodWatch, SevenLateStampsInARowRefuteNothing) {
    PeriodWatch watch{.terms = {.period_us = 1000, .right_us = 1021, .wrong_us = 1021, .unit = 8}};
    bool is_right = false;
    for (std::int64_t k = 0; k < 2000; ++k) {
        const std::int64_t late_us = k % 8 == 3 ? 0 : 20'000;
        const PeriodVerdict verdict = judge_stamp(watch, 1, 1000 * k + late_us);
        ASSERT_NE(verdict, PeriodVerdict::wrong) << k;
        is_right = is_right || verdict == PeriodVerdict::right;
    }
    EXPECT_TRUE(is_right);
}

// Windows are counted in samples, whether their stamps came or not.
TEST(PeriodWatch, LostSamplesCount) {
    PeriodWatch watch{.terms = kTerms};
    std::int64_t k = 0;
    bool is_right = judge_stamp(watch, 1, 0) == PeriodVerdict::right;
    for (const std::int64_t steps : {1, 3, 2, 6, 1, 1}) {
        k += steps;
        const PeriodVerdict verdict = judge_stamp(watch, steps, 1000 * k);
        ASSERT_NE(verdict, PeriodVerdict::wrong);
        is_right = is_right || verdict == PeriodVerdict::right;
    }
    EXPECT_TRUE(is_right);
}

TEST(PeriodWatch, ARestartForgetsWhatWasMeasuredOfAnotherBoard) {
    PeriodWatch watch{.terms = {.period_us = 1000, .right_us = 30, .wrong_us = 30}};
    for (std::int64_t k = 0; k < 10; ++k) {
        EXPECT_NE(judge_stamp(watch, 1, 1000 * k), PeriodVerdict::wrong);
    }
    restart(watch);
    EXPECT_EQ(judge_stamp(watch, 1, 77'777), PeriodVerdict::unknown);
    EXPECT_EQ(judge_stamp(watch, 1, 78'777), PeriodVerdict::unknown);
}

// When a right period is shown: by SYNC when what a SYNC may be late is 1 % of the window, though
// the sender's clock shows it at once. Before that nobody may move.
TEST(BoardPeriod, ARightOneIsShownAsSoonAsTheStampsLeaveNoDoubt) {
    EXPECT_EQ(hear_period({.format = CanFormat::classical}).valid_at, 135U);
    EXPECT_EQ(hear_period({.format = CanFormat::fd}).valid_at, 135U);
    EXPECT_EQ(hear_period({.format = CanFormat::cia402}).valid_at, 135U);
    EXPECT_EQ(hear_period({.format = CanFormat::signals, .samples = 1000}).valid_at, 519U);
    for (const CanFormat format : kFormats) {
        EXPECT_EQ(hear_period({.format = format, .samples = 1000}).stop, ReceiverFault::none);
    }
}

TEST(BoardPeriod, AWrongOneIsNeverValidAndIsNamed) {
    for (const CanFormat format : kSyncFormats) {
        for (const double period_us : {800.0, 850.0, 900.0, 950.0, 970.0, 985.0, 1015.0, 1020.0}) {
            const PeriodHeard heard =
                hear_period({.format = format, .period_us = period_us, .samples = 3000});
            EXPECT_FALSE(heard.valid_at) << period_us;
            EXPECT_STREQ(fault_row(heard.stop).name, "sync_period") << period_us;
            EXPECT_NEAR(static_cast<double>(heard.measured_ns), 1000 * period_us, 3000);
        }
    }
}

// What is numbered by its arrival drifts away from its anchor: a stop too, and named so. A longer
// period counts as lost samples, and the numbers are right.
TEST(BoardPeriod, AShortOneWithoutSyncIsNeverValid) {
    for (const double period_us : {800.0, 900.0, 950.0, 970.0, 985.0}) {
        const PeriodHeard heard =
            hear_period({.format = CanFormat::signals, .period_us = period_us, .samples = 3000});
        EXPECT_FALSE(heard.valid_at) << period_us;
        EXPECT_STREQ(fault_row(heard.stop).name, "arrival_jitter") << period_us;
    }
}

// 976,562 ns is no whole number of microseconds: what is left takes its part of the 1 %.
TEST(BoardPeriod, TheRestOfAMicrosecondIsTakenFromTheOnePercent) {
    for (const CanFormat format : kFormats) {
        Machine machine = five_axis_machine(format);
        for (const std::uint32_t sample_us : {976U, 977U}) {
            machine.can.sample_us = sample_us;
            const PeriodHeard heard =
                hear_period({.format = format, .period_us = 976.562, .samples = 1000}, machine);
            EXPECT_TRUE(heard.valid_at);
            EXPECT_EQ(heard.stop, ReceiverFault::none);
        }
        machine.can.sample_us = 1000;
        EXPECT_FALSE(hear_period({.format = format, .period_us = 976.562}, machine).valid_at);
    }
}

// A period that was right and becomes wrong, while VALID.
TEST(BoardPeriod, OneThatChangesStops) {
    for (const CanFormat format : kSyncFormats) {
        Machine machine = five_axis_machine(format);
        const PeriodHeard heard =
            hear_period({.format = format,
                         .samples = 3000,
                         .late_us =
                             [](std::uint64_t k) {
                                 // 3 % short from sample 1000 on
                                 return k < 1000 ? 0 : -30 * static_cast<std::int64_t>(k - 1000);
                             }},
                        machine);
        EXPECT_TRUE(heard.valid_at);
        EXPECT_STREQ(fault_row(heard.stop).name, "sync_period");
        EXPECT_LT(*heard.wrong_at, 1600U);
    }
}

// A sender that counts its periods in place of time says that each is right; SYNC refutes it before
// anybody may move.
TEST(BoardPeriod, SyncRefutesASendersClockThatIsNone) {
    Machine machine = five_axis_machine(CanFormat::fd);
    const PeriodHeard heard =
        hear_period({.format = CanFormat::fd,
                     .late_us = [](std::uint64_t k) { return -50 * static_cast<std::int64_t>(k); }},
                    machine);
    EXPECT_FALSE(heard.valid_at);
    EXPECT_STREQ(fault_row(heard.stop).name, "sync_period");
    EXPECT_LT(*heard.wrong_at, 60U);
}

// SYNC is the guard's own: it shows nothing of the drives, and the listing says so.
TEST(BoardPeriod, NothingMeasuresItWhereTheGuardSendsSync) {
    Machine machine = five_axis_machine(CanFormat::cia402);
    EXPECT_TRUE(unmeasured_period(machine.can).empty());
    machine.can.guard_sends_sync = true;
    EXPECT_FALSE(unmeasured_period(machine.can).empty());
    const PeriodHeard heard = hear_period({.format = CanFormat::cia402}, machine);
    EXPECT_EQ(heard.valid_at, 1U);
    EXPECT_EQ(heard.measured_ns, 0);
}

TEST(BoardPeriod, WhoOnlySupposesItWaitsForNothingAndStopsAllTheSame) {
    for (const CanFormat format : kSyncFormats) {
        const Machine machine = five_axis_machine(format);
        EXPECT_EQ(hear_period({.format = format}, machine, PeriodUse::supposed).valid_at, 1U);
        EXPECT_STREQ(fault_row(hear_period({.format = format, .period_us = 970, .samples = 2000},
                                           machine, PeriodUse::supposed)
                                   .stop)
                         .name,
                     "sync_period");
        EXPECT_EQ(hear_period({.format = format, .period_us = 970, .samples = 2000}, machine,
                              PeriodUse::ignored)
                      .stop,
                  ReceiverFault::none);
    }
}

// A board that began anew counts SYNC from elsewhere: its first stamp says nothing of the old
// one's.
TEST(BoardPeriod, ASyncOutOfOrderBeginsTheMeasurementAnew) {
    Machine machine = five_axis_machine(CanFormat::classical);
    AxisReceiver receiver(machine, {.period = PeriodUse::proven});
    const auto sync = [&](std::int64_t time_us, int counter) {
        CanFrame frame;
        frame.time_us = time_us;
        frame.id = machine.can.sync_id;
        frame.length_bytes = 1;
        frame.data[0] = static_cast<std::uint8_t>(counter);
        return receiver.on_frame(frame);
    };
    for (int k = 0; k < 100; ++k) {
        EXPECT_EQ(sync(1'000'000 + 1000 * k, k + 1).kind, ReceiverEvent::Kind::none);
    }
    for (int k = 0; k < 100; ++k) {
        EXPECT_NE(sync(1'100'500 + 1000 * k, 200 + k <= 240 ? 200 + k : k - 40).fault,
                  ReceiverFault::sync_period);
    }
}

}  // namespace
}  // namespace axg
