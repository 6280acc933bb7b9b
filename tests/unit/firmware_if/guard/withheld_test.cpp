// SPDX-License-Identifier: Apache-2.0
// What keeps a guard from ready before it is armed is no stop. It is said all the same, with the
// pair: a person who sees "selftest" alone does not know where the machine stands too near.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "firmware_if/axguardd/format_note.hpp"
#include "tests/support/live_world.hpp"

namespace axg {
namespace {

class Withheld : public testing::Test {
  protected:
    Withheld() {
        world.verdict = [this](std::uint64_t) {
            return reason == StopReason::none
                       ? CycleResult{.has_permit = true,
                                     .known_answer_signature = kKnownAnswerSignature}
                       : CycleResult{.reason = reason, .pair = pair};
        };
    }
    void run_us(std::int64_t us) { world.run_until(world.wire.now_us + us); }
    /// Since the last call.
    std::vector<LiveNote> told() {
        std::vector<LiveNote> notes;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            if (note.kind == LiveNote::Kind::withheld) {
                notes.push_back(note);
            }
        }
        return notes;
    }
    GuardPhase phase() const { return world.guard->guard().phase; }

    StopReason reason = StopReason::predicted;
    std::uint32_t pair = 4;
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
};

TEST_F(Withheld, ThePairIsSaidOnceAfterASecond) {
    run_us(900'000);
    EXPECT_TRUE(told().empty()) << "the first samples after a start say little";
    run_us(200'000);
    const std::vector<LiveNote> first = told();
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].phase, GuardPhase::selftest);
    EXPECT_EQ(first[0].reason, StopReason::predicted);
    EXPECT_EQ(first[0].pair, 4U);
    EXPECT_EQ(world.guard->pair(), kNoIndex) << "no stop";
    run_us(3'000'000);
    EXPECT_TRUE(told().empty()) << "the same pair";
    pair = 5;
    run_us(10'000);
    EXPECT_EQ(told().size(), 1U) << "another one";
}

TEST_F(Withheld, PairsThatTakeTurnsMakeALineASecond) {
    for (std::uint32_t i = 0; i < 6000; ++i) {
        pair = 5 + i % 2;
        run_us(500);
    }
    const std::size_t count = told().size();
    EXPECT_GE(count, 1U);
    EXPECT_LE(count, 3U);
}

TEST_F(Withheld, ReadyInBetweenItIsSaidAgain) {
    run_us(1'100'000);
    EXPECT_EQ(told().size(), 1U);
    reason = StopReason::none;
    world.run_periods(40);
    ASSERT_EQ(phase(), GuardPhase::ready);
    EXPECT_TRUE(told().empty());
    reason = StopReason::predicted;
    run_us(1'100'000);
    EXPECT_EQ(told().size(), 1U);
    EXPECT_EQ(phase(), GuardPhase::selftest);
}

TEST_F(Withheld, NothingIsSaidOfAnArmedGuard) {
    reason = StopReason::none;
    world.run_to_armed();
    world.verdict = [](std::uint64_t sample) {
        return sample % 20 == 0 ? CycleResult{.reason = StopReason::predicted, .pair = 1}
                                : CycleResult{.has_permit = true};
    };
    run_us(3'000'000);
    EXPECT_TRUE(told().empty());
    EXPECT_EQ(phase(), GuardPhase::armed);
}

TEST_F(Withheld, TheLineNamesTheBodies) {
    Machine machine = world.machine;
    machine.bodies.resize(3);
    machine.bodies[0].name = "frame";
    machine.bodies[1].name = "cutter";
    machine.bodies[2].name = "c";
    machine.pairs = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
    LiveNote note{.kind = LiveNote::Kind::withheld,
                  .time_us = 12'000'345,
                  .phase = GuardPhase::selftest,
                  .reason = StopReason::predicted,
                  .pair = 1};
    std::array<char, 400> line{};
    const auto words = [&] { return std::string(line.data(), format_note(note, machine, line)); };
    EXPECT_EQ(words(),
              "12.000345 withheld: predicted: cutter - c; not proven at this position: jog away, "
              "or move the machine by hand\n");
    note.pair = kNoIndex;
    note.reason = StopReason::left_path;
    EXPECT_EQ(words(),
              "12.000345 withheld: left_path; not proven at this position: jog away, or move the "
              "machine by hand\n");
    note.reason = StopReason::left_limits;
    EXPECT_EQ(words(),
              "12.000345 withheld: left_limits; an axis exceeded a declared limit, see the line "
              "left_limits\n");
    note.kind = LiveNote::Kind::phase;
    note.phase = GuardPhase::stopped;
    note.cause = GuardFault::verdict;
    note.reason = StopReason::contact;
    note.pair = 1;
    EXPECT_EQ(words().substr(0, 47), "12.000345 stopped: verdict: contact: cutter - c");
    note.reason = StopReason::tool;
    note.pair = kNoIndex;
    EXPECT_EQ(words(),
              "12.000345 stopped: verdict: tool; the machine file does not have it: add it under "
              "tools; load another tool to go on; when the machine is at rest and the cause is "
              "removed, reset with kill -USR2\n");
}

}  // namespace
}  // namespace axg
