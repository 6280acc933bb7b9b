// SPDX-License-Identifier: Apache-2.0
// The state machine of the guard, row by row: every input in every phase, from outside; then each
// condition from both sides. What holds over all sequences is in tests/property/guard_state_test.
#include "core/guard/guard_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/guard/guard_table.hpp"

namespace axg {
namespace {

constexpr GuardLimits kLimits{
    .snapshots_min = 3, .period_us = 1000, .bad_weight = 3, .bad_limit = 12};

/// A guard and what it said last.
struct Fixture {
    Guard guard;
    GuardOutput out;

    void on(GuardEvent event) { out = on_event(guard, event, kLimits); }
    void on(GuardEventKind kind) { on(GuardEvent{.kind = kind}); }
    void fault(GuardFault fault) { on({.kind = GuardEventKind::fault, .fault = fault}); }
    void snapshot(bool is_proven = true, std::int64_t age_us = 900, std::uint8_t samples = 3) {
        on({.kind = GuardEventKind::snapshot,
            .is_proven = is_proven,
            .period = guard.period,
            .age_us = age_us,
            .samples = samples});
    }
    void deadline() { on(GuardEventKind::deadline); }
    void good_period() { snapshot(), deadline(); }
};

Fixture in_phase(GuardPhase phase) {
    Fixture fixture{start_guard(false), {}};
    if (phase == GuardPhase::init) {
        return fixture;
    }
    fixture.on(GuardEventKind::loaded);
    if (phase == GuardPhase::selftest) {
        return fixture;
    }
    fixture.on(GuardEventKind::tested);
    fixture.on(GuardEventKind::tx_ok);
    for (int i = 0; i < 4; ++i) {
        fixture.good_period();
    }
    if (phase == GuardPhase::ready) {
        return fixture;
    }
    fixture.on(GuardEventKind::arm);
    if (phase == GuardPhase::armed) {
        return fixture;
    }
    fixture.fault(GuardFault::input);
    return fixture;
}

const std::array<GuardPhase, kGuardPhases> kPhases{GuardPhase::stopped, GuardPhase::init,
                                                   GuardPhase::selftest, GuardPhase::ready,
                                                   GuardPhase::armed};

TEST(GuardState, EveryPhaseIsReachedAsThePageSays) {
    for (const GuardPhase phase : kPhases) {
        EXPECT_EQ(in_phase(phase).guard.phase, phase) << to_text(phase);
    }
}

/// The phase afterwards, "+permit", "+stop", and the heartbeat: what can be seen from outside.
std::string seen(const Fixture& fixture) {
    const GuardHeartbeat heartbeat = fixture.out.heartbeat;
    const char* const beat = heartbeat == GuardHeartbeat::silent     ? "silent"
                             : heartbeat == GuardHeartbeat::starting ? "starting"
                             : heartbeat == GuardHeartbeat::running  ? "running"
                                                                     : "tripped";
    return std::string(to_text(fixture.guard.phase)) + (fixture.out.sends_permit ? "+permit" : "") +
           (fixture.out.sends_stop ? "+stop" : "") + " " + beat;
}

struct RowCase {
    const char* name;
    void (*events)(Fixture&);  // the last one is the row's
    std::array<const char*, kGuardPhases> wanted;
};

const char* const kStopped = "stopped tripped";
const char* const kStop = "stopped+stop tripped";
const char* const kInit = "init silent";
const char* const kTest = "selftest starting";
const char* const kReady = "ready running";
const char* const kArmed = "armed running";
const std::array<const char*, kGuardPhases> kStay{kStopped, kInit, kTest, kReady, kArmed};

/// As many periods without a proven snapshot as may be, then one more.
void miss(Fixture& fixture, int periods) {
    for (int i = 0; i < periods; ++i) {
        fixture.deadline();
    }
}

const std::vector<RowCase> kRows{
    {"loaded",
     [](Fixture& b) { b.on(GuardEventKind::loaded); },
     {kStopped, kTest, kTest, kReady, kArmed}},
    {"tested", [](Fixture& b) { b.on(GuardEventKind::tested); }, kStay},
    {"proven",
     [](Fixture& b) { b.snapshot(); },
     {kStopped, kInit, kTest, kReady, "armed+permit running"}},
    {"refused: not proven", [](Fixture& b) { b.snapshot(false); }, kStay},
    {"period_good", [](Fixture& b) { b.good_period(); }, {kStop, kInit, kTest, kReady, kArmed}},
    {"period_settled",
     [](Fixture& b) {
         b.on(GuardEventKind::tested), b.on(GuardEventKind::tx_ok);
         b.good_period(), b.good_period(), b.good_period(), b.good_period();
     },
     {kStop, kInit, kReady, kReady, kArmed}},
    {"period_disturbed",
     [](Fixture& b) { b.fault(GuardFault::input_noise), b.good_period(); },
     {kStop, kInit, kTest, kReady, kArmed}},
    {"period_missed", [](Fixture& b) { miss(b, 2); }, {kStop, kInit, kTest, kReady, kArmed}},
    {"period_silent", [](Fixture& b) { miss(b, 3); }, {kStop, kInit, kTest, kTest, kStop}},
    {"period_full",
     [](Fixture& b) {
         for (int i = 0; i < 4; ++i) {
             b.fault(GuardFault::input_noise), b.good_period();
         }
     },
     {kStop, kInit, kTest, kTest, kStop}},
    {"fault_reported", [](Fixture& b) { b.fault(GuardFault::recorder); }, kStay},
    {"fault_stop",
     [](Fixture& b) { b.fault(GuardFault::verdict); },
     {kStopped, kStop, kStop, kStop, kStop}},
    {"tx_ok", [](Fixture& b) { b.on(GuardEventKind::tx_ok); }, kStay},
    {"tx_fail",
     [](Fixture& b) { b.on(GuardEventKind::tx_fail); },
     {kStopped, kInit, kTest, kTest, kStop}},
    {"board_ack", [](Fixture& b) { b.on(GuardEventKind::board_ack); }, kStay},
    {"board_moves", [](Fixture& b) { b.on(GuardEventKind::board_moves); }, kStay},
    {"reset_refused", [](Fixture& b) { b.on(GuardEventKind::reset_edge); }, kStay},
    {"reset",
     [](Fixture& b) {
         b.on(GuardEventKind::board_ack), b.deadline(), b.deadline();
         b.on(GuardEventKind::reset_edge);
     },
     {kInit, kInit, kTest, kReady, kArmed}},
    {"arm",
     [](Fixture& b) { b.on(GuardEventKind::arm); },
     {kStopped, kInit, kTest, kArmed, kArmed}},
    {"restart",
     [](Fixture& b) { b.on(GuardEventKind::restart); },
     {kStop, kInit, kInit, kInit, kInit}},
    {"kill",
     [](Fixture& b) { b.on(GuardEventKind::kill); },
     {"stopped silent", kInit, kInit, kInit, kInit}},
    {"own_stop",
     [](Fixture& b) { b.on(GuardEventKind::own_stop); },
     {kStopped, kInit, kTest, kTest, kTest}},
};

TEST(GuardState, EveryInputInEveryPhase) {
    ASSERT_EQ(kRows.size(), kGuardInputs);
    for (const RowCase& row : kRows) {
        for (std::size_t i = 0; i < kPhases.size(); ++i) {
            Fixture fixture = in_phase(kPhases[i]);
            row.events(fixture);
            EXPECT_EQ(seen(fixture), row.wanted[i]) << row.name << " in " << to_text(kPhases[i]);
        }
    }
}

TEST(GuardTable, NamesNoRowTwiceAndNoRowForNothing) {
    std::set<std::pair<GuardInput, GuardPhase>> rows;
    for (const GuardRow& row : kGuardRows) {
        EXPECT_TRUE(rows.emplace(row.input, row.phase).second);
        EXPECT_LT(static_cast<std::uint32_t>(row.input), kGuardInputs);
        EXPECT_TRUE(row.next != row.phase || row.action != GuardAction::none);
    }
}

TEST(GuardState, ZeroedMemoryIsStoppedAndPermitsNothing) {
    Fixture fixture;
    EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped);
    fixture.snapshot();
    EXPECT_EQ(seen(fixture), "stopped tripped");
    EXPECT_FALSE(GuardOutput{}.sends_permit);
    fixture.on(GuardEvent{});  // the zeroed event stops
    Fixture armed = in_phase(GuardPhase::armed);
    armed.on(GuardEvent{});
    EXPECT_EQ(seen(armed), "stopped+stop tripped");
    EXPECT_EQ(armed.guard.cause, GuardFault::refused);
}

TEST(GuardState, AnEventThatIsNoneStops) {
    Fixture fixture = in_phase(GuardPhase::armed);
    fixture.on(static_cast<GuardEventKind>(200));
    EXPECT_EQ(seen(fixture), "stopped+stop tripped");
}

TEST(GuardState, PermitsASnapshotUpToItsAgeOnce) {
    for (const auto& [age_us, is_permitted] :
         {std::pair<std::int64_t, bool>{-1, false}, {0, true}, {2000, true}, {2001, false}}) {
        Fixture fixture = in_phase(GuardPhase::armed);
        fixture.snapshot(true, age_us);
        EXPECT_EQ(fixture.out.sends_permit, is_permitted) << age_us;
    }
    Fixture fixture = in_phase(GuardPhase::armed);
    fixture.snapshot();
    EXPECT_TRUE(fixture.out.sends_permit);
    fixture.snapshot();
    EXPECT_FALSE(fixture.out.sends_permit) << "the second of one period";
    fixture.deadline();
    EXPECT_FALSE(fixture.out.sends_permit) << "by the timer";
    fixture.snapshot();
    EXPECT_TRUE(fixture.out.sends_permit);
}

TEST(GuardState, AnEvaluationOfAnotherPeriodIsNone) {
    Fixture fixture = in_phase(GuardPhase::armed);
    for (const std::uint32_t off : {1U, 2U, 0xffffffffU}) {
        fixture.on({.kind = GuardEventKind::snapshot,
                    .is_proven = true,
                    .period = fixture.guard.period - off,
                    .age_us = 0,
                    .samples = 3});
        EXPECT_FALSE(fixture.out.sends_permit) << off;
    }
    fixture.guard.period = 0xffffffffU;
    fixture.good_period();
    EXPECT_EQ(fixture.guard.period, 0U);
    fixture.snapshot();
    EXPECT_TRUE(fixture.out.sends_permit) << "the count of periods wraps";
}

TEST(GuardState, ReadyNeedsTheSelfTestAnOwnFrameAndSnapshotsInARow) {
    struct Case {
        bool tested, heard;
        int good;
        GuardPhase wanted;
    };
    for (const Case& c :
         {Case{true, true, 3, GuardPhase::ready}, Case{false, true, 9, GuardPhase::selftest},
          Case{true, false, 9, GuardPhase::selftest}, Case{true, true, 2, GuardPhase::selftest}}) {
        for (const bool is_broken : {false, true}) {
            Fixture fixture = in_phase(GuardPhase::selftest);
            fixture.deadline();  // the period in which loading ended counts as disturbed
            if (c.tested) {
                fixture.on(GuardEventKind::tested);
            }
            if (c.heard) {
                fixture.on(GuardEventKind::tx_ok);
            }
            for (int i = 0; i < c.good; ++i) {
                if (is_broken && i == c.good - 1) {
                    fixture.deadline();  // one missed: the row begins again
                }
                fixture.good_period();
            }
            const bool is_whole = !is_broken || c.good > 3;
            EXPECT_EQ(fixture.guard.phase, is_whole ? c.wanted : GuardPhase::selftest)
                << c.tested << c.heard << c.good << is_broken;
        }
    }
    Fixture fixture = in_phase(GuardPhase::selftest);
    fixture.on(GuardEventKind::tx_ok), fixture.on(GuardEventKind::tested);
    fixture.on(GuardEventKind::tx_fail);  // heard once, but not since
    for (int i = 0; i < 9; ++i) {
        fixture.good_period();
    }
    EXPECT_EQ(fixture.guard.phase, GuardPhase::selftest);
    fixture.on(GuardEventKind::tx_ok), fixture.good_period();
    EXPECT_EQ(fixture.guard.phase, GuardPhase::ready);
}

TEST(GuardState, ResetNeedsTheBoardsWordAndAWholePeriodWithoutFault) {
    Fixture fixture = in_phase(GuardPhase::stopped);
    fixture.deadline(), fixture.deadline();
    fixture.on(GuardEventKind::reset_edge);
    EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped) << "not confirmed";
    fixture.on(GuardEventKind::board_ack);
    for (const auto fault : {GuardFault::input_noise, GuardFault::engine}) {
        fixture.fault(fault);
        fixture.on(GuardEventKind::reset_edge);
        EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped) << "fault in this period";
        fixture.deadline();
        fixture.on(GuardEventKind::reset_edge);
        EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped) << "fault in the last period";
    }
    fixture.on(GuardEventKind::tx_fail), fixture.deadline();
    fixture.on(GuardEventKind::reset_edge);
    EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped) << "a frame failed in the last period";
    fixture.deadline();
    fixture.on(GuardEventKind::reset_edge);
    EXPECT_EQ(fixture.guard.phase, GuardPhase::init);
    EXPECT_EQ(fixture.guard.cause, GuardFault::none);
}

