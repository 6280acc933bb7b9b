// SPDX-License-Identifier: Apache-2.0
// A broken limit in words: axis, figure and unit, what was declared, and what to do next.
#include "firmware_if/cli/limit_text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

const std::string kNext =
    ". Correct the limits of this axis in the machine file or in the control; axguard inspect "
    "--limits proposes values";

Machine two_axes() {
    Machine machine;
    machine.axes.resize(2);
    machine.axes[0].name = "X";
    machine.axes[1].name = "C";
    machine.axes[1].kind = AxisKind::rotary;
    return machine;
}

TEST(LimitText, NamesAxisFigureAndUnit) {
    const Machine machine = two_axes();
    EXPECT_EQ(
        limit_text(
            {.kind = LimitKind::acceleration, .axis = 0, .measured = 20'000, .declared = 4000},
            StopReason::left_limits, machine),
        "axis X: acceleration 20000 mm/s2, declared 4000 mm/s2" + kNext);
    EXPECT_EQ(
        limit_text({.kind = LimitKind::speed, .axis = 1, .measured = kPi, .declared = kPi / 2},
                   StopReason::left_limits, machine),
        "axis C: speed 180 deg/s, declared 90 deg/s" + kNext);
    EXPECT_EQ(limit_text({.kind = LimitKind::jerk, .axis = 0, .measured = 300, .declared = 200},
                         StopReason::left_limits, machine),
              "axis X: jerk 300 mm/s3, declared 200 mm/s3" + kNext);
    EXPECT_EQ(limit_text({.kind = LimitKind::speed_range, .axis = 0, .measured = 2.5},
                         StopReason::left_limits, machine),
              "axis X: contradictory bounds of its speed (by 2.5 mm/s)" + kNext);
    EXPECT_EQ(limit_text({.kind = LimitKind::acceleration_range, .axis = 1, .measured = kPi},
                         StopReason::left_limits, machine),
              "axis C: contradictory bounds of its acceleration (by 180 deg/s2)" + kNext);
}

TEST(LimitText, AStopOfTheBoardsOwnIsNoWrongLimit) {
    const Machine machine = two_axes();
    const LimitFact frozen{.kind = LimitKind::frozen_axis, .axis = 0, .measured = 95};
    EXPECT_EQ(limit_text(frozen, StopReason::own_stop, machine),
              "axis X: its position stands still, right after at least 95 mm/s (frozen_axis). The "
              "board stops by itself: at rest, arm it anew. If no person stopped it, check encoder "
              "and drive of this axis");
    EXPECT_EQ(limit_text(frozen, StopReason::left_limits, machine),
              "axis X: its position stands still, right after at least 95 mm/s (frozen_axis). The "
              "other axes went on: check encoder and drive of this axis");
    EXPECT_EQ(
        limit_text({.kind = LimitKind::stopping, .axis = 1, .measured = kPi, .declared = kPi / 2},
                   StopReason::left_limits, machine),
        "axis C: braked at 180 deg/s2, its hardest stop is 90 deg/s2 (stopping_most). The "
        "other axes went on: check encoder and drive of this axis");
}

TEST(LimitText, AStopThatWentTooFarLeadsToTheBoardTest) {
    EXPECT_EQ(limit_text({.kind = LimitKind::left_reach, .axis = 1, .measured = kPi / 180},
                         StopReason::left_limits, two_axes()),
              "axis C: 1 deg beyond where its last permit let it stop (left_reach). It braked late "
              "or softly: measure board_reaction_ms and stopping_... anew with axguardd board-test "
              "before arming");
}

TEST(LimitText, AnAxisThatIsNoneAndALineThatIsFullWriteNothingBeyondIt) {
    const Machine machine = two_axes();
    EXPECT_EQ(limit_text({.kind = LimitKind::speed, .axis = 7}, StopReason::left_limits, machine),
              "");
    std::array<char, 12> line{};
    const LimitFact fact{.kind = LimitKind::speed, .axis = 0, .measured = 2, .declared = 1};
    EXPECT_LE(format_limit(fact, StopReason::left_limits, machine, std::span(line).first(10)), 10U);
    EXPECT_EQ(line[10], 0);
}

}  // namespace
}  // namespace axg
