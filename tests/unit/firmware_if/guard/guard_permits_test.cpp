// SPDX-License-Identifier: Apache-2.0
// The permits of the live guard: what it sends is judged by the library for boards, and what
// the board says of its session is lost, held up or changed.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/board_fixture.hpp"
#include "tests/support/live_world.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNonce = 0xC0FFEE;

class GuardPermits : public testing::TestWithParam<CanFormat> {
  protected:
    static Machine machine_of(CanFormat format) {
        Machine machine = test::five_axis_machine(format);
        return machine;
    }
    const Guard& guard() const { return world.guard->guard(); }
    void arm() {
        world.run_to_armed();
        world.run_periods(50);
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    }
    std::vector<CanFrame> sent_with(std::uint32_t id, std::int64_t from_us = 0) const {
        std::vector<CanFrame> found;
        for (const CanFrame& frame : world.wire.sent) {
            if (frame.id == id && frame.time_us >= from_us) {
                found.push_back(frame);
            }
        }
        return found;
    }
    /// Nothing but permits of the word stop.
    void expect_no_permit(std::int64_t from_us) const {
        for (const CanFrame& frame : sent_with(0x103, from_us)) {
            EXPECT_EQ(frame.data[0], 0x5A) << frame.time_us - from_us;
        }
    }
    bool has_note(const char* words) {
        LiveNote note;
        bool found = false;
        while (world.queues->notes.pop(note)) {
            found = found || std::string(note.words).find(words) != std::string::npos;
        }
        return found;
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{machine_of(GetParam()), latch};
};

/// A board of the library on the wire of that world: it hears each frame when it is through.
struct JudgedBoard {
    explicit JudgedBoard(const test::LiveWorld& world) {
        (void)axg_board_power_up(&fixture.board, &fixture.options, 1, 0);
        (void)axg_board_arm(&fixture.board, kNonce, 500'000);
        std::uint32_t number = 0;
        for (const CanFrame& sent : world.wire.sent) {
            const std::int64_t heard_us = sent.time_us + world.wire.echo_us;
            for (; instant_of(number) <= heard_us; ++number) {
                EXPECT_TRUE(
                    fixture.latch_at(number, static_cast<std::uint64_t>(instant_of(number))));
            }
            axg_board_can_frame frame{};
            frame.id = sent.id;
            frame.length = sent.length_bytes;
            std::copy_n(sent.data.begin(), sent.length_bytes, frame.data);
            const axg_board_heard heard =
                axg_board_frame(&fixture.board, &frame, static_cast<std::uint64_t>(heard_us));
            permits += heard == AXG_BOARD_HEARD_PERMIT ? 1U : 0U;
            refused += heard == AXG_BOARD_HEARD_REFUSED ? 1U : 0U;
        }
    }
    static std::int64_t instant_of(std::uint32_t number) {
        return test::LiveWorld::kBeginUs + 1000 * std::int64_t{number};
    }
    test::BoardFixture fixture;
    std::size_t permits = 0, refused = 0;
};

TEST_P(GuardPermits, EveryPermitIsOneForABoardOfTheLibrary) {
    arm();
    world.run_periods(1000);
    const JudgedBoard board(world);
    EXPECT_GE(board.permits, 1045U);
    EXPECT_EQ(board.refused, 1U) << "the first one only begins the live counter";
    EXPECT_EQ(board.fixture.board.refused[AXG_BOARD_REFUSED_LIVE], 1U);
    for (const CanFrame& permit : sent_with(0x103)) {
        ASSERT_EQ(permit.data[5], 250);
        ASSERT_EQ(permit.data[6], 0);
        ASSERT_EQ(permit.data[7], 0x30) << "n is can.permit_samples";
    }
    EXPECT_EQ(world.count_sent(0x001), 0U);
}

TEST_P(GuardPermits, WithoutASessionItIsNotReady) {
    world.says_session = [](test::SessionSays&) { return false; };
    world.run_periods(1200);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
    EXPECT_TRUE(has_note("no session frame of the board"));
    EXPECT_EQ(world.guard->withheld().why, WithheldPermit::Why::session);
    EXPECT_FALSE(world.guard->has_said_session());
    world.says_session = [](test::SessionSays&) { return true; };
    world.run_periods(200);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_TRUE(world.guard->has_said_session());
}

TEST_P(GuardPermits, ItSaysWhyTheNewestSampleHasNoPermit) {
    using Why = WithheldPermit::Why;
    EXPECT_EQ(world.guard->withheld().why, Why::no_sample);
    world.run_periods(200);
    EXPECT_EQ(world.guard->withheld().why, Why::nothing);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_LT(world.guard->phase_us(), world.wire.now_us);
    world.verdict = [](std::uint64_t) {
        return CycleResult{.reason = StopReason::predicted, .pair = 3};
    };
    world.run_periods(10);
    EXPECT_EQ(world.guard->withheld().why, Why::not_proven);
    EXPECT_EQ(world.guard->withheld().reason, StopReason::predicted);
    EXPECT_EQ(world.guard->withheld().pair, 3U);
    world.response_us = 900;
    world.run_periods(10);
    EXPECT_EQ(world.guard->withheld().why, Why::late);
}

TEST_P(GuardPermits, ASessionThatEndsEndsThePermitsAfter300Ms) {
    arm();
    world.run_periods(150);
    std::int64_t said_us = 0;
    bool is_lost = false;
    world.says_session = [&](test::SessionSays&) {
        said_us = is_lost ? said_us : world.wire.now_us;
        return !is_lost;
    };
    world.run_periods(250);
    is_lost = true;
    world.run_until(said_us + 298'000);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    world.run_until(said_us + 310'000);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::silence);
    EXPECT_TRUE(has_note("no session frame of the board"));
    for (const CanFrame& permit : sent_with(0x103, said_us + 303'000)) {
        EXPECT_EQ(permit.data[0], 0x5A);
    }
}

TEST_P(GuardPermits, TwoLostSessionFramesAreBorne) {
    arm();
    int lost = 0;
    world.says_session = [&](test::SessionSays&) { return ++lost % 3 == 0; };
    world.run_periods(2000);
    EXPECT_GT(lost, 15);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
}

TEST_P(GuardPermits, ASessionOfAnotherLapIsAStop) {
    arm();
    const std::int64_t from_us = world.wire.now_us;
    world.says_session = [](test::SessionSays& says) {
        says.number += 240;
        return true;
    };
    world.run_periods(250);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::input);
    EXPECT_EQ(world.guard->receiver().stop_cause(), ReceiverFault::held_up);
    EXPECT_GE(world.count_sent(0x001, from_us), 1U);
}

TEST_P(GuardPermits, AfterAPersonArmedTheBoardItAnswersForTheNewNonce) {
    arm();
    world.says_session = [](test::SessionSays& says) {
        says.nonce = 7;
        return true;
    };
    world.run_periods(250);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    const CanFrame permit = sent_with(0x103).back();
    std::uint64_t sample = world.samples();
    while (sync_counter_of(sample) != permit.data[1]) {
        --sample;
    }
    const auto made = encode_permit(world.machine.can,
                                    {.word = PermitWord::run,
                                     .sync_counter = permit.data[1],
                                     .live_counter = permit.data[2],
                                     .known_answer_signature = kKnownAnswerSignature,
                                     .samples = 3,
                                     .nonce = 7,
                                     .lap = static_cast<std::uint16_t>(sample / 240)},
                                    0);
    EXPECT_EQ(permit.data, made[0].data);
}

TEST_P(GuardPermits, OnePairWithTheWordStopFollowsTheStopFrame) {
    arm();
    const std::int64_t from_us = world.wire.now_us;
    world.guard->report(GuardFault::engine, from_us);
    world.run_periods(20);
    EXPECT_GE(world.count_sent(0x001, from_us), 18U) << "again each period";
    std::vector<CanFrame> after;
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.time_us >= from_us &&
            (frame.id == 0x001 || frame.id == 0x103 || frame.id == 0x104)) {
            after.push_back(frame);
        }
    }
    ASSERT_GE(after.size(), 4U);
    EXPECT_EQ(after[0].id, 0x001U);
    EXPECT_EQ(after[1].id, 0x103U);
    const auto twin = std::find_if(after.begin(), after.end(),
                                   [](const CanFrame& frame) { return frame.id == 0x104; });
    ASSERT_NE(twin, after.end());
    EXPECT_EQ(twin->time_us, after[0].time_us) << "in the same turn as the stop";
    EXPECT_EQ(after[1].data[0], 0x5A);
    EXPECT_EQ(after[1].data[5], 250);
    EXPECT_EQ(after[1].data[6], 0);
    EXPECT_EQ(after[1].data[7], 0) << "no samples";
    const auto made = encode_permit(world.machine.can,
                                    {.word = PermitWord::stop,
                                     .sync_counter = after[1].data[1],
                                     .live_counter = after[1].data[2],
                                     .known_answer_signature = kKnownAnswerSignature,
                                     .nonce = kNonce,
                                     .lap = 0},
                                    0);
    EXPECT_EQ(after[1].data, made[0].data);
    const std::uint64_t latched = static_cast<std::uint64_t>(from_us - world.kBeginUs) / 1000;
    EXPECT_LE(after[1].data[1], sync_counter_of(latched));
    EXPECT_GE(after[1].data[1], sync_counter_of(latched - 1)) << "the newest sample";
    EXPECT_EQ(std::count_if(after.begin(), after.end(),
                            [](const CanFrame& frame) { return frame.id == 0x103; }),
              1)
        << "the stop frame alone is repeated";
    JudgedBoard board(world);
    EXPECT_EQ(board.fixture.board.cause, AXG_BOARD_CAUSE_STOP_FRAME);
}