TEST(GuardState, TheStopIsRepeatedUntilTheBoardConfirmsThisStop) {
    Fixture fixture = in_phase(GuardPhase::armed);
    fixture.on(GuardEventKind::board_ack);  // of nothing: it confirms no later stop
    fixture.fault(GuardFault::verdict);
    EXPECT_TRUE(fixture.out.sends_stop);
    for (int i = 0; i < 20; ++i) {
        fixture.on(GuardEventKind::tx_fail);
        EXPECT_FALSE(fixture.out.sends_stop) << "no storm of retries";
        fixture.deadline();
        EXPECT_TRUE(fixture.out.sends_stop);
    }
    fixture.on(GuardEventKind::board_ack);
    fixture.deadline();
    EXPECT_FALSE(fixture.out.sends_stop);
}

TEST(GuardState, AnAxisThatMovesAfterAllWithdrawsTheConfirmation) {
    Fixture fixture = in_phase(GuardPhase::stopped);
    fixture.on(GuardEventKind::board_ack), fixture.deadline(), fixture.deadline();
    EXPECT_FALSE(fixture.out.sends_stop);
    fixture.on(GuardEventKind::board_moves);
    fixture.on(GuardEventKind::reset_edge);
    EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped);
    fixture.deadline();
    EXPECT_TRUE(fixture.out.sends_stop) << "again, each period";
    fixture.on(GuardEventKind::board_ack), fixture.deadline();
    EXPECT_FALSE(fixture.out.sends_stop);
    fixture.on(GuardEventKind::reset_edge);
    EXPECT_EQ(fixture.guard.phase, GuardPhase::init);
}

