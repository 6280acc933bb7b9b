// SPDX-License-Identifier: Apache-2.0
// The live guard never touches the heap after construction, healthy or not: every call of malloc
// counts.
#include "firmware_if/guard/guard_node.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>

#include "firmware_if/guard/black_box.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/malloc_count.hpp"
#include "tests/support/operator_panel.hpp"

namespace axg {
namespace {

using test::allocations;

/// Frames of the board in order, and echoes at once.
class FixedWire final : public CanTransport {
  public:
    void arrive(const CanFrame& frame, bool is_own) {
        arrivals_[end_++ % arrivals_.size()] = {.frame = frame, .is_own = is_own};
    }
    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override {
        ++sent;
        arrive(frame, true);
        return reply;
    }
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override {
        if (begin_ == end_) {
            return ReadStatus::none;
        }
        out = arrivals_[begin_++ % arrivals_.size()];
        return ReadStatus::frame;
    }

    std::size_t sent = 0;
    SendStatus reply = SendStatus::ok;

  private:
    std::array<CanArrival, 256> arrivals_{};
    std::size_t begin_ = 0, end_ = 0;
};

/// The engine's thread and the logger's, in one.
void serve(LiveQueues& queues, std::int64_t now_us) {
    LiveQuery query;
    while (queues.queries.pop(query)) {
        LiveResult live_result;
        live_result.kind = query.kind;
        live_result.is_passed = true;
        live_result.number = query.number;
        live_result.epoch = query.epoch;
        live_result.period = query.period;
        live_result.result.has_permit = query.event.state == ReceiverState::valid;
        live_result.result.samples = 3;
        live_result.sync_counter = query.event.sync_counter;
        live_result.latched_us = query.event.snapshot.latched_us;
        live_result.arrived_us = live_result.done_us = now_us;
        EXPECT_TRUE(queues.results.push(live_result));
    }
    LiveNote note;
    while (queues.notes.pop(note)) {
    }
}

TEST(GuardNodeAllocates, NothingInHealthOrAfterFaults) {
    const Machine machine = test::five_axis_machine(CanFormat::classical);
    const auto frames = test::board_frames(machine, 2000);
    const auto queues = std::make_unique<LiveQueues>();
    LatchCell latch{kLatchClear, ~kLatchClear};
    FixedWire wire;
    const auto records = std::make_unique<BlackBoxQueue>();
    BlackBox black_box(black_box_bytes(machine));
    GuardNode guard(machine,
                    {.black_box = records.get(), .supposes_arming = true, .ignores_period = true},
                    wire, *queues, latch, 999'000);
    const std::uint64_t before = allocations;
    std::uint64_t permits_healthy = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        for (const CanFrame& frame : frames[k]) {
            wire.arrive(frame, false);
            guard.turn(frame.time_us);
            serve(*queues, frame.time_us);
        }
        const std::int64_t now_us = 1'000'000 + static_cast<std::int64_t>(k) * 1000 + 600;
        guard.turn(now_us);
        BlackBoxEntry record;
        while (records->pop(record)) {
            black_box.add(record);
        }
        if (k == 50) {
            guard.arm(now_us);
        } else if (k == 1000) {
            permits_healthy = guard.counters().permits;
            wire.reply = SendStatus::down;
        } else if (k == 1100) {
            wire.reply = SendStatus::ok;
            guard.reset(now_us);
            guard.report(GuardFault::recorder, now_us);
        }
    }
    EXPECT_EQ(allocations, before);
    EXPECT_GT(black_box.sequence(), 10'000U);
    EXPECT_GT(permits_healthy, 900U);
    EXPECT_EQ(guard.guard().phase, GuardPhase::stopped);
    EXPECT_GT(guard.counters().stops, 100U);
}

TEST(GuardNodeAllocates, NothingForAnOperatorWhetherItActsOrNot) {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    const auto queues = std::make_unique<LiveQueues>();
    LatchCell latch{kLatchClear, ~kLatchClear};
    FixedWire wire;
    GuardNode guard(machine, {.supposes_arming = true, .ignores_period = true}, wire, *queues,
                    latch, 999'000);
    test::OperatorPanel panel;
    const std::uint64_t before = allocations;
    for (std::int64_t now_us = 1'000'000; now_us < 2'000'000; now_us += 500) {
        CanFrame frame = panel.request(AXG_OPERATOR_ARM, now_us);
        frame.data[7] ^= now_us % 3000 == 0 ? 1U : 0U;
        wire.arrive(frame, false);
        guard.turn(now_us);
        serve(*queues, now_us);
    }
    EXPECT_EQ(allocations, before);
    EXPECT_GT(guard.counters().operator_refused, 500U);
    EXPECT_GT(guard.counters().operator_ignored, 500U);
}

}  // namespace
}  // namespace axg
