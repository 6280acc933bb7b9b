// SPDX-License-Identifier: Apache-2.0
// The live guard and a control panel made of the board's library: what is confirmed resets and
// arms, everything else is refused, counted and said, and changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware_if/axguardd/format_note.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/operator_panel.hpp"

namespace axg {
namespace {

using test::status_in;

class GuardOperator : public testing::Test {
  protected:
    GuardOperator() { begin(); }
    /// As deployed: the board stands, and a person arms.
    void begin() {
        world.options = {};
        world.stands_still = true;
        world.start();
    }
    void run_to_ready() {
        world.run_periods(300);
        ASSERT_EQ(phase(), GuardPhase::ready) << to_text(world.guard->guard().cause);
    }
    void run_to_stopped() {
        run_to_ready();
        world.guard->arm(now_us());
        ASSERT_EQ(phase(), GuardPhase::armed);
        world.guard->report(GuardFault::refused, now_us());
        world.run_periods(300);
        ASSERT_EQ(phase(), GuardPhase::stopped);
        ASSERT_TRUE(world.guard->guard().is_confirmed);
    }
    /// X begins to move at 20 mm/s, and the board says so.
    void creep() {
        const std::int64_t from_us = now_us();
        world.says = [from_us](AxisSnapshot& snapshot) {
            snapshot.position[0] += 20e-6 * static_cast<double>(snapshot.latched_us - from_us);
            snapshot.mode = kModeMoving;
        };
    }
    void arrive(const CanFrame& frame, std::int64_t periods = 20) {
        said.push_back(frame);
        world.wire.arrive(frame);
        world.run_periods(periods);
    }
    void ask(axg_operator_action action) { arrive(panel.request(action, now_us())); }
    void confirm(axg_operator_action action, std::uint32_t nonce) {
        arrive(panel.confirm(action, nonce, now_us()));
    }
    std::vector<CanFrame> statuses(std::int64_t from_us = 0) const {
        std::vector<CanFrame> found;
        std::copy_if(world.wire.sent.begin(), world.wire.sent.end(), std::back_inserter(found),
                     [from_us](const CanFrame& frame) {
                         return frame.id == 0x604 && frame.time_us >= from_us;
                     });
        return found;
    }
    axg_operator_status status() const {
        const auto all = statuses();
        const auto read = all.empty() ? std::nullopt : status_in(all.back());
        EXPECT_TRUE(read);
        return read.value_or(axg_operator_status{});
    }
    /// The lines about operators since the last look.
    std::vector<std::string> lines() {
        std::vector<std::string> words;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            if (note.frame_id == 0x584) {
                EXPECT_TRUE(note.kind == LiveNote::Kind::person ||
                            note.kind == LiveNote::Kind::refused)
                    << "no fault of the bus";
                words.emplace_back(note.words);
                std::array<char, 400> line{};
                logged.assign(line.data(), format_note(note, world.machine, line));
            }
        }
        return words;
    }
    GuardPhase phase() const { return world.guard->guard().phase; }
    std::int64_t now_us() const { return world.wire.now_us; }
    const LiveCounters& counters() const { return world.guard->counters(); }
    /// A confirmation that would act, so that nothing but what a test alters keeps it from that.
    CanFrame good_confirmation() {
        ask(AXG_OPERATOR_ARM);
        EXPECT_EQ(status().action, AXG_OPERATOR_ARM);
        return panel.confirm(AXG_OPERATOR_ARM, status().nonce, now_us());
    }
    void expect_refused(axg_operator_refusal refusal, const char* words) {
        EXPECT_EQ(phase(), GuardPhase::ready);
        EXPECT_EQ(status().refusal, refusal);
        EXPECT_EQ(status().nonce, 0U);
        EXPECT_EQ(counters().operator_refused, 1U);
        EXPECT_EQ(counters().operator_acts, 0U);
        EXPECT_EQ(lines(), std::vector<std::string>{words});
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{test::five_axis_machine(CanFormat::classical), latch};
    test::OperatorPanel panel;
    std::vector<CanFrame> said;
    std::string logged;  // the last of those lines, as the log has it
};

TEST_F(GuardOperator, ArmsWhenWhatWasAskedForIsConfirmed) {
    run_to_ready();
    EXPECT_EQ(status().phase, 3);
    ask(AXG_OPERATOR_ARM);
    EXPECT_EQ(phase(), GuardPhase::ready) << "a request does nothing";
    EXPECT_NE(status().nonce, 0U);
    confirm(AXG_OPERATOR_ARM, status().nonce);
    EXPECT_EQ(phase(), GuardPhase::armed);
    EXPECT_EQ(status().phase, 4);
    EXPECT_EQ(status().nonce, 0U);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_NOTHING);
    EXPECT_EQ(counters().operator_acts, 1U);
    EXPECT_EQ(lines(), std::vector<std::string>{"an operator arms"});
    EXPECT_NE(logged.find(" an operator arms (584)\n"), std::string::npos) << logged;
    EXPECT_GT(world.count_sent(0x103), 0U) << "permits";
}

TEST_F(GuardOperator, ResetsAStopAndThenArms) {
    run_to_stopped();
    EXPECT_EQ(status().phase, 0);
    ask(AXG_OPERATOR_RESET);
    EXPECT_EQ(phase(), GuardPhase::stopped);
    EXPECT_TRUE(is_latched(latch));
    confirm(AXG_OPERATOR_RESET, status().nonce);
    EXPECT_FALSE(is_latched(latch));
    world.run_periods(300);
    EXPECT_EQ(phase(), GuardPhase::ready);
    EXPECT_EQ(lines(), std::vector<std::string>{"an operator resets"});
    ask(AXG_OPERATOR_ARM);
    confirm(AXG_OPERATOR_ARM, status().nonce);
    EXPECT_EQ(phase(), GuardPhase::armed);
}

TEST_F(GuardOperator, IsRefusedWhileAnAxisMoves) {
    world.stands_still = false;
    run_to_ready();
    ask(AXG_OPERATOR_ARM);
    expect_refused(AXG_OPERATOR_REFUSED_MOVES, "arm: the axes are not at rest");
}

TEST_F(GuardOperator, IsRefusedWhenAnAxisMovesBetweenRequestAndConfirmation) {
    run_to_ready();
    const CanFrame good = good_confirmation();
    creep();
    world.run_periods(20);
    CanFrame later = good;
    later.time_us = now_us();
    arrive(later);
    expect_refused(AXG_OPERATOR_REFUSED_MOVES, "arm: the axes are not at rest");
}

TEST_F(GuardOperator, AResetIsRefusedWhileAnAxisMoves) {
    run_to_stopped();
    creep();
    world.run_periods(20);
    ask(AXG_OPERATOR_RESET);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_MOVES);
    EXPECT_EQ(phase(), GuardPhase::stopped);
    EXPECT_EQ(lines(), std::vector<std::string>{"reset: the axes are not yet at rest"});
}