TEST(GuardState, AStopOutlivesItsProcess) {
    Fixture fixture{start_guard(true), {}};
    EXPECT_EQ(fixture.guard.cause, GuardFault::latched);
    fixture.on(GuardEventKind::restart);
    EXPECT_EQ(seen(fixture), "stopped+stop tripped");
    EXPECT_EQ(fixture.guard.cause, GuardFault::latched);
    fixture.on(GuardEventKind::loaded);
    fixture.deadline();
    EXPECT_EQ(seen(fixture), "stopped+stop tripped") << "until this board confirms again";
    Fixture fresh{start_guard(false), {}};
    fresh.on(GuardEventKind::restart);
    EXPECT_EQ(seen(fresh), "init silent");
}

TEST(GuardState, ADisturbedPeriodHadItsPermitAndIsNoSilence) {
    Fixture fixture = in_phase(GuardPhase::armed);
    miss(fixture, 2);
    fixture.fault(GuardFault::input_noise), fixture.good_period();
    fixture.good_period(), fixture.good_period();  // the leaky count has room again
    EXPECT_EQ(fixture.guard.phase, GuardPhase::armed);
    Fixture other = in_phase(GuardPhase::armed);
    miss(other, 1);
    other.fault(GuardFault::input_noise), other.good_period();
    miss(other, 1);
    EXPECT_EQ(other.guard.phase, GuardPhase::armed) << "two missed, not in a row";
    EXPECT_EQ(other.guard.held, 2U);
}