// The word alone stops a board that knows another id for the stop.
TEST_P(GuardPermits, TheWordStopsABoardThatDoesNotKnowTheStopFrame) {
    arm();
    const std::int64_t stop_us = world.wire.now_us;
    world.guard->report(GuardFault::engine, stop_us);
    world.run_periods(2);
    test::BoardFixture fixture;
    fixture.begin();
    axg_board_heard heard = AXG_BOARD_HEARD_NOTHING;
    for (const CanFrame& sent : world.wire.sent) {
        if (sent.time_us >= stop_us && (sent.id == 0x103 || sent.id == 0x104)) {
            axg_board_can_frame frame{};
            frame.id = sent.id;
            frame.length = 8;
            std::copy_n(sent.data.begin(), 8, frame.data);
            heard = axg_board_frame(&fixture.board, &frame, fixture.board.now_us + 10);
        }
    }
    EXPECT_EQ(heard, AXG_BOARD_HEARD_STOP);
    EXPECT_EQ(fixture.board.cause, AXG_BOARD_CAUSE_STOP_WORD);
}

TEST_P(GuardPermits, WithoutAnySampleTheWordStopEchoesOneThatExists) {
    world.guard->report(GuardFault::engine, world.wire.now_us);
    world.run_until(world.kBeginUs - 1000);
    const auto words = sent_with(0x103);
    ASSERT_EQ(words.size(), 1U);
    EXPECT_EQ(words[0].data[0], 0x5A);
    EXPECT_EQ(words[0].data[1], 1);
}

