// SPDX-License-Identifier: Apache-2.0
// Which promises a machine file leaves out, and by how much farther a stop would lead without them:
// against numbers by hand.
#include "firmware_if/setup/unstated_promises.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/reach/stop_limits.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {
namespace {

/// X and Y: 500 mm/s, 4 m/s2, 50 m/s3, 3.5 m/s2, as on the paper's machine.
Machine paper_like() {
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.position_error = 0.001;
        if (axis.kind == AxisKind::linear) {
            axis.speed_max = axis.name == "X" ? 500 : 400;
            axis.acceleration_max = 4000;
            axis.jerk_max = 50'000;
            axis.stopping_min = 3500;
        }
    }
    return machine;
}

const UnstatedPromise* promise_of(const std::vector<UnstatedPromise>& all, const std::string& key) {
    for (const UnstatedPromise& one : all) {
        if (one.key == key) {
            return &one;
        }
    }
    return nullptr;
}

TEST(UnstatedPromises, AreThoseWithoutAValueOfTheirOwn) {
    Machine machine = paper_like();
    std::vector<std::string> keys;
    for (const UnstatedPromise& one : unstated_promises(machine)) {
        keys.push_back(one.key);
    }
    EXPECT_EQ(keys, (std::vector<std::string>{"guard.stop_reversal", "guard.board_reaction_ms",
                                              "guard.latch_jitter_us", "can.latched_age_us",
                                              "position_error_...", "following_error_..."}));
    machine.states = {.sample_us = true,
                      .latched_age_us = true,
                      .board_reaction_ms = true,
                      .latch_jitter_us = true,
                      .stop_reversal = true};
    for (Axis& axis : machine.axes) {
        axis.states_position_error = axis.states_following_error = true;
    }
    EXPECT_TRUE(unstated_promises(machine).empty());
}

/// A horizon of H leads v H far, and the axis may be braking from b^2 <= 2 j a H as well, by which
/// it stays at v for b / j.
double farther(double by_s) {
    const double v = 500, a = 4000, j = 50'000, h = 3 * 1.01e-3 + 20e-6 + 2e-3;
    return v * by_s + v / j * (std::sqrt(2 * j * a * (h + by_s)) - std::sqrt(2 * j * a * h));
}

TEST(UnstatedPromises, CostWhatAStopFromRapidWouldLeadFarther) {
    const Machine machine = paper_like();
    const std::vector<UnstatedPromise> all = unstated_promises(machine);
    const auto cost_of = [&](const char* key) {
        const UnstatedPromise* const one = promise_of(all, key);
        EXPECT_NE(one, nullptr) << key;
        EXPECT_EQ(machine.axes[one->axis].name, "X") << "it is the fastest";
        return one->cost;
    };
    EXPECT_NEAR(cost_of("guard.board_reaction_ms"), farther(2e-3), 1e-6);
    EXPECT_NEAR(cost_of("guard.latch_jitter_us"), farther(80e-6), 1e-6);
    EXPECT_NEAR(cost_of("can.latched_age_us"), farther(1.01e-3), 1e-6);
    EXPECT_NEAR(cost_of("following_error_..."), 500 * 1e-3, 1e-9);
    EXPECT_NEAR(cost_of("position_error_..."), 0.009, 1e-9);
}

// From rest with 4 m/s2: 16.9 mm while the jerk leads to -3.5 m/s2, and 0.2 mm from there.
TEST(UnstatedPromises, AStopThatTurnsAnAxisRoundCostsSeventeenMillimetres) {
    Machine machine = paper_like();
    EXPECT_NEAR(promise_of(unstated_promises(machine), "guard.stop_reversal")->cost, 17.08, 0.01);
    machine.guard.stop_reversal = StopReversal::jerk_limited;  // what it asks for already
    EXPECT_EQ(promise_of(unstated_promises(machine), "guard.stop_reversal"), nullptr);
}

TEST(UnstatedPromises, ADriveThatMayAnswerLateIsAskedForNothingMore) {
    Machine machine = paper_like();
    machine.can.latched_age = {0, machine.can.sample_us};
    EXPECT_EQ(promise_of(unstated_promises(machine), "can.latched_age_us"), nullptr);
}

// With SYNC of the guard no frame shows the timer of the board that ends a permit.
TEST(UnstatedPromises, ThePeriodIsOneWhereTheGuardSendsSync) {
    Machine machine = paper_like();
    machine.can.guard_sends_sync = true;
    machine.states.sample_us = true;
    const std::vector<UnstatedPromise> all = unstated_promises(machine);
    ASSERT_NE(promise_of(all, "can.sample_us"), nullptr);
    EXPECT_NEAR(promise_of(all, "can.sample_us")->cost, farther(3 * 1.01 * 39e-6), 1e-6);
}

TEST(UnstatedPromises, RotaryAxesCountWhereNoAxisIsLinear) {
    Machine machine = paper_like();
    std::erase_if(machine.axes, [](const Axis& axis) { return axis.kind == AxisKind::linear; });
    const std::vector<UnstatedPromise> all = unstated_promises(machine);
    const UnstatedPromise* const reaction = promise_of(all, "guard.board_reaction_ms");
    ASSERT_NE(reaction, nullptr);
    EXPECT_NE(format_promise(machine, *reaction).find(" deg later"), std::string::npos);
}

TEST(UnstatedPromises, AreALineEach) {
    const Machine machine = paper_like();
    EXPECT_EQ(format_promise(machine, unstated_promises(machine)[1]),
              "guard.board_reaction_ms: 2 assumed; with 4 X stops 3.58 mm later");
}

}  // namespace
}  // namespace axg::test
