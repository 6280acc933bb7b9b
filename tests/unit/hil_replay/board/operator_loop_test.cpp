// SPDX-License-Identifier: Apache-2.0
// A control panel on the wire between the simulated board and the deployed guard: armed by frames
// the board moves, after a stop it is reset and armed by frames, and not while it brakes.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>

#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/host_wire.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/board/closed_loop.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/operator_panel.hpp"

namespace axg::test {
namespace {

constexpr std::array<double, 5> kZeroPositions{};

/// As it is deployed, with an engine that proves everything.
class LoopNode {
  public:
    explicit LoopNode(const Machine& machine)
        : guard_(std::make_unique<GuardNode>(machine, LiveOptions{}, wire_, *queues_, latch_,
                                             kBoardStartUs - 1000)) {}
    LoopGuard node() {
        return {.on_frame = [this](const CanFrame& frame,
                                   std::vector<CanFrame>& sent) { hear({.frame = frame}, sent); },
                .on_time = [this](std::int64_t at_us,
                                  std::vector<CanFrame>& sent) { turn(at_us, sent); },
                .on_echo =
                    [this](const CanFrame& frame, std::vector<CanFrame>& sent) {
                        hear({.frame = frame, .is_own = true}, sent);
                    },
                .next_due_us = [this] { return std::max(now_us, guard_->next_due_us()); }};
    }
    /// Of the panel: it is there at the next turn.
    void arrive(const CanFrame& frame) { ASSERT_TRUE(wire_.arrive({.frame = frame})); }
    GuardNode& guard() { return *guard_; }

    std::int64_t now_us = kBoardStartUs - 1000;
    axg_operator_status status{};
    bool is_well = true;  // false: the next verdict stops

  private:
    void hear(const CanArrival& arrival, std::vector<CanFrame>& sent) {
        ASSERT_TRUE(wire_.arrive(arrival));
        turn(arrival.frame.time_us, sent);
    }
    void turn(std::int64_t at_us, std::vector<CanFrame>& sent) {
        now_us = std::max(now_us, at_us);
        guard_->turn(now_us);
        answer();
        guard_->turn(now_us);
        CanFrame frame;
        while (wire_.take(frame)) {
            frame.time_us = now_us;
            status = status_in(frame).value_or(status);
            sent.push_back(frame);
        }
    }
    void answer() {
        LiveQuery query;
        while (queues_->queries.pop(query)) {
            const bool is_valid = query.event.state == ReceiverState::valid;
            LiveResult result{.kind = query.kind,
                              .is_passed = true,
                              .number = query.number,
                              .epoch = query.epoch,
                              .period = query.period,
                              .taken = query.number,
                              .result = {.has_permit = is_valid && is_well,
                                         .is_stop = !is_well,
                                         .reason = is_well ? StopReason::none : StopReason::contact,
                                         .known_answer_signature = kKnownAnswerSignature,
                                         .samples = 3},
                              .sync_counter = query.event.sync_counter,
                              .latched_us = query.event.snapshot.latched_us,
                              .arrived_us = query.event.snapshot.arrived_us,
                              .done_us = now_us};
            ASSERT_TRUE(query.kind == LiveQuery::Kind::look_ahead || queues_->results.push(result));
        }
        LiveNote note;
        while (queues_->notes.pop(note)) {
        }
    }

    HostWire wire_;
    std::unique_ptr<LiveQueues> queues_ = std::make_unique<LiveQueues>();
    LatchCell latch_{kLatchClear, ~kLatchClear};
    std::unique_ptr<GuardNode> guard_;
};

class OperatorLoop : public testing::Test {
  protected:
    static Approach to_the_right() {
        Approach approach;
        approach.target = {100, 0, -50, -0.5, 1};
        approach.speed_share.fill(1);
        return approach;
    }
    void cycles(int count) {
        for (int i = 0; i < count; ++i) {
            ASSERT_TRUE(loop.cycle());
        }
    }
    GuardPhase phase() { return node.guard().guard().phase; }
    /// Both of a person's actions, half a second apart.
    void act(axg_operator_action action) {
        node.arrive(panel.request(action, node.now_us));
        cycles(500);
        node.arrive(panel.confirm(action, node.status.nonce, node.now_us));
        cycles(20);
    }

