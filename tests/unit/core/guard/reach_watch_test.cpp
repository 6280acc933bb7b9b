// SPDX-License-Identifier: Apache-2.0
// A stop that leads out of the reaches of all last permits is named, with its axis and distance;
// one that stays in any of them is not. In closed loop: long_stop_test.
#include "core/guard/reach_watch.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "core/base/sincos.hpp"
#include "core/guard/cap_guard.hpp"

namespace axg {
namespace {

constexpr double kErrorMm = 0.01;

Machine two_axes() {
    Machine machine;
    machine.axes.resize(2);
    for (Axis& axis : machine.axes) {
        axis.speed_max = 500;
        axis.acceleration_max = axis.stopping_min = 5000;
    }
    machine.axes[1].kind = AxisKind::rotary;
    machine.axes[1].unlimited = true;
    machine.can.permit_samples = {3, 12};
    return machine;
}

struct WatchBench {
    explicit WatchBench(Machine of = two_axes()) : machine(std::move(of)), watch(machine) {}

    /// One sample further; with `reach` the proof gives a permit.
    CycleResult step(double x, double c, const JointBox* reach, bool is_armed = true) {
        ++snapshot.sample;
        snapshot.position[0] = x;
        snapshot.position[1] = c;
        std::array<double, kAxesMax> errors{};
        errors.fill(kErrorMm);
        watch.note(snapshot, is_first, errors);
        is_first = false;
        CycleResult result;
        result.has_permit = reach != nullptr;
        result.reason = reach != nullptr ? StopReason::none : StopReason::predicted;
        watch.judge(reach != nullptr ? *reach : JointBox{}, is_armed, result);
        return result;
    }
    static JointBox around(double x, double half) {
        return {.centre = {x, 0}, .half = {half, 0.1}};
    }

    Machine machine;
    ReachWatch watch;
    AxisSnapshot snapshot{.mode = kModeMoving};
    bool is_first = false;
};

TEST(ReachWatch, AStopBeyondEveryReachIsNamedWithItsFarthestDistance) {
    WatchBench bench;
    const JointBox reach = WatchBench::around(0, 5);
    EXPECT_TRUE(bench.step(0, 0, &reach).has_permit);
    EXPECT_EQ(bench.step(5 + 0.9 * kErrorMm, 0, nullptr).reason, StopReason::predicted);
    const CycleResult out = bench.step(5.26, 0, nullptr);
    EXPECT_EQ(out.reason, StopReason::left_limits);
    EXPECT_EQ(out.limit.kind, LimitKind::left_reach);
    EXPECT_EQ(out.limit.axis, 0U);
    EXPECT_NEAR(out.limit.measured, 0.25, 1e-9);
    EXPECT_TRUE(out.is_stop);
    EXPECT_FALSE(out.has_permit);
    // It stays named, with the farthest distance, though the axis turned back.
    EXPECT_NEAR(bench.step(4, 0, nullptr).limit.measured, 0.25, 1e-9);
    EXPECT_FALSE(bench.step(4, 0, &reach).has_permit) << "a person has to see it first";
}

TEST(ReachWatch, AnyPermitThatMayBeInForceCoversTheStop) {
    WatchBench bench;
    const JointBox wide = WatchBench::around(0, 5), narrow = WatchBench::around(1, 0.5);
    (void)bench.step(0, 0, &wide);
    (void)bench.step(1, 0, &narrow);
    EXPECT_EQ(bench.step(4, 0, nullptr).reason, StopReason::predicted);
    for (int n = 0; n < 16; ++n) {  // the wide one has ended
        EXPECT_TRUE(bench.step(1, 0, &narrow).has_permit);
    }
    EXPECT_EQ(bench.step(4, 0, nullptr).limit.kind, LimitKind::left_reach);
}

TEST(ReachWatch, AnEndlessAxisCountsByItsPlaceOnTheCircle) {
    WatchBench bench;
    const JointBox reach = WatchBench::around(0, 5);
    (void)bench.step(0, 0, &reach);
    EXPECT_EQ(bench.step(0, 2 * kPi + 0.05, nullptr).reason, StopReason::predicted);
    const CycleResult out = bench.step(0, 2 * kPi - 0.2, nullptr);
    EXPECT_EQ(out.limit.axis, 1U);
    EXPECT_NEAR(out.limit.measured, 0.09, 1e-9);
}

TEST(ReachWatch, StandstillEndsItOnceNoPermitIsInForce) {
    const JointBox reach = WatchBench::around(0, 5);
    for (const int waited : {3, 20}) {
        WatchBench bench;
        bench.snapshot.mode = kModeStandstill;
        (void)bench.step(0, 0, &reach);
        for (int n = 0; n < waited; ++n) {
            (void)bench.step(0, 0, nullptr);
        }
        bench.snapshot.mode = kModeMoving;  // early: by the permit; late: by hand
        EXPECT_EQ(bench.step(9, 0, nullptr).reason,
                  waited < 16 ? StopReason::left_limits : StopReason::predicted)
            << waited;
    }
}

TEST(ReachWatch, NothingIsComparedWithoutAPermitThatWasSent) {
    const JointBox reach = WatchBench::around(0, 5);
    WatchBench unarmed;
    (void)unarmed.step(0, 0, &reach, false);
    EXPECT_EQ(unarmed.step(9, 0, nullptr).reason, StopReason::predicted);

    WatchBench restarted;
    (void)restarted.step(0, 0, &reach);
    restarted.is_first = true;
    EXPECT_EQ(restarted.step(9, 0, nullptr).reason, StopReason::predicted);

    WatchBench recorded;
    recorded.watch.ignore();
    (void)recorded.step(0, 0, &reach);
    EXPECT_EQ(recorded.step(9, 0, nullptr).reason, StopReason::predicted);

    Machine reports = two_axes();
    reports.guard.reports_limits = true;
    WatchBench reporting(reports);
    (void)reporting.step(0, 0, &reach);
    EXPECT_EQ(reporting.step(9, 0, nullptr).reason, StopReason::predicted);
}

TEST(ReachWatch, PositionsThatMayBeOlderThanThePermitAreNotCompared) {
    Machine machine = two_axes();
    machine.can.latched_age = {0, machine.can.sample_us};
    const JointBox reach{.centre = {2, 0}, .half = {1, 0.1}};
    WatchBench bench(machine);
    (void)bench.step(2, 0, &reach);
    EXPECT_EQ(bench.step(0.5, 0, nullptr).reason, StopReason::predicted) << "of a period before";
    for (std::uint32_t n = 0; n < age_samples(machine); ++n) {
        (void)bench.step(2, 0, nullptr);
    }
    EXPECT_EQ(bench.step(0.5, 0, nullptr).limit.kind, LimitKind::left_reach);
}

}  // namespace
}  // namespace axg
