// SPDX-License-Identifier: Apache-2.0
// A drive on a wire, by a clock that only its waits advance: the same motion as in simulated time,
// and how it ends.
#include "hil_replay/drive/bus_drive.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <vector>

#include "firmware_if/guard/standstill_watch.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {
namespace {

constexpr std::array<double, 5> kStart{};

class BusDrive : public testing::Test {
  protected:
    /// Out and at rest again in 0.8 s, on all axes: jerk up, down for twice as long, and up.
    static CommandedMotion motion() {
        return [tick = 0](std::span<AxisMotion> axes) mutable {
            const int part = tick++ / 200;
            for (AxisMotion& axis : axes) {
                axis.jerk = part == 0 || part == 3 ? 10 : -10;
            }
            return MotionTick{.is_over = part == 4, .tool = 1};
        };
    }
    BusDriveResult drive() {
        BusDriveOptions options{.board = promised_live_board(machine, 7)};
        return drive_on_bus(machine, bus.wire, bus.clock(), kStart, motion(), options, is_ended,
                            observers);
    }

    Machine machine = [] {
        Machine out = motion_test_machine();
        return out;
    }();
    LiveBus bus{machine, 600};
    std::atomic<bool> is_ended{false};
    BusDriveObservers observers;
};

struct Place {
    std::int64_t after_us = 0;  // since the axes began to move
    std::array<double, 5> position{};
    friend bool operator==(const Place&, const Place&) = default;
};

Place place_of(const MotionBoard& board, std::int64_t time_us) {
    Place place{.after_us = time_us - board.moving_since_us()};
    for (std::size_t i = 0; i < place.position.size(); ++i) {
        place.position[i] = board.axes()[i].position;
    }
    return place;
}

// One board under both kinds of time: the true axes go through the same places at the same instants
// of their motion, bit for bit.
TEST_F(BusDrive, MovesAsInSimulatedTime) {
    std::vector<Place> live, simulated;
    observers.watch = [&](std::int64_t time_us, const MotionBoard& board) {
        live.push_back(place_of(board, time_us));
    };
    const BusDriveResult result = drive();
    EXPECT_EQ(result.drive.state, BoardState::finished);
    MotionBoard board(machine, kStart, motion(), promised_live_board(machine, 7));
    board.watch([&](std::int64_t time_us, auto) { simulated.push_back(place_of(board, time_us)); },
                500);
    ClosedLoop loop(board, {}, make_permit_guard(machine, 600));
    while (!board.is_at_rest()) {
        ASSERT_TRUE(loop.cycle());
    }
    EXPECT_GT(live.size(), 1000U);
    EXPECT_EQ(live, simulated);
    EXPECT_EQ(result.wire.late_periods, 0U);
    EXPECT_GT(result.drive.permits, 500U);
}

// This computer's own lateness is jitter enough; the rest is drawn as for a simulated drive.
TEST_F(BusDrive, ItsSamplesHaveNoJitterOfTheirOwn) {
    machine.guard.latch_jitter_s = 50e-6;
    machine.guard.board_reaction_s = 3e-3;
    EXPECT_EQ(promised_live_board(machine, 7).latch_jitter_us_max, 0);
    EXPECT_EQ(promised_live_board(machine, 7).reaction_us_max, 3000);
    EXPECT_EQ(promised_board(machine, 7).latch_jitter_us_max, 25);
}

// Before the board falls silent a guard sees that the axes stand, within 150 ms of rest; the result
// is of before.
TEST_F(BusDrive, SaysThatItRests) {
    const BusDriveResult result = drive();
    StandstillWatch watch(machine, {}, standstill_rules(machine), INT64_MIN);
    std::uint64_t syncs = 0, stands_at = 0;
    for (const CanFrame& frame : bus.wire.sent) {
        syncs += frame.id == machine.can.sync_id ? 1U : 0U;
        watch.on_frame(frame);
        stands_at = stands_at == 0 && watch.stands(frame.time_us) ? syncs : stands_at;
    }
    EXPECT_EQ(machine.can.sample_us, 1000U);
    EXPECT_GT(stands_at, result.drive.samples + 90);
    EXPECT_LT(stands_at, result.drive.samples + 150);
}

TEST_F(BusDrive, EndedWhileItMovesItBrakesFirst) {
    observers.each = [this](const MotionBoard& board) { is_ended.store(board.samples() > 200); };
    const BusDriveResult result = drive();
    EXPECT_EQ(result.drive.state, BoardState::stopped);
    EXPECT_EQ(result.drive.board_stop.why, BoardStop::person_said_stop);
}

TEST_F(BusDrive, EndedWhileItWaitsItHasNotMoved) {
    bus.has_guard = false;
    observers.each = [this](const MotionBoard& board) { is_ended.store(board.samples() == 3000); };
    const BusDriveResult result = drive();
    EXPECT_EQ(result.drive.state, BoardState::waiting) << "for longer than a simulated board";
    EXPECT_EQ(result.drive.samples, 3000U);
}

// Whether it waits or moves: the interface is gone, and so is the drive.
TEST_F(BusDrive, EndsWithItsInterface) {
    for (const bool is_moving : {false, true}) {
        LiveBus other(machine, 600);
        other.has_guard = is_moving;
        observers.each = [&](const MotionBoard& board) {
            is_ended.store(board.samples() > 5000);
            if (board.samples() == 100) {
                other.wire.inject(ReadStatus::gone);
                other.wire.reply = SendStatus::gone;
            }
        };
        const BusDriveResult result =
            drive_on_bus(machine, other.wire, other.clock(), kStart, motion(),
                         {.board = promised_live_board(machine, 7)}, is_ended, observers);
        EXPECT_EQ(result.drive.state, is_moving ? BoardState::stopped : BoardState::waiting);
        EXPECT_TRUE(result.wire.is_lost);
        EXPECT_LT(result.drive.samples, 5000U) << "it waits for nothing";
    }
}

TEST_F(BusDrive, SendsNothingBesideAnotherBoard) {
    observers.each = [](const MotionBoard&) { FAIL() << "a sample was latched"; };
    CanFrame frame;
    frame.id = machine.can.sync_id;
    frame.time_us = bus.now_us() + 1000;
    bus.wire.arrive(frame);
    EXPECT_EQ(drive().wire.other_board_id, machine.can.sync_id);
    EXPECT_TRUE(bus.wire.sent.empty());
}

}  // namespace
}  // namespace axg::test