// Whoever has sent a permit for n periods bears n - 1 without one, and a shorter one that follows
// takes nothing away from it.
TEST(GuardState, IsSilentWhenTheLastPermitHasEnded) {
    for (const std::uint8_t longest : std::to_array<std::uint8_t>({3, 8, 12, 15})) {
        for (const std::uint8_t after : std::to_array<std::uint8_t>({2, 3})) {
            Fixture fixture = in_phase(GuardPhase::armed);
            fixture.snapshot(true, 900, longest), fixture.deadline();
            fixture.snapshot(true, 900, after), fixture.deadline();
            fixture.guard.bad = 0;
            for (int i = 1; i < std::max(longest - 1, int{after}); ++i) {
                fixture.guard.bad = 0;  // it is not the flapping that is tested
                fixture.deadline();
                ASSERT_EQ(fixture.guard.phase, GuardPhase::armed) << int{longest} << ' ' << i;
            }
            fixture.guard.bad = 0;
            fixture.deadline();
            EXPECT_EQ(fixture.guard.phase, GuardPhase::stopped) << int{longest};
            EXPECT_EQ(fixture.guard.cause, GuardFault::silence);
        }
    }
}

TEST(GuardState, APermitIsNotSentThatEndsWithinAPeriod) {
    for (const std::uint8_t samples : std::to_array<std::uint8_t>({2, 3, 12})) {
        const std::int64_t latest_us = (samples - 1) * kLimits.period_us;
        Fixture fixture = in_phase(GuardPhase::armed);
        fixture.snapshot(true, latest_us + 1, samples);
        EXPECT_FALSE(fixture.out.sends_permit) << int{samples};
        fixture.snapshot(true, latest_us, samples);
        EXPECT_TRUE(fixture.out.sends_permit) << int{samples};
    }
    Fixture fixture = in_phase(GuardPhase::armed);
    fixture.snapshot(true, 0, 0);
    EXPECT_FALSE(fixture.out.sends_permit) << "no n is no permit";
}

