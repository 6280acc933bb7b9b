// SPDX-License-Identifier: Apache-2.0
// The state machine of the guard, row by row: every input in every phase, from outside; then each
// condition from both sides. What holds over all sequences is in tests/property/guard_state_test.
#include "core/guard/guard_state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/guard/guard_table.hpp"

namespace axg {
namespace {

constexpr GuardLimits kLimits{.snapshots_min = 3,
                              .silent_periods = 3,
                              .snapshot_age_us = 3000,
                              .bad_weight = 3,
                              .bad_limit = 12};

/// A guard and what it said last.
struct Bench {
    Guard guard;
    GuardOutput out;

    void on(GuardEvent event) { out = on_event(guard, event, kLimits); }
    void on(GuardEventKind kind) { on(GuardEvent{.kind = kind}); }
    void fault(GuardFault fault) { on({.kind = GuardEventKind::fault, .fault = fault}); }
    void snapshot(bool is_proven = true, std::int64_t age_us = 900) {
        on({.kind = GuardEventKind::snapshot,
            .is_proven = is_proven,
            .period = guard.period,
            .age_us = age_us});
    }
    void deadline() { on(GuardEventKind::deadline); }
    void good_period() { snapshot(), deadline(); }
};

Bench in_phase(GuardPhase phase) {
    Bench bench{start_guard(false), {}};
    if (phase == GuardPhase::init) {
        return bench;
    }
    bench.on(GuardEventKind::loaded);
    if (phase == GuardPhase::selftest) {
        return bench;
    }
    bench.on(GuardEventKind::tested);
    bench.on(GuardEventKind::tx_ok);
    for (int i = 0; i < 4; ++i) {
        bench.good_period();
    }
    if (phase == GuardPhase::ready) {
        return bench;
    }
    bench.on(GuardEventKind::arm);
    if (phase == GuardPhase::armed) {
        return bench;
    }
    bench.fault(GuardFault::input);
    return bench;
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
std::string seen(const Bench& bench) {
    const std::array<const char*, 4> beats{"silent", "starting", "running", "tripped"};
    return std::string(to_text(bench.guard.phase)) + (bench.out.sends_permit ? "+permit" : "") +
           (bench.out.sends_stop ? "+stop" : "") + " " +
           beats[static_cast<std::size_t>(bench.out.heartbeat)];
}

struct RowCase {
    const char* name;
    void (*events)(Bench&);  // the last one is the row's
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
void miss(Bench& bench, int periods) {
    for (int i = 0; i < periods; ++i) {
        bench.deadline();
    }
}

const std::vector<RowCase> kRows{
    {"loaded",
     [](Bench& b) { b.on(GuardEventKind::loaded); },
     {kStopped, kTest, kTest, kReady, kArmed}},
    {"tested", [](Bench& b) { b.on(GuardEventKind::tested); }, kStay},
    {"proven",
     [](Bench& b) { b.snapshot(); },
     {kStopped, kInit, kTest, kReady, "armed+permit running"}},
    {"refused: not proven", [](Bench& b) { b.snapshot(false); }, kStay},
    {"period_good", [](Bench& b) { b.good_period(); }, {kStop, kInit, kTest, kReady, kArmed}},
    {"period_settled",
     [](Bench& b) {
         b.on(GuardEventKind::tested), b.on(GuardEventKind::tx_ok);
         b.good_period(), b.good_period(), b.good_period(), b.good_period();
     },
     {kStop, kInit, kReady, kReady, kArmed}},
    {"period_disturbed",
     [](Bench& b) { b.fault(GuardFault::input_noise), b.good_period(); },
     {kStop, kInit, kTest, kReady, kArmed}},
    {"period_missed", [](Bench& b) { miss(b, 2); }, {kStop, kInit, kTest, kReady, kArmed}},
    {"period_silent", [](Bench& b) { miss(b, 3); }, {kStop, kInit, kTest, kTest, kStop}},
    {"period_full",
     [](Bench& b) {
         for (int i = 0; i < 4; ++i) {
             b.fault(GuardFault::input_noise), b.good_period();
         }
     },
     {kStop, kInit, kTest, kTest, kStop}},
    {"fault_reported", [](Bench& b) { b.fault(GuardFault::recorder); }, kStay},
    {"fault_stop",
     [](Bench& b) { b.fault(GuardFault::verdict); },
     {kStopped, kStop, kStop, kStop, kStop}},
    {"tx_ok", [](Bench& b) { b.on(GuardEventKind::tx_ok); }, kStay},
    {"tx_fail",
     [](Bench& b) { b.on(GuardEventKind::tx_fail); },
     {kStopped, kInit, kTest, kTest, kStop}},
    {"board_ack", [](Bench& b) { b.on(GuardEventKind::board_ack); }, kStay},
    {"reset_refused", [](Bench& b) { b.on(GuardEventKind::reset_edge); }, kStay},
    {"reset",
     [](Bench& b) {
         b.on(GuardEventKind::board_ack), b.deadline(), b.deadline();
         b.on(GuardEventKind::reset_edge);
     },
     {kInit, kInit, kTest, kReady, kArmed}},
    {"arm", [](Bench& b) { b.on(GuardEventKind::arm); }, {kStopped, kInit, kTest, kArmed, kArmed}},
    {"restart",
     [](Bench& b) { b.on(GuardEventKind::restart); },
     {kStop, kInit, kInit, kInit, kInit}},
    {"kill",
     [](Bench& b) { b.on(GuardEventKind::kill); },
     {"stopped silent", kInit, kInit, kInit, kInit}},
};

TEST(GuardState, EveryInputInEveryPhase) {
    ASSERT_EQ(kRows.size(), kGuardInputs);
    for (const RowCase& row : kRows) {
        for (std::size_t i = 0; i < kPhases.size(); ++i) {
            Bench bench = in_phase(kPhases[i]);
            row.events(bench);
            EXPECT_EQ(seen(bench), row.wanted[i]) << row.name << " in " << to_text(kPhases[i]);
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
    Bench bench;
    EXPECT_EQ(bench.guard.phase, GuardPhase::stopped);
    bench.snapshot();
    EXPECT_EQ(seen(bench), "stopped tripped");
    EXPECT_FALSE(GuardOutput{}.sends_permit);
    bench.on(GuardEvent{});  // the zeroed event stops
    Bench armed = in_phase(GuardPhase::armed);
    armed.on(GuardEvent{});
    EXPECT_EQ(seen(armed), "stopped+stop tripped");
    EXPECT_EQ(armed.guard.cause, GuardFault::refused);
}

TEST(GuardState, AnEventThatIsNoneStops) {
    Bench bench = in_phase(GuardPhase::armed);
    bench.on(static_cast<GuardEventKind>(200));
    EXPECT_EQ(seen(bench), "stopped+stop tripped");
}

TEST(GuardState, PermitsASnapshotUpToItsAgeOnce) {
    for (const auto& [age_us, is_permitted] :
         {std::pair<std::int64_t, bool>{-1, false}, {0, true}, {2999, true}, {3000, false}}) {
        Bench bench = in_phase(GuardPhase::armed);
        bench.snapshot(true, age_us);
        EXPECT_EQ(bench.out.sends_permit, is_permitted) << age_us;
    }
    Bench bench = in_phase(GuardPhase::armed);
    bench.snapshot();
    EXPECT_TRUE(bench.out.sends_permit);
    bench.snapshot();
    EXPECT_FALSE(bench.out.sends_permit) << "the second of one period";
    bench.deadline();
    EXPECT_FALSE(bench.out.sends_permit) << "by the timer";
    bench.snapshot();
    EXPECT_TRUE(bench.out.sends_permit);
}

TEST(GuardState, AnEvaluationOfAnotherPeriodIsNone) {
    Bench bench = in_phase(GuardPhase::armed);
    for (const std::uint32_t off : {1U, 2U, 0xffffffffU}) {
        bench.on({.kind = GuardEventKind::snapshot,
                  .is_proven = true,
                  .period = bench.guard.period - off,
                  .age_us = 0});
        EXPECT_FALSE(bench.out.sends_permit) << off;
    }
    bench.guard.period = 0xffffffffU;
    bench.good_period();
    EXPECT_EQ(bench.guard.period, 0U);
    bench.snapshot();
    EXPECT_TRUE(bench.out.sends_permit) << "the count of periods wraps";
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
            Bench bench = in_phase(GuardPhase::selftest);
            bench.deadline();  // the period in which loading ended counts as disturbed
            if (c.tested) {
                bench.on(GuardEventKind::tested);
            }
            if (c.heard) {
                bench.on(GuardEventKind::tx_ok);
            }
            for (int i = 0; i < c.good; ++i) {
                if (is_broken && i == c.good - 1) {
                    bench.deadline();  // one missed: the row begins again
                }
                bench.good_period();
            }
            const bool is_whole = !is_broken || c.good > 3;
            EXPECT_EQ(bench.guard.phase, is_whole ? c.wanted : GuardPhase::selftest)
                << c.tested << c.heard << c.good << is_broken;
        }
    }
    Bench bench = in_phase(GuardPhase::selftest);
    bench.on(GuardEventKind::tx_ok), bench.on(GuardEventKind::tested);
    bench.on(GuardEventKind::tx_fail);  // heard once, but not since
    for (int i = 0; i < 9; ++i) {
        bench.good_period();
    }
    EXPECT_EQ(bench.guard.phase, GuardPhase::selftest);
    bench.on(GuardEventKind::tx_ok), bench.good_period();
    EXPECT_EQ(bench.guard.phase, GuardPhase::ready);
}

TEST(GuardState, ResetNeedsTheBoardsWordAndAWholePeriodWithoutFault) {
    Bench bench = in_phase(GuardPhase::stopped);
    bench.deadline(), bench.deadline();
    bench.on(GuardEventKind::reset_edge);
    EXPECT_EQ(bench.guard.phase, GuardPhase::stopped) << "not confirmed";
    bench.on(GuardEventKind::board_ack);
    for (const auto fault : {GuardFault::input_noise, GuardFault::engine}) {
        bench.fault(fault);
        bench.on(GuardEventKind::reset_edge);
        EXPECT_EQ(bench.guard.phase, GuardPhase::stopped) << "fault in this period";
        bench.deadline();
        bench.on(GuardEventKind::reset_edge);
        EXPECT_EQ(bench.guard.phase, GuardPhase::stopped) << "fault in the last period";
    }
    bench.on(GuardEventKind::tx_fail), bench.deadline();
    bench.on(GuardEventKind::reset_edge);
    EXPECT_EQ(bench.guard.phase, GuardPhase::stopped) << "a frame failed in the last period";
    bench.deadline();
    bench.on(GuardEventKind::reset_edge);
    EXPECT_EQ(bench.guard.phase, GuardPhase::init);
    EXPECT_EQ(bench.guard.cause, GuardFault::none);
}

TEST(GuardState, TheStopIsRepeatedUntilTheBoardConfirmsThisStop) {
    Bench bench = in_phase(GuardPhase::armed);
    bench.on(GuardEventKind::board_ack);  // of nothing: it confirms no later stop
    bench.fault(GuardFault::verdict);
    EXPECT_TRUE(bench.out.sends_stop);
    for (int i = 0; i < 20; ++i) {
        bench.on(GuardEventKind::tx_fail);
        EXPECT_FALSE(bench.out.sends_stop) << "no storm of retries";
        bench.deadline();
        EXPECT_TRUE(bench.out.sends_stop);
    }
    bench.on(GuardEventKind::board_ack);
    bench.deadline();
    EXPECT_FALSE(bench.out.sends_stop);
}

TEST(GuardState, AStopOutlivesItsProcess) {
    Bench bench{start_guard(true), {}};
    EXPECT_EQ(bench.guard.cause, GuardFault::latched);
    bench.on(GuardEventKind::restart);
    EXPECT_EQ(seen(bench), "stopped+stop tripped");
    EXPECT_EQ(bench.guard.cause, GuardFault::latched);
    bench.on(GuardEventKind::loaded);
    bench.deadline();
    EXPECT_EQ(seen(bench), "stopped+stop tripped") << "until this board confirms again";
    Bench fresh{start_guard(false), {}};
    fresh.on(GuardEventKind::restart);
    EXPECT_EQ(seen(fresh), "init silent");
}

TEST(GuardState, ADisturbedPeriodHadItsPermitAndIsNoSilence) {
    Bench bench = in_phase(GuardPhase::armed);
    miss(bench, 2);
    bench.fault(GuardFault::input_noise), bench.good_period();
    bench.good_period(), bench.good_period();  // the leaky count has room again
    EXPECT_EQ(bench.guard.phase, GuardPhase::armed);
    Bench other = in_phase(GuardPhase::armed);
    miss(other, 1);
    other.fault(GuardFault::input_noise), other.good_period();
    miss(other, 1);
    EXPECT_EQ(other.guard.phase, GuardPhase::armed) << "two missed, not in a row";
    EXPECT_EQ(other.guard.silent, 1U);
}

TEST(GuardState, AResetForgetsAllEvidence) {
    Bench bench = in_phase(GuardPhase::armed);
    miss(bench, 2);  // half the leaky count
    bench.fault(GuardFault::input);
    bench.on(GuardEventKind::board_ack), bench.deadline(), bench.deadline();
    EXPECT_EQ(bench.guard.bad + bench.guard.good + bench.guard.silent, 0U);
    bench.on(GuardEventKind::reset_edge), bench.on(GuardEventKind::loaded);
    for (int i = 0; i < 9; ++i) {
        bench.good_period();
    }
    EXPECT_EQ(bench.guard.phase, GuardPhase::selftest) << "no self-test, no own frame since";
    bench.on(GuardEventKind::tested), bench.good_period();
    EXPECT_EQ(bench.guard.phase, GuardPhase::selftest) << "no own frame since";
    bench.on(GuardEventKind::tx_ok), bench.good_period();
    EXPECT_EQ(bench.guard.phase, GuardPhase::ready);
}

TEST(GuardState, TheCauseIsTheFirstOneAndHasItsName) {
    const auto cause_after = [](void (*events)(Bench&)) {
        Bench bench = in_phase(GuardPhase::armed);
        events(bench);
        bench.fault(GuardFault::engine);  // later: changes nothing
        return bench.guard.cause;
    };
    EXPECT_EQ(cause_after([](Bench& b) { miss(b, 3); }), GuardFault::silence);
    EXPECT_EQ(cause_after([](Bench& b) { b.on(GuardEventKind::tx_fail); }), GuardFault::output);
    EXPECT_EQ(cause_after([](Bench& b) { b.fault(GuardFault::gap); }), GuardFault::gap);
    EXPECT_EQ(cause_after([](Bench& b) {
                  for (int i = 0; i < 4; ++i) {
                      b.fault(GuardFault::recorder), b.good_period();
                  }
              }),
              GuardFault::flapping);
}

TEST(GuardState, OneBadPeriodInFourIsBorneForEverOneInThreeIsNot) {
    for (const bool is_missed : {false, true}) {
        for (const int every : {4, 3}) {
            Bench bench = in_phase(GuardPhase::armed);
            for (int i = 0; i < 1000; ++i) {
                if (i % every != 0) {
                    bench.good_period();
                } else if (is_missed) {
                    bench.deadline();
                } else {
                    bench.fault(GuardFault::input_noise), bench.good_period();
                }
            }
            EXPECT_EQ(bench.guard.phase, every == 4 ? GuardPhase::armed : GuardPhase::stopped);
        }
    }
}

TEST(GuardState, TheMonitorsCycleIsItsEvent) {
    CycleResult cycle;
    cycle.has_permit = true;
    const GuardEvent proven = guard_event_of(cycle, 7, 800);
    EXPECT_EQ(proven.kind, GuardEventKind::snapshot);
    EXPECT_TRUE(proven.is_proven);
    EXPECT_EQ(proven.period, 7U);
    EXPECT_EQ(proven.age_us, 800);
    cycle.has_permit = false;
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::snapshot);
    cycle.reason = StopReason::predicted;  // not proven before the first permit: withheld
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::snapshot);
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    cycle.has_permit = true;  // which the monitor never says beside a reason
    EXPECT_FALSE(guard_event_of(cycle, 7, 800).is_proven);
    cycle.stops_now = true;
    EXPECT_EQ(guard_event_of(cycle, 7, 800).kind, GuardEventKind::fault);
    EXPECT_EQ(guard_event_of(cycle, 7, 800).fault, GuardFault::verdict);
}

TEST(GuardState, EveryNameIsItsOwn) {
    std::set<std::string> names;
    for (int i = 0; i <= static_cast<int>(GuardFault::latched); ++i) {
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