TEST_F(GuardOperator, AResetIsRefusedWhileTheCauseRemains) {
    run_to_stopped();
    world.each_step = [this] { world.guard->report(GuardFault::engine, now_us()); };
    ask(AXG_OPERATOR_RESET);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_CAUSE);
    EXPECT_EQ(status().nonce, 0U);
    EXPECT_EQ(lines(), std::vector<std::string>{"reset: a fault is still present"});
    world.each_step = nullptr;
    ask(AXG_OPERATOR_RESET);
    world.each_step = [this] { world.guard->report(GuardFault::engine, now_us()); };
    world.run_periods(3);
    confirm(AXG_OPERATOR_RESET, status().nonce);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_CAUSE) << "it came back in between";
    EXPECT_EQ(phase(), GuardPhase::stopped);
}

TEST_F(GuardOperator, EachActionIsRefusedInTheOtherPhases) {
    run_to_ready();
    ask(AXG_OPERATOR_RESET);
    expect_refused(AXG_OPERATOR_REFUSED_PHASE, "reset: nothing is latched");
    ask(AXG_OPERATOR_ARM);
    confirm(AXG_OPERATOR_ARM, status().nonce);
    ASSERT_EQ(phase(), GuardPhase::armed);
    for (const auto action : {AXG_OPERATOR_ARM, AXG_OPERATOR_RESET}) {
        ask(action);
        EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_PHASE);
        confirm(action, status().nonce);
        EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_PHASE);
        EXPECT_EQ(phase(), GuardPhase::armed);
    }
    world.guard->report(GuardFault::refused, now_us());
    world.run_periods(300);
    ask(AXG_OPERATOR_ARM);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_PHASE);
    EXPECT_EQ(phase(), GuardPhase::stopped);
}

TEST_F(GuardOperator, ArmingIsRefusedDuringTheSelfTest) {
    world.run_periods(8);
    ASSERT_EQ(phase(), GuardPhase::selftest);
    arrive(panel.request(AXG_OPERATOR_ARM, now_us()), 2);
    EXPECT_EQ(phase(), GuardPhase::selftest);
    EXPECT_EQ(counters().operator_refused, 1U);
    EXPECT_EQ(lines(), std::vector<std::string>{"arm: the guard is not ready"});
}

TEST_F(GuardOperator, AWrongNonceIsRefused) {
    run_to_ready();
    ask(AXG_OPERATOR_ARM);
    confirm(AXG_OPERATOR_ARM, status().nonce ^ 0x800000U);
    expect_refused(AXG_OPERATOR_REFUSED_NONCE, "arm: confirmed with a wrong nonce");
    EXPECT_NE(logged.find(" rejected: arm: confirmed with a wrong nonce (584)\n"),
              std::string::npos)
        << logged;
}

