// SPDX-License-Identifier: Apache-2.0
// Random frames under the id of an operator's messages: noise, sealed messages with any content,
// and confirmations that are right but for one thing. None resets, none arms; the one that is right
// in all does. AXG_COUNT frames in each phase.
#include <gtest/gtest.h>

#include <random>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/support/count.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/operator_panel.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr int kFramesAPeriod = 10;

class OperatorNoise : public testing::Test {
  protected:
    OperatorNoise() {
        world.options = {};
        world.stands_still = true;
        world.start();
        world.run_periods(300);
    }
    static Machine machine_of() {
        Machine machine = test::five_axis_machine(CanFormat::classical);
        return machine;
    }
    template <class Value>
    Value any() {
        return static_cast<Value>(random());
    }
    GuardPhase phase() const { return world.guard->guard().phase; }

    axg_operator_message any_message() {
        return {.action = any<bool>() ? AXG_OPERATOR_ARM : AXG_OPERATOR_RESET,
                .step = random() % 4 == 0 ? AXG_OPERATOR_REQUEST : AXG_OPERATOR_CONFIRM,
                .stands = any<bool>(),
                .counter = random() % 4 == 0 ? any<std::uint8_t>() : next_counter,
                .nonce = any<std::uint32_t>() & 0xFFFFFFU};
    }
    /// The newest request of the guard's status, confirmed; nothing where none waits.
    std::optional<axg_operator_message> right_message() const {
        for (auto sent = world.wire.sent.rbegin(); sent != world.wire.sent.rend(); ++sent) {
            const auto status = test::status_in(*sent);
            if (sent->id != 0x604 || !status) {
                continue;
            }
            if (status->action == AXG_OPERATOR_NOTHING) {
                return std::nullopt;
            }
            return axg_operator_message{.action = status->action,
                                        .step = AXG_OPERATOR_CONFIRM,
                                        .stands = false,
                                        .counter = next_counter,
                                        .nonce = status->nonce};
        }
        return std::nullopt;
    }
    CanFrame any_frame() {
        const std::int64_t now_us = world.wire.now_us;
        const auto right = right_message();
        CanFrame frame;
        switch (random() % 4) {
            case 0:
                frame.id = 0x584;
                frame.length_bytes = 8;
                frame.time_us = now_us;
                for (std::uint8_t& byte : std::span(frame.data).first(8)) {
                    byte = any<std::uint8_t>();
                }
                return frame;
            case 1: {  // right but for some bits of it, sealed or not
                axg_operator_message message = right.value_or(any_message());
                message.nonce ^= 1U << random() % 24;
                frame = test::operator_frame(message, now_us);
                return frame;
            }
            case 2: {
                frame = test::operator_frame(right.value_or(any_message()), now_us);
                frame.data[random() % 8] ^= static_cast<std::uint8_t>(1U << random() % 8);
                return frame;
            }
            default: {
                axg_operator_message message = any_message();
                // A guess that is right would be no fault: once in 16.7 million.
                if (right && message.nonce == right->nonce) {
                    message.nonce ^= 1U;
                }
                return test::operator_frame(message, now_us);
            }
        }
    }
    /// What the guard takes for the last counter.
    void note_counter(const CanFrame& frame) {
        OperatorMessage read;
        if (decode_operator_message(world.machine.can, frame, read) == FrameStatus::ok) {
            next_counter = (read.counter + 1) & 15U;
        }
    }
    void expect_nothing_acts() {
        const GuardPhase before = phase();
        const std::uint64_t frames = test::count_from_environment(1'000'000);
        for (std::uint64_t i = 0; i < frames; i += kFramesAPeriod) {
            for (int k = 0; k < kFramesAPeriod; ++k) {
                const CanFrame frame = any_frame();
                note_counter(frame);
                world.wire.arrive(frame);
            }
            world.run_periods(1);
            ASSERT_EQ(phase(), before) << "after frame " << i;
            if (world.wire.sent.size() > 10'000) {
                world.wire.sent.erase(world.wire.sent.begin(), world.wire.sent.end() - 1000);
            }
        }
        const LiveCounters& counters = world.guard->counters();
        EXPECT_EQ(counters.operator_acts, 0U);
        EXPECT_GT(counters.operator_refused, frames / 20);
        EXPECT_GT(counters.operator_ignored, frames / 20);
    }
    void expect_the_right_one_acts(axg_operator_action action, GuardPhase wanted) {
        test::OperatorPanel panel{.counter = next_counter};
        world.wire.arrive(panel.request(action, world.wire.now_us));
        world.run_periods(20);
        next_counter = panel.counter;
        const auto right = right_message();
        ASSERT_TRUE(right);
        world.wire.arrive(test::operator_frame(*right, world.wire.now_us));
        world.run_periods(2);
        EXPECT_EQ(phase(), wanted);
        EXPECT_EQ(world.guard->counters().operator_acts, 1U);
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{machine_of(), latch};
    std::mt19937_64 random{test::printed_seed(584)};
    std::uint8_t next_counter = 0;
};

TEST_F(OperatorNoise, NeverArms) {
    ASSERT_EQ(phase(), GuardPhase::ready);
    expect_nothing_acts();
    expect_the_right_one_acts(AXG_OPERATOR_ARM, GuardPhase::armed);
}

TEST_F(OperatorNoise, NeverResets) {
    world.guard->report(GuardFault::refused, world.wire.now_us);
    world.run_periods(300);
    ASSERT_EQ(phase(), GuardPhase::stopped);
    expect_nothing_acts();
    EXPECT_TRUE(is_latched(latch));
    expect_the_right_one_acts(AXG_OPERATOR_RESET, GuardPhase::selftest);
    EXPECT_FALSE(is_latched(latch));
}

// Noise under the id of the guard's own status is a second guard, whatever its bytes are.
TEST_F(OperatorNoise, UnderTheIdOfTheStatusStops) {
    CanFrame frame;
    frame.id = 0x604;
    frame.length_bytes = 8;
    frame.time_us = world.wire.now_us;
    for (std::uint8_t& byte : std::span(frame.data).first(8)) {
        byte = any<std::uint8_t>();
    }
    world.wire.arrive(frame);
    world.run_periods(1);
    EXPECT_EQ(phase(), GuardPhase::stopped);
    EXPECT_EQ(world.guard->guard().cause, GuardFault::second_guard);
}

}  // namespace
}  // namespace axg
