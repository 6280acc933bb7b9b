// SPDX-License-Identifier: Apache-2.0
// What the library for boards sends: values at the ends of their ranges, what is not sent, and
// counters. Whole samples byte by byte: board_page_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "firmware_if/board/axguard_board.h"
#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

using test::BoardFixture;
using Bytes = std::vector<std::uint8_t>;

constexpr axg_board_axis_ids kSampleIds[] = {{0x181, 0x181}, {0x281, 0x281}, {0x381, 0x381}};
constexpr std::int32_t k24BitsMax = 8'388'607;

Bytes bytes_of(const axg_board_can_frame& frame, std::size_t first, std::size_t count) {
    return {frame.data + first, frame.data + first + count};
}

/// Five axes X Y Z A C, C endless, and one sample.
class BoardFrames : public ::testing::Test, public BoardFixture {
  protected:
    BoardFrames() {
        arm();
        (void)latch(0);
        says.is_homed = true;
        says.mode = 1;
    }
    std::uint8_t classical() {
        return axg_board_encode_classical(&board, &says, positions.data(), kSampleIds,
                                          frames.data());
    }

    axg_board_says says{};
    std::array<std::int32_t, 5> positions{};
    std::array<axg_board_can_frame, 3> frames{};
    axg_board_can_frame frame{};
};

TEST_F(BoardFrames, FlagsAreHomedSpindleAndRapidOrTheJog) {
    EXPECT_EQ(axg_board_flags(&board, &says), 0U);
    says.is_homed = false;
    EXPECT_EQ(axg_board_flags(&board, &says), 1U);
    says.is_homed = says.is_spindle_on = true;
    EXPECT_EQ(axg_board_flags(&board, &says), 2U);
    says.is_spindle_on = false;
    says.is_rapid = true;
    EXPECT_EQ(axg_board_flags(&board, &says), 8U);
    says.mode = 3;
    says.jog_axis = 4;
    EXPECT_EQ(axg_board_flags(&board, &says), 0x40U);
    says.jogs_down = true;
    EXPECT_EQ(axg_board_flags(&board, &says), 0x42U);
}

TEST_F(BoardFrames, ABoardThatKeepsNoCapNamesNoPermit) {
    for (std::uint32_t number = 1; number < 6; ++number) {
        (void)latch(number);
        (void)hear({.number = number, .live = static_cast<std::uint8_t>(number)},
                   instant_of(number) + 100);
        EXPECT_EQ(axg_board_flags(&board, &says), 0U) << number;
    }
}

TEST_F(BoardFrames, APositionHas24BitsOrIsNotKnown) {
    positions = {k24BitsMax, -k24BitsMax, AXG_BOARD_NO_POSITION, 0, 0};
    ASSERT_EQ(classical(), 3);
    EXPECT_EQ(bytes_of(frames[0], 2, 6), (Bytes{0xFF, 0xFF, 0x7F, 0x01, 0x00, 0x80}));
    EXPECT_EQ(bytes_of(frames[1], 2, 3), (Bytes{0x00, 0x00, 0x80}));
    for (const std::size_t axis : {0U, 1U}) {
        for (const std::int32_t beyond : {k24BitsMax + 1, -k24BitsMax - 1}) {
            positions = {};
            positions[axis] = beyond;
            const std::uint8_t counter = board.axes_counter;
            EXPECT_EQ(classical(), 0) << axis << " at " << beyond;
            EXPECT_EQ(board.axes_counter, counter) << "nothing was sent";
        }
    }
}

TEST_F(BoardFrames, AToolNumberHasAByteOrFlexibleFrames) {
    says.tool = 255;
    ASSERT_EQ(classical(), 3);
    EXPECT_EQ(frames[2].data[6], 255);
    for (const std::uint16_t beyond : {std::uint16_t{256}, std::uint16_t{257}}) {
        says.tool = beyond;
        const std::uint8_t counter = board.axes_counter;
        EXPECT_EQ(classical(), 0) << beyond << " is not sent as another tool";
        EXPECT_EQ(board.axes_counter, counter) << "nothing was sent";
        EXPECT_EQ(axg_board_encode_fd(&board, &says, positions.data(), kSampleIds[0], &frame), 1);
    }
}

TEST_F(BoardFrames, AnEndlessAxisIsSentWithinATurn) {
    const std::pair<std::int32_t, std::uint32_t> turns[] = {
        {0, 0},          {3'599'999, 3'599'999}, {3'600'000, 0},          {36'000'005, 5},
        {-1, 3'599'999}, {-3'600'000, 0},        {-36'000'005, 3'599'995}};
    for (const auto& [position, sent] : turns) {
        positions[4] = position;
        ASSERT_EQ(classical(), 3) << position;
        EXPECT_EQ(frames[2].data[2] | frames[2].data[3] << 8 | frames[2].data[4] << 16,
                  static_cast<int>(sent))
            << position;
        ASSERT_EQ(axg_board_encode_fd(&board, &says, positions.data(), kSampleIds[0], &frame), 1);
        EXPECT_EQ(frame.data[20] | frame.data[21] << 8 | frame.data[22] << 16,
                  static_cast<int>(sent));
    }
}

