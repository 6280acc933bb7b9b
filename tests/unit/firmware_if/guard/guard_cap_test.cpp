// SPDX-License-Identifier: Apache-2.0
// The live guard of a board that keeps caps: which caps a sample names is known by the permits that
// were sent. What follows from them: tests/unit/core/guard/cap_guard_test.cpp.
#include <gtest/gtest.h>

#include <variant>

#include "tests/support/live_world.hpp"

namespace axg {
namespace {

class GuardCap : public testing::Test {
  protected:
    GuardCap() {
        world.verdict = [this](std::uint64_t) {
            CycleResult result{
                .has_permit = true, .known_answer_signature = kKnownAnswerSignature, .samples = 10};
            result.has_cap = true;
            result.cap_order = {.cap = cap, .mask = 0xFF};
            return result;
        };
        world.says = [this](AxisSnapshot& snapshot) {
            if (names_permits && live() != 0) {
                snapshot.flags = static_cast<std::uint8_t>(kFlagAck | live() << kAckShift);
            }
        };
        world.options.black_box = records.get();
        world.each_step = [this] {
            BlackBoxEntry entry;
            while (records->pop(entry)) {
                if (const auto* const query = std::get_if<LiveQuery>(&entry.content)) {
                    newest = query->kind == LiveQuery::Kind::snapshot ? query->caps : newest;
                }
            }
        };
        world.start();
    }
    static Machine capped_machine() {
        Machine machine = test::five_axis_machine(CanFormat::classical);
        machine.can.permit_samples = {3, 12};
        machine.guard.cap = CapPromise::all_axes;
        return machine;
    }
    /// Of the permit that was sent last; 0: none was.
    [[nodiscard]] std::uint8_t live() const {
        std::uint8_t found = 0;
        for (const CanFrame& frame : world.wire.sent) {
            const bool is_run = frame.id == world.machine.can.permit_id && frame.data[0] == 0xA5;
            found = is_run ? frame.data[2] : found;
        }
        return found;
    }

    std::uint8_t cap = 60;
    bool names_permits = true;
    CapFacts newest;
    std::unique_ptr<BlackBoxQueue> records = std::make_unique<BlackBoxQueue>();
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{capped_machine(), latch};
};

TEST_F(GuardCap, ASampleIsKnownByThePermitThatItNames) {
    world.run_to_armed();
    world.run_periods(60);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::armed);
    EXPECT_EQ(newest.status, AckStatus::known);
    EXPECT_EQ(newest.acked, caps_of_permit(60, 0xFF));
    EXPECT_EQ(newest.since, caps_of_permit(60, 0xFF));
    cap = 20;
    world.run_periods(3);
    EXPECT_EQ(newest.acked, caps_of_permit(20, 0xFF));
    EXPECT_EQ(newest.since, caps_of_permit(60, 0xFF)) << "it was in force within 16 samples";
    names_permits = false;
    world.run_periods(3);
    EXPECT_EQ(newest.status, AckStatus::none);
    EXPECT_EQ(newest.acked, rapid_caps());
}

TEST_F(GuardCap, APermitOfBeforeAResetIsNotKnown) {
    world.run_to_armed();
    world.run_periods(60);
    names_permits = false;
    world.stands_still = true;
    world.guard->report(GuardFault::engine, world.wire.now_us);
    world.run_periods(test::LiveWorld::kStandPeriods);
    world.guard->reset(world.wire.now_us);
    ASSERT_NE(world.guard->guard().phase, GuardPhase::stopped);
    names_permits = true;
    world.run_periods(3);
    EXPECT_EQ(newest.status, AckStatus::unknown);
}

}  // namespace
}  // namespace axg