TEST(GuardState, AResetForgetsAllEvidence) {
    Fixture fixture = in_phase(GuardPhase::armed);
    miss(fixture, 2);  // half the leaky count
    fixture.fault(GuardFault::input);
    fixture.on(GuardEventKind::board_ack), fixture.deadline(), fixture.deadline();
    EXPECT_EQ(fixture.guard.bad + fixture.guard.good + fixture.guard.held, 0U);
    fixture.on(GuardEventKind::reset_edge), fixture.on(GuardEventKind::loaded);
    for (int i = 0; i < 9; ++i) {
        fixture.good_period();
    }
    EXPECT_EQ(fixture.guard.phase, GuardPhase::selftest) << "no self-test, no own frame since";
    fixture.on(GuardEventKind::tested), fixture.good_period();
    EXPECT_EQ(fixture.guard.phase, GuardPhase::selftest) << "no own frame since";
    fixture.on(GuardEventKind::tx_ok), fixture.good_period();
    EXPECT_EQ(fixture.guard.phase, GuardPhase::ready);
}

TEST(GuardState, TheCauseIsTheFirstOneAndHasItsName) {
    const auto cause_after = [](void (*events)(Fixture&)) {
        Fixture fixture = in_phase(GuardPhase::armed);
        events(fixture);
        fixture.fault(GuardFault::engine);  // later: changes nothing
        return fixture.guard.cause;
    };
    EXPECT_EQ(cause_after([](Fixture& b) { miss(b, 3); }), GuardFault::silence);
    EXPECT_EQ(cause_after([](Fixture& b) { b.on(GuardEventKind::tx_fail); }), GuardFault::output);
    EXPECT_EQ(cause_after([](Fixture& b) { b.fault(GuardFault::gap); }), GuardFault::gap);
    EXPECT_EQ(cause_after([](Fixture& b) {
                  for (int i = 0; i < 4; ++i) {
                      b.fault(GuardFault::recorder), b.good_period();
                  }
              }),
              GuardFault::flapping);
}

TEST(GuardState, OneBadPeriodInFourIsBorneForEverOneInThreeIsNot) {
    for (const bool is_missed : {false, true}) {
        for (const int every : {4, 3}) {
            Fixture fixture = in_phase(GuardPhase::armed);
            for (int i = 0; i < 1000; ++i) {
                if (i % every != 0) {
                    fixture.good_period();
                } else if (is_missed) {
                    fixture.deadline();
                } else {
                    fixture.fault(GuardFault::input_noise), fixture.good_period();
                }
            }
            EXPECT_EQ(fixture.guard.phase, every == 4 ? GuardPhase::armed : GuardPhase::stopped);
        }
    }
}

TEST(GuardState, TheMonitorsCycleIsItsEvent) {
    CycleResult cycle;
    cycle.has_permit = true;
    cycle.samples = 5;
    const GuardEvent proven = guard_event_of(cycle, 7, 800);
    EXPECT_EQ(proven.kind, GuardEventKind::snapshot);
    EXPECT_TRUE(proven.is_proven);
    EXPECT_EQ(proven.period, 7U);
    EXPECT_EQ(proven.age_us, 800);
    EXPECT_EQ(proven.samples, 5U);
    cycle.has_permit = false;
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::snapshot);
    cycle.reason = StopReason::predicted;  // not proven before the first permit: withheld
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::snapshot);
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    cycle.has_permit = true;  // which the monitor never says beside a reason
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    cycle.is_stop = true;
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::fault);
    EXPECT_EQ(guard_event_of(cycle, 7, 800).fault, GuardFault::verdict);
}

TEST(GuardState, EveryNameIsItsOwn) {
    std::set<std::string> names;
    for (int i = 0; i <= static_cast<int>(kGuardFaultLast); ++i) {
        EXPECT_TRUE(names.insert(to_text(static_cast<GuardFault>(i))).second) << i;
    }
    for (const GuardPhase phase : kPhases) {
        EXPECT_TRUE(names.insert(to_text(phase)).second);
    }
    EXPECT_FALSE(names.contains("unknown"));
    EXPECT_STREQ(to_text(static_cast<GuardFault>(99)), "unknown");
    EXPECT_STREQ(to_text(static_cast<GuardPhase>(99)), "unknown");
}

}  // namespace
}  // namespace axg