TEST_F(GuardOperator, AnotherActionThanTheOneAskedForIsRefused) {
    run_to_stopped();
    ask(AXG_OPERATOR_RESET);
    const std::uint32_t nonce = status().nonce;
    confirm(AXG_OPERATOR_ARM, nonce);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_PHASE);
    confirm(AXG_OPERATOR_RESET, nonce);
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_NONCE) << "it was used up";
    EXPECT_EQ(phase(), GuardPhase::stopped);
}

TEST_F(GuardOperator, ALateConfirmationIsRefused) {
    run_to_ready();
    const CanFrame good = good_confirmation();
    world.run_periods(5001);
    EXPECT_EQ(status().nonce, 0U) << "the status says that nothing waits any more";
    CanFrame late = good;
    late.time_us = now_us();
    arrive(late);
    expect_refused(AXG_OPERATOR_REFUSED_TOO_LATE, "arm: confirmed later than 5 s");
}

TEST_F(GuardOperator, ARepeatedCounterIsIgnored) {
    run_to_ready();
    const CanFrame good = good_confirmation();
    test::OperatorPanel stuck{.counter = static_cast<std::uint8_t>((panel.counter + 14) & 15U)};
    arrive(stuck.confirm(AXG_OPERATOR_ARM, status().nonce, now_us()));
    EXPECT_EQ(phase(), GuardPhase::ready);
    EXPECT_EQ(counters().operator_ignored, 1U);
    EXPECT_EQ(lines(),
              std::vector<std::string>{"an operator message whose counter did not advance by 1"});
    EXPECT_NE(status().nonce, 0U) << "and what waits, waits on";
    CanFrame next = good;
    next.time_us = now_us();
    arrive(next);
    EXPECT_EQ(phase(), GuardPhase::armed) << "it was the counter alone";
}

TEST_F(GuardOperator, AFrameWithAFlippedBitIsIgnored) {
    run_to_ready();
    const CanFrame good = good_confirmation();
    for (unsigned bit = 0; bit < 64; ++bit) {
        CanFrame bad = good;
        bad.time_us = now_us();
        bad.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        arrive(bad, 1);
        ASSERT_EQ(phase(), GuardPhase::ready) << bit;
    }
    EXPECT_EQ(counters().operator_ignored, 64U);
    EXPECT_EQ(lines(), std::vector<std::string>{"a frame that is not an operator message"})
        << "one line a second";
    CanFrame next = good;
    next.time_us = now_us();
    arrive(next);
    EXPECT_EQ(phase(), GuardPhase::armed) << "it was the bit alone";
}

TEST_F(GuardOperator, ARecordingOfAnArmingArmsNothing) {
    run_to_ready();
    ask(AXG_OPERATOR_ARM);
    confirm(AXG_OPERATOR_ARM, status().nonce);
    ASSERT_EQ(phase(), GuardPhase::armed);
    const std::vector<CanFrame> recording = said;
    world.guard->report(GuardFault::refused, now_us());
    world.run_periods(300);
    world.guard->reset(now_us());
    world.run_periods(300);
    ASSERT_EQ(phase(), GuardPhase::ready);
    for (int lap = 0; lap < 40; ++lap) {  // its counters fit again every sixteenth message
        for (const CanFrame& frame : recording) {
            CanFrame again = frame;
            again.time_us = now_us();
            arrive(again, 3);
            ASSERT_EQ(phase(), GuardPhase::ready);
        }
    }
    // And where something steps the counter for it, the nonce is another one.
    for (int i = 0; i < 40; ++i) {
        OperatorMessage old;
        ASSERT_EQ(decode_operator_message(world.machine.can, recording[1], old), FrameStatus::ok);
        arrive(panel.request(AXG_OPERATOR_ARM, now_us()), 12);
        arrive(panel.confirm(AXG_OPERATOR_ARM, old.nonce, now_us()), 12);
        ASSERT_EQ(phase(), GuardPhase::ready);
    }
    EXPECT_EQ(counters().operator_acts, 1U);
}

TEST_F(GuardOperator, ARequestDoesNotOutliveItsStop) {
    run_to_stopped();
    ask(AXG_OPERATOR_RESET);
    const std::uint32_t nonce = status().nonce;
    world.guard->reset(now_us());
    world.run_periods(50);
    world.guard->report(GuardFault::refused, now_us());
    world.run_periods(300);
    ASSERT_EQ(phase(), GuardPhase::stopped);
    ASSERT_TRUE(world.guard->guard().is_confirmed);
    confirm(AXG_OPERATOR_RESET, nonce);
    EXPECT_EQ(phase(), GuardPhase::stopped) << "the person saw another stop";
    EXPECT_EQ(status().refusal, AXG_OPERATOR_REFUSED_NONCE);
}

