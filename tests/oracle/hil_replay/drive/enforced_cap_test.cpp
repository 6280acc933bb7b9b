// SPDX-License-Identifier: Apache-2.0
// The deployed guard with guard.cap, of all axes and of single ones, in closed loop, positions
// alone and with commands ahead: both near programs get past the place where they are stopped
// without it, also while frames are lost; and a board that acknowledges what it does not keep is
// seen. AXG_COUNT: seconds of machine time at most. Figures: docs/measurements/cap.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "firmware_if/setup/guard_parts.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/drive/path_judge.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "tests/support/count.hpp"
#include "tests/support/example_programs.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualMachineSeconds = 20;  // both are stopped before without a cap

struct CapRun {
    DriveResult result;
    double seconds = 0, free_s = 0;
    bool has_contact = false;
};

struct CapCase {
    CapPromise promise = CapPromise::all_axes;
    CapFault fault = CapFault::none;
    double lost = 0, permit_lost = 0;
    std::uint32_t look_ahead_samples = 0;
};

CapRun drive_with(const Example& example, const CapCase& one) {
    CapRun run;
    LoadedMachine loaded;
    EXPECT_TRUE(load_example(example.machine, loaded));
    loaded.machine.guard.cap = one.promise;
    if (one.promise != CapPromise::none) {  // as the machine file is read
        loaded.machine.can.permit_samples = kPermitSamplesLonger;
    }
    if (one.look_ahead_samples != 0) {
        loaded.machine.can.format = CanFormat::fd;
        loaded.machine.can.look_ahead_samples = one.look_ahead_samples;
    }
    const Machine& machine = loaded.machine;
    const Program program = read_example(example.program, machine);
    GuardParts parts(loaded, true);
    EXPECT_TRUE(parts.fault().empty());
    GuardChain chain(machine, parts.engine->engine(), *parts.containment_test,
                     {parts.cycle.stop_certificate(), parts.cycle.speed_advisory()});
    PathJudge judge(machine, parts.engine->engine(), *parts.containment_test);
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    double share = 0, lost_s = 0;
    AxisShares axis_shares;
    const bool keeps = one.promise != CapPromise::none;
    const bool is_per_axis = one.promise == CapPromise::per_axis;
    double* const told = one.promise == CapPromise::all_axes ? &share : nullptr;
    DriveOptions options;
    options.board = promised_board(machine, 1);
    options.board.tick_us = kMotionStepUs;
    options.board.speed_share = told;
    options.board.axis_shares = is_per_axis ? &axis_shares : nullptr;
    options.board.cap_smooth_s = limits.smooth_s;
    options.board.cap_fault = one.fault;
    options.lost_s = keeps ? &lost_s : nullptr;
    options.faults.lost = one.lost;
    options.faults.permit_lost = one.permit_lost;
    options.time_us_max = static_cast<std::int64_t>(
                              count_from_environment(kUsualMachineSeconds, kUsualMachineSeconds)) *
                          1'000'000;
    DriveObservers observers;
    observers.watch = [&](std::int64_t time_us, std::span<const AxisMotion> axes) {
        const std::uint16_t tool = chain.snapshot().tool;
        judge.look(time_us, axes, tool == 0 ? machine.first_tool : tool);
    };
    run.result = drive(
        machine, chain, {program.start.data(), machine.axes.size()},
        make_program_motion(program, limits, motion, told, &lost_s, options.board.axis_shares),
        options, observers);
    run.seconds = 1e-6 * static_cast<double>(run.result.ended_us - run.result.moving_since_us);
    run.has_contact = judge.contact().has_value();
    std::printf(
        "%s, lost %.0f %%, permits lost %.0f %%: %s after %.2f s, %.2f s of it for the cap in %zu "
        "slow-downs; shortest permit %u; guard: %s, %s\n",
        example.program, 100 * one.lost, 100 * one.permit_lost, to_text(run.result.state),
        run.seconds, run.result.lost_s, run.result.slow_downs.size(), run.result.samples_least,
        to_text(run.result.guard_stop.cause), to_text(run.result.guard_stop.reason));
    return run;
}

class EnforcedCap : public testing::TestWithParam<Example> {};

TEST_P(EnforcedCap, PassesThePlaceWhereItWouldBeStopped) {
    const CapRun run = drive_with(GetParam(), {.lost = 0.01, .permit_lost = 0.01});
    EXPECT_EQ(run.result.cap_breaches, 0U) << "the board keeps less than it says";
    EXPECT_FALSE(run.has_contact);
    EXPECT_NE(run.result.state, BoardState::stopped);
    EXPECT_FALSE(run.result.slow_downs.empty());
}

// A bound, not the aim: figures are in docs/measurements/cap.md.
TEST_P(EnforcedCap, OfSingleAxesItLosesLittle) {
    const CapRun run = drive_with(GetParam(), {.promise = CapPromise::per_axis});
    EXPECT_EQ(run.result.cap_breaches, 0U) << "the board keeps less than it says";
    EXPECT_FALSE(run.has_contact);
    EXPECT_NE(run.result.state, BoardState::stopped);
    EXPECT_FALSE(run.result.slow_downs.empty());
    EXPECT_LT(run.result.lost_s, 0.4 * run.seconds);
}

TEST_P(EnforcedCap, WithCommandsAheadItLosesLess) {
    const CapRun run = drive_with(GetParam(), {.lost = 0.01, .look_ahead_samples = 300});
    EXPECT_EQ(run.result.cap_breaches, 0U) << "the board keeps less than it says";
    EXPECT_FALSE(run.has_contact);
    EXPECT_NE(run.result.state, BoardState::stopped);
    EXPECT_LT(run.result.lost_s, 0.3 * run.seconds);
}

TEST_P(EnforcedCap, ABoardThatKeepsNoCapOfSingleAxesIsSeenOrStopped) {
    for (const CapFault fault : {CapFault::late, CapFault::half, CapFault::ignores}) {
        const CapRun run =
            drive_with(GetParam(), {.promise = CapPromise::per_axis, .fault = fault});
        EXPECT_FALSE(run.has_contact);
        EXPECT_EQ(run.result.state, BoardState::stopped);
        EXPECT_EQ(run.result.guard_stop.reason, StopReason::left_cap);
    }
}

TEST_P(EnforcedCap, IsStoppedWithoutIt) {
    const CapRun run = drive_with(GetParam(), {.promise = CapPromise::none});
    EXPECT_EQ(run.result.guard_stop.reason, StopReason::predicted);
}

INSTANTIATE_TEST_SUITE_P(Near, EnforcedCap, testing::Values(kExamples[1], kExamples[4]),
                         [](const auto& example) { return name_of(example.param); });

}  // namespace
}  // namespace axg::test
