// SPDX-License-Identifier: Apache-2.0
// The test of a board, played to simulated ones on a simulated bus with a clock of its own. A board
// that keeps every rule passes all; of boards that break one rule each, the rule is named.
// ctest-labels: rare firmware_if.board
#include "firmware_if/board_test/board_player.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "firmware_if/board_test/board_report.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "hil_replay/board/can_bus.hpp"
#include "tests/support/bench_board.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

using test::BenchBoard;
using test::BenchOptions;
using test::Broken;

constexpr std::int64_t kEndUs = 600'000'000;

Machine bench_machine(std::uint8_t permit_samples = 8) {
    Machine machine = motion_test_machine();
    machine.can.permit_samples = {permit_samples, permit_samples};
    machine.can.hashes_in_id = 0x582;
    machine.can.hashes_out_id = 0x602;
    machine.can.stale_after_us = 10'000;
    return machine;
}

constexpr ConfigurationHashes kHashes{{0x11111111, 0x22222222, 0x33333333, 0x44444444}};

struct Bench {
    Machine machine;
    BoardTestOptions test;
    BenchOptions board;
    std::int64_t late_us = 0;  // this computer sends its frames so late
    bool has_person = true;
    std::int64_t person_us = 80'000;   // from being asked to arming
    std::int64_t foreign_stop_us = 0;  // another sender sends a stop frame then; 0: none does
    std::int64_t interrupted_us = 0;   // by a signal; 0: never
};

Bench bench_of(Broken broken, bool has_cap, std::uint8_t permit_samples = 8) {
    Bench bench{.machine = bench_machine(permit_samples),
                .test = {.hashes = kHashes, .has_jog = true},
                .board = {.broken = broken, .hashes = kHashes, .has_cap = has_cap}};
    bench.test.cap = has_cap ? CapPromise::all_axes : CapPromise::none;
    return bench;
}

BoardTestResult play(const Bench& bench) {
    BusOptions wire;
    wire.period_us = bench.machine.can.sample_us;
    CanBus bus(wire);
    BenchBoard board(bench.machine, bench.board);
    BoardPlayer player(bench.machine, bench.test);
    std::int64_t now_us = 0, asked_us = 0;
    std::int64_t foreign_stop_us = bench.foreign_stop_us;
    bool has_armed = false;
    const auto send = [&] {
        for (CanFrame frame; player.take(now_us, frame);) {
            frame.time_us += bench.late_us;
            bus.post(BusNode::guard, frame);
        }
    };
    while (!player.is_over() && now_us < kEndUs) {
        const std::int64_t latch_us = board.next_latch_us();
        while (now_us < latch_us) {
            const std::int64_t due_us = std::max(now_us + 1, player.next_due_us());
            const std::int64_t until_us = std::min(latch_us, due_us);
            CanBus::Delivery delivery;
            if (bus.next(until_us, delivery)) {
                now_us = std::max(now_us, delivery.frame.time_us);
                if (delivery.sender == BusNode::guard) {
                    for (const CanFrame& answer : board.hear(delivery.frame)) {
                        bus.post(BusNode::board, answer);
                    }
                }
                player.on_frame(delivery.frame, delivery.sender == BusNode::guard);
            } else {
                now_us = until_us;
                player.on_time(now_us);
            }
            if (foreign_stop_us != 0 && now_us >= foreign_stop_us) {
                CanFrame stop = encode_stop(bench.machine.can, now_us);
                (void)board.hear(stop);
                player.on_frame(stop, false);
                foreign_stop_us = 0;
            }
            if (bench.interrupted_us != 0 && now_us >= bench.interrupted_us) {
                player.interrupt("interrupted");
            }
            send();
        }
        if (player.task() == PersonTask::nothing) {
            asked_us = now_us;
            has_armed = false;
        } else if (now_us - asked_us >= bench.person_us && !has_armed && bench.has_person) {
            has_armed = board.arm(player.task() == PersonTask::arm_jog);
        }
        for (const CanFrame& frame : board.latch()) {
            bus.post(BusNode::board, frame);
        }
    }
    EXPECT_TRUE(player.is_over());
    return player.result();
}

std::set<std::string> failed_rules(const BoardTestResult& result) {
    std::set<std::string> out;
    for (const BoardFinding& finding : result.findings) {
        if (finding.outcome == Outcome::failed) {
            out.insert(finding.name);
        }
    }
    return out;
}