TEST_F(GuardOperator, TheStatusLeavesEvery100MsAndAtEachChange) {
    run_to_ready();
    const std::int64_t from_us = now_us();
    world.run_periods(2000);
    const auto all = statuses(from_us);
    EXPECT_NEAR(static_cast<double>(all.size()), 20, 1);
    for (std::size_t i = 1; i < all.size(); ++i) {
        EXPECT_LE(all[i].time_us - all[i - 1].time_us, kOperatorStatusUs + 1000);
        EXPECT_EQ(status_in(all[i])->counter, (status_in(all[i - 1])->counter + 1) & 15);
    }
    const std::int64_t asked_us = now_us();
    arrive(panel.request(AXG_OPERATOR_ARM, asked_us), 12);
    ASSERT_FALSE(statuses(asked_us).empty());
    EXPECT_EQ(status_in(statuses(asked_us).front())->action, AXG_OPERATOR_ARM);
    EXPECT_LE(statuses(asked_us).front().time_us - asked_us, kOperatorStatusUsMin + 1000);
}

// A board gone wild with hashes of another machine.
TEST_F(GuardOperator, AWrongHashIsOneLineASecondOfEachPart) {
    world.machine.can.hashes_in_id = 0x582;
    world.machine.can.hashes_out_id = 0x602;
    world.start();
    world.run_periods(100);
    const auto wrong = [&](std::uint8_t part, int count) {
        for (int i = 0; i < count; ++i) {
            arrive(encode_hash(0x582, {.part = part, .hash = 0x12345678}, now_us()), 10);
        }
        std::size_t said_of_hashes = 0;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            said_of_hashes += note.kind == LiveNote::Kind::hashes ? 1U : 0U;
        }
        return said_of_hashes;
    };
    EXPECT_EQ(wrong(2, 30), 1U) << "30 in 0.3 s";
    EXPECT_EQ(phase(), GuardPhase::stopped);
    EXPECT_EQ(wrong(1, 30), 1U) << "another part is new";
    EXPECT_EQ(wrong(2, 200), 2U) << "and in 2 s more";
}

// A panel gone wild: the bus sees no more than 100 statuses a second, and the log a line of a kind.
TEST_F(GuardOperator, AFloodOfMessagesIsAnsweredAHundredTimesASecond) {
    run_to_ready();
    const std::int64_t from_us = now_us();
    for (int i = 0; i < 1000; ++i) {
        arrive(panel.request(i % 2 == 0 ? AXG_OPERATOR_ARM : AXG_OPERATOR_RESET, now_us()), 1);
    }
    EXPECT_LE(statuses(from_us).size(), 102U);
    EXPECT_EQ(counters().operator_refused, 500U);
    EXPECT_LE(lines().size(), 2U);
    EXPECT_EQ(phase(), GuardPhase::ready);
}

TEST_F(GuardOperator, AStatusOfAnotherSenderIsASecondGuard) {
    run_to_ready();
    CanFrame foreign = statuses().back();
    foreign.time_us = now_us();
    arrive(foreign, 2);
    EXPECT_EQ(phase(), GuardPhase::stopped);
    EXPECT_EQ(world.guard->guard().cause, GuardFault::second_guard);
}

TEST_F(GuardOperator, ExtendedAndRemoteFramesAreNoMessages) {
    run_to_ready();
    const CanFrame good = good_confirmation();
    for (int kind = 0; kind < 3; ++kind) {
        CanFrame other = good;
        other.time_us = now_us();
        (kind == 0 ? other.extended : kind == 1 ? other.remote : other.error) = true;
        arrive(other, 2);
        EXPECT_NE(phase(), GuardPhase::armed) << kind;
    }
    EXPECT_EQ(counters().operator_acts + counters().operator_refused, 0U);
}

TEST_F(GuardOperator, ItListensForMessagesAndItsOwnStatus) {
    std::array<std::uint32_t, kLiveIdsMax> ids{};
    std::uint32_t count = live_ids(world.machine, ids);
    std::set<std::uint32_t> heard(ids.begin(), ids.begin() + count);
    EXPECT_TRUE(heard.contains(0x584));
    EXPECT_TRUE(heard.contains(0x604));
    EXPECT_TRUE(is_guard_id(world.machine.can, 0x604));
    EXPECT_FALSE(is_guard_id(world.machine.can, 0x584));
    world.machine.can.format = CanFormat::signals;  // no sample counter
    count = live_ids(world.machine, ids);
    heard = {ids.begin(), ids.begin() + count};
    EXPECT_FALSE(heard.contains(0x584));
    EXPECT_FALSE(heard.contains(0x604));
    EXPECT_FALSE(is_guard_id(world.machine.can, 0x604));
}

}  // namespace
}  // namespace axg