TEST_P(GuardPermits, HintsLeaveEvery10MsWithTheNewestSample) {
    world.verdict = [](std::uint64_t) {
        CycleResult result{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        result.advisories.pair = 2;
        result.advisories.distance_mm = 1.5;
        return result;
    };
    arm();
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(1000);
    const auto hints = sent_with(0x682, from_us);
    EXPECT_GE(hints.size(), 99U);
    EXPECT_LE(hints.size(), 101U);
    for (const CanFrame& frame : hints) {
        EXPECT_EQ(frame.length_bytes, 5);
        EXPECT_EQ(frame.data[1], 2);
        EXPECT_EQ(frame.data[3], 150);
    }
    EXPECT_NE(hints[0].data[0], hints[1].data[0]) << "of the sample it was proven for";
}

TEST_P(GuardPermits, HintsFromAnotherSenderAreASecondGuard) {
    arm();
    CanFrame foreign;
    foreign.id = world.machine.can.hints_id;
    foreign.length_bytes = 5;
    foreign.time_us = world.wire.now_us;
    world.wire.arrive(foreign);
    world.run_periods(2);
    EXPECT_EQ(guard().cause, GuardFault::second_guard);
}

TEST_P(GuardPermits, ItListensForTheSessionAndItsOwnHints) {
    std::array<std::uint32_t, kLiveIdsMax> ids{};
    std::uint32_t count = live_ids(world.machine, ids);
    const auto has = [&](std::uint32_t id) {
        return std::find(ids.begin(), ids.begin() + count, id) != ids.begin() + count;
    };
    EXPECT_TRUE(has(0x583));
    EXPECT_TRUE(has(0x682));
    world.machine.can.format = CanFormat::signals;  // no sample counter
    count = live_ids(world.machine, ids);
    EXPECT_FALSE(has(0x583));
    EXPECT_FALSE(has(0x682));
}

INSTANTIATE_TEST_SUITE_P(Formats, GuardPermits,
                         testing::Values(CanFormat::classical, CanFormat::fd),
                         [](const testing::TestParamInfo<CanFormat>& tested) {
                             return tested.param == CanFormat::fd ? "fd" : "classical";
                         });

}  // namespace
}  // namespace axg