void expect_all_pass(const Bench& bench) {
    const BoardTestResult result = play(bench);
    const BoardTestCounts counts = counts_of(result);
    EXPECT_EQ(counts.failed, 0U) << report_text(result);
    EXPECT_EQ(counts.unclear, 0U) << report_text(result);
    EXPECT_EQ(result.abandoned, "");
    EXPECT_GT(counts.passed, 35U) << report_text(result);
}

TEST(BoardTest, BoardThatKeepsEveryRulePasses) {
    expect_all_pass(bench_of(Broken::nothing, false));
}

TEST(BoardTest, BoardThatKeepsACapPasses) {
    expect_all_pass(bench_of(Broken::nothing, true));
}

TEST(BoardTest, ACapOfOneAxisIsJudgedByThatAxis) {
    Bench bench = bench_of(Broken::nothing, true);
    bench.test.cap = CapPromise::per_axis;
    expect_all_pass(bench);
}

TEST(BoardTest, ABoardWithShortPermitsPasses) {
    const BoardTestResult result = play(bench_of(Broken::nothing, false, 3));
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
    EXPECT_EQ(counts_of(result).unclear, 0U) << report_text(result);
}

TEST(BoardTest, AFlexibleBoardAtALongerPeriodPasses) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.machine.can.format = CanFormat::fd;
    bench.machine.can.axis_ids = {0x181};
    bench.machine.can.data_ids = {0x0181};
    bench.machine.can.sample_us = 2000;
    bench.machine.can.stale_after_us = 16'000;
    expect_all_pass(bench);
}

// The figures fit every stop together, so a board that keeps them is no better than this one.
TEST(BoardTest, TheMeasuredKeysAreThoseOfTheBoard) {
    const Bench bench = bench_of(Broken::nothing, false);
    const BoardTestResult result = play(bench);
    EXPECT_GT(result.stops.size(), 20U);
    EXPECT_GT(result.reaction_s, 0.8e-3);
    EXPECT_LE(result.reaction_s, 1.3e-3 + 50e-6);  // it looks at the clock every 50 us
    const std::string keys = machine_keys(bench.machine, result);
    EXPECT_NE(keys.find("board_reaction_ms: 1."), std::string::npos) << keys;
    EXPECT_NE(keys.find("  X: {stopping_mm_s2: 17"), std::string::npos) << keys;  // it has 1800
    const std::string json = describe_board_test(bench.machine, "can0", result);
    EXPECT_NE(json.find("\"name\": \"lapse\""), std::string::npos);
}

// Positions show a stop as late as they are old: one figure, less what the machine file states.
TEST(BoardTest, TheAgeOfPositionsIsInTheReaction) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.board.sends_old_values = true;
    EXPECT_EQ(failed_rules(play(bench)).count("lapse"), 1U) << "2.3 ms, and 2 ms are allowed";
    bench.machine.can.latched_age = {1000, 1000};
    const BoardTestResult result = play(bench);
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
    EXPECT_GT(result.reaction_s, 1.8e-3);
    EXPECT_LE(result.reaction_s, 2.3e-3 + 50e-6);
    const std::string keys = machine_keys(bench.machine, result);
    EXPECT_NE(keys.find("the age of the positions, less 1000 us of can.latched_age_us.\n"),
              std::string::npos)
        << keys;
    EXPECT_NE(keys.find("board_reaction_ms: 1."), std::string::npos) << keys;
    EXPECT_NE(report_text(result).find(", with the age of the positions"), std::string::npos);
}

TEST(BoardTest, AComputerThatSendsLateIsNoFaultOfTheBoard) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.late_us = 9000;
    const BoardTestResult result = play(bench);
    EXPECT_NE(result.abandoned.find("sent permits too late"), std::string::npos)
        << result.abandoned;
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
}

TEST(BoardTest, ABoardThatNobodyArmsEndsTheTest) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.has_person = false;
    bench.test.person_us_max = 2'000'000;
    const BoardTestResult result = play(bench);
    EXPECT_NE(result.abandoned.find("was not armed"), std::string::npos) << result.abandoned;
    EXPECT_GT(counts_of(result).unclear, 30U);
}

TEST(BoardTest, ABoardThatIsNotHomedIsToldSo) {
    const BoardTestResult result = play(bench_of(Broken::is_not_homed, false));
    EXPECT_NE(result.abandoned.find("reference"), std::string::npos) << result.abandoned;
}

TEST(BoardTest, OneCaseIsPlayedAfterThoseThatItBuildsUpon) {
    Bench bench = bench_of(Broken::takes_live_16, false);
    bench.test.only = "live_16";
    const BoardTestResult result = play(bench);
    EXPECT_EQ(failed_rules(result), std::set<std::string>{"live_16"}) << report_text(result);
    EXPECT_EQ(result.findings[1].outcome, Outcome::passed);
    EXPECT_EQ(result.findings[2].outcome, Outcome::not_tested);
}