    Machine machine = [] {
        Machine out = motion_test_machine();
        return out;
    }();
    MotionBoard board{machine, kZeroPositions, make_approach(machine, to_the_right()), {}};
    LoopNode node{machine};
    ClosedLoop loop{board, {}, node.node()};
    OperatorPanel panel;
};

TEST_F(OperatorLoop, ABoardMovesStopsAndIsPermittedAgainByFramesAlone) {
    cycles(400);
    ASSERT_EQ(phase(), GuardPhase::ready);
    EXPECT_EQ(board.state(), BoardState::waiting);
    act(AXG_OPERATOR_ARM);
    EXPECT_EQ(phase(), GuardPhase::armed);
    EXPECT_EQ(board.state(), BoardState::moving);

    node.is_well = false;
    cycles(2);
    ASSERT_EQ(phase(), GuardPhase::stopped);
    node.is_well = true;
    node.arrive(panel.request(AXG_OPERATOR_RESET, node.now_us));
    cycles(12);
    EXPECT_EQ(node.status.refusal, AXG_OPERATOR_REFUSED_MOVES);
    EXPECT_EQ(node.status.nonce, 0U);
    EXPECT_EQ(board.state(), BoardState::braking);
    node.arrive(panel.confirm(AXG_OPERATOR_RESET, node.status.nonce, node.now_us));
    cycles(5);
    EXPECT_EQ(phase(), GuardPhase::stopped);

    cycles(1000);
    EXPECT_EQ(board.state(), BoardState::stopped);
    act(AXG_OPERATOR_RESET);
    cycles(300);
    EXPECT_EQ(phase(), GuardPhase::ready);
    const std::uint64_t permits = node.guard().counters().permits;
    act(AXG_OPERATOR_ARM);
    EXPECT_EQ(phase(), GuardPhase::armed);
    EXPECT_GT(node.guard().counters().permits, permits);
    EXPECT_EQ(node.guard().counters().operator_acts, 3U);
    EXPECT_EQ(node.guard().counters().operator_refused, 2U);
}

// The same run with and without a panel that asks without a pause: no permit leaves later for it.
TEST_F(OperatorLoop, NoPermitWaitsForAPanelThatAsksWithoutAPause) {
    const auto permits_of = [this](bool has_panel) {
        MotionBoard other(machine, kZeroPositions, make_approach(machine, to_the_right()), {});
        LoopNode guard(machine);
        std::vector<std::int64_t> left_us;
        LoopGuard wired = guard.node();
        const auto hear = wired.on_echo;
        wired.on_echo = [&](const CanFrame& frame, std::vector<CanFrame>& sent) {
            if (frame.id == machine.can.permit_id && frame.data[0] == 0xA5) {
                left_us.push_back(frame.time_us);
            }
            hear(frame, sent);
        };
        ClosedLoop both(other, {}, wired);
        for (int i = 0; i < 1000; ++i) {
            if (i == 400) {
                guard.guard().arm(guard.now_us);
            }
            if (has_panel && i > 100) {
                guard.arrive(panel.request(AXG_OPERATOR_ARM, guard.now_us));
            }
            EXPECT_TRUE(both.cycle());
        }
        EXPECT_EQ(other.state(), BoardState::moving);
        return left_us;
    };
    const auto quiet = permits_of(false), busy = permits_of(true);
    ASSERT_EQ(quiet.size(), busy.size());
    ASSERT_GT(quiet.size(), 500U);
    for (std::size_t i = 0; i < quiet.size(); ++i) {
        // A frame that has the wire is not interrupted: 8 bytes take up to 135 us at 1 Mbit/s.
        EXPECT_LE(busy[i] - quiet[i], 135) << i;
    }
}

}  // namespace
}  // namespace axg::test