TEST_F(BoardFrames, APositionThatIsNotKnownIsNoneOfAnEndlessAxisEither) {
    positions[4] = AXG_BOARD_NO_POSITION;
    ASSERT_EQ(classical(), 3);
    EXPECT_EQ(bytes_of(frames[2], 2, 3), (Bytes{0x00, 0x00, 0x80}));
    ASSERT_EQ(axg_board_encode_fd(&board, &says, positions.data(), kSampleIds[0], &frame), 1);
    EXPECT_EQ(bytes_of(frame, 20, 4), (Bytes{0x00, 0x00, 0x00, 0x80}));
}

TEST_F(BoardFrames, WithAnEvenNumberOfAxesTheLastSlotIsEmpty) {
    options.axis_count = 4;
    arm();
    (void)latch(0);
    says.tool = 7;
    ASSERT_EQ(classical(), 3);
    EXPECT_EQ(bytes_of(frames[2], 2, 6), (Bytes{1, 7, 0, 0, 0, 0}));
}

TEST_F(BoardFrames, EverySampleHasTheNextCounter) {
    for (std::uint32_t i = 0; i < 20; ++i) {
        ASSERT_EQ(classical(), 3);
        for (const axg_board_can_frame& one : frames) {
            EXPECT_EQ(one.data[1] & 15U, i & 15U);
        }
    }
    for (std::uint32_t i = 20; i < 24; ++i) {
        ASSERT_EQ(axg_board_encode_fd(&board, &says, positions.data(), kSampleIds[0], &frame), 1);
        EXPECT_EQ(frame.data[2], i);
        EXPECT_TRUE(frame.is_fd);
    }
}

TEST_F(BoardFrames, WithoutASampleNothingIsSent) {
    (void)axg_board_power_up(&board, &options, 0x123456, 0);
    EXPECT_EQ(classical(), 0);
    EXPECT_EQ(axg_board_encode_fd(&board, &says, positions.data(), kSampleIds[0], &frame), 0);
    EXPECT_FALSE(axg_board_encode_session(&board, {0x583, 0x583}, 0, &frame));
    EXPECT_FALSE(axg_board_is_session_due(&board, 1'000'000));
    EXPECT_FALSE(axg_board_encode_hash(&board, 0x582, 4, &frame)) << "there is no such part";
    EXPECT_EQ(frame.id, 0U);
    EXPECT_EQ(frame.length, 0);
}

TEST_F(BoardFrames, TheSessionIsDueAtOnceWhereLapOrNonceChangedAndEvery100Ms) {
    const auto is_due = [&](std::uint64_t at_us) {
        return axg_board_is_session_due(&board, at_us);
    };
    const std::uint64_t at = instant_of(0);
    EXPECT_TRUE(is_due(at)) << "the nonce is new";
    ASSERT_TRUE(axg_board_encode_session(&board, {0x583, 0x583}, at, &frame));
    EXPECT_FALSE(is_due(at + 99'999));
    EXPECT_TRUE(is_due(at + 100'000));
    ASSERT_TRUE(latch_at(1, at + 1000));
    EXPECT_FALSE(is_due(at + 1000)) << "the lap is the same";
    ASSERT_TRUE(latch_at(AXG_BOARD_SYNC_MAX, at + 2000));
    EXPECT_TRUE(is_due(at + 2000));
    ASSERT_TRUE(axg_board_encode_session(&board, {0x583, 0x583}, at + 2000, &frame));
    EXPECT_FALSE(latch_at(AXG_BOARD_SYNC_MAX, at + 3000)) << "out of order";
    ASSERT_TRUE(latch_at(AXG_BOARD_SYNC_MAX + 1, at + 4000));
    EXPECT_TRUE(is_due(at + 4000)) << "the first one after it";
}

TEST_F(BoardFrames, HashesSyncAndHeartbeatAreSentAsTheyAre) {
    options.hashes[3] = 0x47332211;
    (void)axg_board_power_up(&board, &options, 0x123456, 0);
    for (axg_board_can_frame& one : frames) {
        one.is_fd = true;
        std::fill_n(one.data, 64, std::uint8_t{0xEE});
    }
    ASSERT_TRUE(axg_board_encode_hash(&board, 0x582, 3, frames.data()));
    EXPECT_EQ(bytes_of(frames[0], 0, 8), (Bytes{3, 1, 0, 0, 0x11, 0x22, 0x33, 0x47}));
    EXPECT_EQ(frames[0].id, 0x582U);
    EXPECT_FALSE(axg_board_encode_hash(&board, 0x582, 4, frames.data()));
    axg_board_encode_sync(0x080, 17, &frames[1]);
    axg_board_encode_heartbeat(0x701, 5, &frames[2]);
    const std::uint32_t ids[] = {0x582, 0x080, 0x701};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(frames[i].id, ids[i]);
        EXPECT_EQ(frames[i].length, i == 0 ? 8 : 1);
        EXPECT_FALSE(frames[i].is_fd);
    }
    EXPECT_EQ(frames[1].data[0], 17);
    EXPECT_EQ(frames[2].data[0], 5);
}

}  // namespace
}  // namespace axg