struct Fault {
    Broken broken;
    const char* name;
    std::set<std::string> found;  // exactly these rules
    bool has_cap = false;
};

void PrintTo(const Fault& fault, std::ostream* out) {
    *out << fault.name;
}

class BrokenBoardTest : public testing::TestWithParam<Fault> {};

TEST_P(BrokenBoardTest, IsFoundAndNamed) {
    const Fault& fault = GetParam();
    const BoardTestResult result = play(bench_of(fault.broken, fault.has_cap));
    EXPECT_EQ(failed_rules(result), fault.found) << result.abandoned << '\n' << report_text(result);
}

const Fault kFaults[] = {
    {Broken::ends_from_arrival, "ends_from_arrival", {"late", "old_echo"}},
    {Broken::newest_end, "newest_end", {"earlier_end"}},
    {Broken::takes_old_echo, "takes_old_echo", {"old_echo"}},
    {Broken::takes_any_echo, "takes_any_echo", {"wrong_echo"}},
    {Broken::takes_any_lap, "takes_any_lap", {"wrong_lap"}},
    {Broken::takes_any_nonce, "takes_any_nonce", {"wrong_nonce"}},
    {Broken::takes_former_nonce, "takes_former_nonce", {"former_nonce"}},
    {Broken::takes_any_answer, "takes_any_answer", {"three_in_a_row", "wrong_answer"}},
    {Broken::takes_live_again, "takes_live_again", {"live_repeated"}},
    {Broken::takes_live_16, "takes_live_16", {"live_16"}},
    {Broken::live_window_of_3, "live_window_of_3", {"live_15"}},
    {Broken::ignores_inverted,
     "ignores_inverted",
     {"twin_alone", "twin_differs", "twin_late", "twin_missing", "twin_of_another", "two_senders"}},
    {Broken::takes_either_order, "takes_either_order", {"twin_alone"}},
    {Broken::takes_one_bit, "takes_one_bit", {"twin_differs"}},
    {Broken::takes_twin_of_another,
     "takes_twin_of_another",
     {"twin_alone", "twin_of_another", "two_senders"}},
    {Broken::takes_late_twin, "takes_late_twin", {"twin_late"}},
    {Broken::takes_interleaved, "takes_interleaved", {"two_senders"}},
    {Broken::takes_short_frames, "takes_short_frames", {"shape"}},
    {Broken::takes_any_word, "takes_any_word", {"word"}},
    {Broken::takes_cap_251, "takes_cap_251", {"cap_251"}},
    {Broken::takes_level_4, "takes_level_4", {"level_4"}},
    {Broken::takes_samples_0, "takes_samples_0", {"samples_0"}},
    {Broken::takes_samples_above, "takes_samples_above", {"samples_above"}},
    {Broken::refuses_slow, "refuses_slow", {"slow_word"}},
    {Broken::runs_on_jog, "runs_on_jog", {"jog_word"}},
    {Broken::jogs_on_run, "jogs_on_run", {"run_in_jog"}},
    {Broken::moves_on_first_permit, "moves_on_first_permit", {"three_in_a_row"}},
    {Broken::moves_without_hashes, "moves_without_hashes", {"hashes"}},
    {Broken::answers_wrong_hash, "answers_wrong_hash", {"hash_answers"}},
    {Broken::ignores_stop_frame, "ignores_stop_frame", {"long_stop_frame", "stop_frame"}},
    {Broken::ignores_long_stop_frame, "ignores_long_stop_frame", {"long_stop_frame"}},
    {Broken::ignores_stop_word, "ignores_stop_word", {"stop_word"}},
    {Broken::ends_do_not_latch, "ends_do_not_latch", {"gap", "resume", "stop_word"}},
    {Broken::resumes_by_itself, "resumes_by_itself", {"resume"}},
    {Broken::arms_by_itself, "arms_by_itself", {"new_nonce", "resume"}},
    {Broken::keeps_nonce, "keeps_nonce", {"new_nonce"}},
    {Broken::reacts_late, "reacts_late", {"lapse"}},
    {Broken::brakes_softly, "brakes_softly", {"lapse"}},
    {Broken::turns_round, "turns_round", {"braking"}},
    {Broken::session_is_rare, "session_is_rare", {"session"}},
    {Broken::loses_samples, "loses_samples", {"samples"}},
    {Broken::period_is_long, "period_is_long", {"samples"}},
    {Broken::says_it_stands, "says_it_stands", {"mode"}},
    {Broken::acks_without_promise, "acks_without_promise", {"ack"}},
    {Broken::acks_at_once, "acks_at_once", {"ack", "cap", "hold"}, true},
    {Broken::never_acks, "never_acks", {"cap", "hold"}, true},
    {Broken::hold_is_a_stop, "hold_is_a_stop", {"hold"}, true},
    {Broken::changes_tool_early, "changes_tool_early", {"tool_change"}},
    {Broken::changes_tool_in_stop, "changes_tool_in_stop", {"tool_change"}},
    {Broken::moves_another_axis, "moves_another_axis", {"braking"}},
    {Broken::jerks_another_axis, "jerks_another_axis", {"braking"}},
    {Broken::creeps_on_another, "creeps_on_another", {"braking"}},
    {Broken::moves_later, "moves_later", {"resume"}},
    {Broken::moves_after_the_last, "moves_after_the_last", {"resume"}},
    {Broken::moves_without_arming, "moves_without_arming", {"braking"}},
    {Broken::never_rests, "never_rests", {"braking"}},
};
INSTANTIATE_TEST_SUITE_P(BoardTest, BrokenBoardTest, testing::ValuesIn(kFaults),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(BoardTest, ABoardThatMovesWhileThePersonWalksOverHasResumed) {
    Bench bench = bench_of(Broken::resumes_later, false);
    bench.person_us = 8'000'000;
    const BoardTestResult result = play(bench);
    EXPECT_EQ(failed_rules(result), std::set<std::string>{"resume"}) << report_text(result);
}

TEST(BoardTest, APersonMayTakeLong) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.person_us = 30'000'000;
    bench.test.only = "gap";
    const BoardTestResult result = play(bench);
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
    EXPECT_EQ(result.abandoned, "");
}

