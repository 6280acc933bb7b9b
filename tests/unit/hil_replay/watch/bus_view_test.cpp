// SPDX-License-Identifier: Apache-2.0
// What the live page knows from frames alone, of a bus that a board and a guard share.
#include "hil_replay/watch/bus_view.hpp"

#include <gtest/gtest.h>

#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/operator_frames.hpp"
#include "tests/support/watched_frames.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kSamples = 300;  // more than a lap of SYNC

class BusViewTest : public testing::Test {
  protected:
    void hear(const std::vector<CanFrame>& frames) {
        for (const CanFrame& frame : frames) {
            view.on_frame(frame);
        }
    }
    void hear_all() { hear(test::watched_frames(machine, kSamples)); }
    [[nodiscard]] std::int64_t last_us() const {
        return test::snapshot_at(machine, kSamples - 1).latched_us;
    }

    Machine machine = test::watched_machine();
    ConfigurationHashes hashes{{1, 2, 3, 4}};
    BusView view{machine, hashes};
    const BusState& state = view.state();
};

TEST_F(BusViewTest, ShowsPositionsAndHintsOfTheNewestFrames) {
    hear_all();
    ASSERT_TRUE(state.axes);
    const AxisSnapshot sent = test::snapshot_at(machine, kSamples - 1);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(state.axes->position[i], sent.position[i], 1e-3);
    }
    EXPECT_EQ(state.axes->tool, 7);
    ASSERT_TRUE(state.hints);
    EXPECT_EQ(state.hints->pair, 1);
    EXPECT_EQ(state.hints->distance_10um, 131);
    EXPECT_EQ(state.bad, 0U);
    EXPECT_EQ(state.heartbeat, GuardHeartbeat::running);
    EXPECT_EQ(state.input_fault, ReceiverFault::none);
}

TEST_F(BusViewTest, APermitHoldsUntilNPeriodsAfterItsLatch) {
    hear_all();
    ASSERT_TRUE(state.permit);
    EXPECT_EQ(state.permit->word, PermitWord::slow);
    EXPECT_EQ(state.permit->samples, 3);
    EXPECT_EQ(state.permit->cap, 125);
    EXPECT_EQ(state.permit->level, 2);
    EXPECT_EQ(state.answer, PermitAnswer::right);
    EXPECT_NEAR(static_cast<double>(state.permit_end_us - last_us()), 3000, 600);
}

TEST_F(BusViewTest, APermitOfAnotherSessionIsNotInForce) {
    hear_all();
    const std::int64_t end_us = state.permit_end_us;
    const auto pair = test::permit_of_sample(machine, kSamples - 1, 0x123456);
    hear({pair[0], pair[1]});
    EXPECT_EQ(state.answer, PermitAnswer::wrong);
    EXPECT_EQ(state.permit_end_us, end_us);
}

TEST_F(BusViewTest, StopFrameAndWordStopEndThePermit) {
    hear_all();
    ASSERT_NE(state.permit_end_us, kNeverSeen);
    hear({encode_stop(machine.can, last_us() + 500)});
    EXPECT_EQ(state.permit_end_us, kNeverSeen);
    EXPECT_EQ(state.stop_us, last_us() + 500);
    hear_all();
    ASSERT_NE(state.permit_end_us, kNeverSeen);
    const auto pair =
        encode_permit(machine.can, {.word = PermitWord::stop, .sync_counter = 1, .live_counter = 1},
                      last_us() + 600);
    hear({pair[0], pair[1]});
    EXPECT_EQ(state.permit->word, PermitWord::stop);
    EXPECT_EQ(state.permit_end_us, kNeverSeen);
}

TEST_F(BusViewTest, AStopHasItsEmergencyUntilTheReset) {
    const Emergency contact{.code = EmergencyCode::contact, .error_register = 1, .pair = 1};
    hear({encode_emergency(machine.can, contact, 5)});
    ASSERT_TRUE(state.emergency);
    EXPECT_EQ(state.emergency->pair, 1);
    hear({encode_emergency(machine.can, {}, 6)});
    EXPECT_FALSE(state.emergency);
    hear({encode_operator_status(machine.can, {.phase = GuardPhase::ready}, 7)});
    EXPECT_EQ(state.phase, GuardPhase::ready);
    EXPECT_EQ(state.guard_us, 7);
}

TEST_F(BusViewTest, NamesThePartsThatTheGuardHasOtherwise) {
    hear({encode_hash(0x602, {2, 99}, 1), encode_hash(0x602, {0, 1}, 1)});
    EXPECT_EQ(state.other_hashes, 0b100U);
    hear({encode_hash(0x602, {2, 3}, 2)});
    EXPECT_EQ(state.other_hashes, 0U);
}

TEST_F(BusViewTest, MalformedFramesAreCountedAndChangeNothing) {
    hear_all();
    CanFrame beat = encode_guard_heartbeat(machine.can, GuardHeartbeat::tripped, 9);
    beat.data[0] = 77;
    CanFrame hints =
        encode_hints(machine.can, {.sync_counter = 1, .pair = 2, .distance_10um = 5}, 9);
    const auto pair = test::permit_of_sample(machine, 5);
    CanFrame twin = pair[1];
    twin.data[4] ^= 1U;
    CanFrame hash = encode_hash(0x602, {0, 7}, 9);
    hash.data[3] = 1;
    hear({beat, hints, pair[0], twin, pair[1], hash});
    EXPECT_EQ(state.bad, 5U);  // of six, the plain permit alone is a good frame
    EXPECT_EQ(state.heartbeat, GuardHeartbeat::running);
    EXPECT_EQ(state.hints->pair, 1) << "pair 2 is none of the machine's two";
    EXPECT_EQ(state.other_hashes, 0U);
}

TEST_F(BusViewTest, ReadsOnAfterABoardThatFails) {
    hear_all();
    const std::int64_t silent_us = last_us() + 1'000'000;
    view.on_time(silent_us);  // stale: a guard would stop here
    EXPECT_EQ(state.input_fault, ReceiverFault::stale);
    auto frames = test::watched_frames(machine, kSamples);
    for (CanFrame& frame : frames) {
        frame.time_us += 2'000'000;
    }
    hear(frames);
    EXPECT_GT(state.board_us, silent_us);
    EXPECT_EQ(state.answer, PermitAnswer::right);
}

}  // namespace
}  // namespace axg