TEST(BoardTest, AnInterruptedTestStopsTheBoardAndKeepsWhatItFound) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.interrupted_us = 6'000'000;
    const BoardTestResult result = play(bench);
    EXPECT_EQ(result.abandoned, "interrupted");
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
    EXPECT_EQ(result.findings[1].outcome, Outcome::passed);
    EXPECT_GT(counts_of(result).unclear, 20U);
}

TEST(BoardTest, AStopFrameOfAnotherSenderEndsTheTest) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.foreign_stop_us = 1'000'000;
    const BoardTestResult result = play(bench);
    EXPECT_NE(result.abandoned.find("stop frame 0x001"), std::string::npos) << result.abandoned;
    EXPECT_EQ(failed_rules(result), std::set<std::string>{}) << report_text(result);
}

Outcome outcome_of(const BoardTestResult& result, const std::string& name) {
    for (const BoardFinding& finding : result.findings) {
        if (finding.name == name) {
            return finding.outcome;
        }
    }
    return Outcome::unclear;
}

TEST(BoardTest, WhatWasNeverSeenIsNotTested) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.machine.can.hashes_in_id = bench.machine.can.hashes_out_id = 0;
    bench.test.only = "gap";
    const BoardTestResult result = play(bench);
    EXPECT_EQ(outcome_of(result, "hash_answers"), Outcome::not_tested);
    EXPECT_EQ(outcome_of(result, "ack"), Outcome::not_tested);
    EXPECT_EQ(outcome_of(result, "gap"), Outcome::passed);
}

TEST(BoardTest, ACaseThatCannotBePlayedIsSaidAtOnce) {
    Bench bench = bench_of(Broken::nothing, false);
    bench.test.has_jog = false;
    for (const char* const name : {"cap", "hold", "jog", "run_in_jog"}) {
        bench.test.only = name;
        EXPECT_NE(BoardPlayer(bench.machine, bench.test).unplayed(), "") << name;
    }
    bench.test.only = "gap";
    EXPECT_EQ(BoardPlayer(bench.machine, bench.test).unplayed(), "");
}

// A board that never ends its motion: every stop but the guard's own goes on.
TEST(BoardTest, ABoardThatGoesOnAfterTheEndIsFoundFirstOfAll) {
    const BoardTestResult result = play(bench_of(Broken::goes_on_after_end, false));
    EXPECT_EQ(failed_rules(result).count("lapse"), 1U) << report_text(result);
}

TEST(BoardTest, ABoardThatCountsNoLapsIsFound) {
    const BoardTestResult result = play(bench_of(Broken::counts_no_laps, false));
    EXPECT_EQ(failed_rules(result).count("session"), 1U) << report_text(result);
}

}  // namespace
}  // namespace axg
