// SPDX-License-Identifier: Apache-2.0
// A certificate rests on declared limits: where an axis breaks one there is no permit, and an armed
// guard stops with axis and figure. A guard that believes wider limits, made here, goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/certificate/stop_certificate.hpp"
#include "core/guard/monitor.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

class LeftLimits : public testing::Test {
  protected:
    LeftLimits() { m.tools.resize(1); }
    void make() { certificate.emplace(certificate_over(scene, m)); }
    void note(double x) {
        AxisSnapshot snapshot;
        snapshot.sample = ++sample;
        snapshot.axis_count = 5;
        snapshot.tool = 1;
        snapshot.position[0] = x;
        certificate->note(snapshot, sample == 1);
    }
    CycleResult cycle(bool is_armed = true) {
        certificate->prove(scene.engine().engine(), scene.containment_test());
        certificate->keep();
        return judge(certificate->cycle(), true, is_armed);
    }
    /// At rest for 40 samples, then along X; the first stop, or none within so many samples.
    std::optional<CycleResult> first_stop(int samples,
                                          const std::function<double(double)>& x_after) {
        make();
        sample = 0;
        for (int i = 0; i < 40; ++i) {
            note(0);
            EXPECT_EQ(cycle(i > 20).is_stop, false) << "at rest";
        }
        for (int i = 1; i <= samples; ++i) {
            note(x_after(i * 1e-3));
            const CycleResult result = cycle();
            if (result.is_stop) {
                stopped_after = i;
                return result;
            }
        }
        return {};
    }

    Machine m = table_and_head_machine();
    ContainmentScene scene = table_and_head_scene();
    std::optional<StopCertificate> certificate;
    std::uint64_t sample = 0;
    int stopped_after = 0;
};

TEST_F(LeftLimits, FiveTimesTheAccelerationStops) {
    const double a = m.axes[0].acceleration_max;
    const auto racing = [a](double t) { return 0.5 * 5 * a * t * t; };
    const std::optional<CycleResult> stop = first_stop(15, racing);
    ASSERT_TRUE(stop);
    EXPECT_FALSE(stop->has_permit);
    EXPECT_EQ(stop->reason, StopReason::left_limits);
    EXPECT_STREQ(to_text(stop->reason), "left_limits");
    EXPECT_LE(stopped_after, 3);
    EXPECT_EQ(stop->pair, kNoIndex);
    EXPECT_EQ(stop->limit.axis, 0U);
    EXPECT_EQ(stop->limit.declared, a);
    EXPECT_GT(stop->limit.measured, 2 * a);
    EXPECT_LE(stop->limit.measured, 5 * a);
    m.axes[0].acceleration_max = 6 * a;
    m.axes[0].jerk_max = 1e9;
    EXPECT_FALSE(first_stop(8, racing)) << "a guard that believes six times as much";
}

TEST_F(LeftLimits, AGuardThatOnlyReportsGoesOn) {
    m.guard.reports_limits = true;
    const double a = m.axes[0].acceleration_max;
    EXPECT_FALSE(first_stop(15, [a](double t) { return 0.5 * 5 * a * t * t; }));
}

TEST_F(LeftLimits, AStepFromRestToRestStops) {
    const auto step = [](double) { return 0.4; };
    const std::optional<CycleResult> stop = first_stop(15, step);
    ASSERT_TRUE(stop);
    EXPECT_EQ(stop->reason, StopReason::left_limits);
    EXPECT_EQ(stopped_after, 1);
    EXPECT_EQ(stop->limit.axis, 0U);
}

TEST_F(LeftLimits, MotionWithinTheLimitsGoesOn) {
    const double j = m.axes[0].jerk_max;
    EXPECT_FALSE(first_stop(30, [j](double t) { return j * t * t * t / 6; }));
}

TEST_F(LeftLimits, BeforeArmingItKeepsThePermitBack) {
    make();
    for (int i = 0; i < 20; ++i) {
        note(0);
    }
    note(0.4);
    const CycleResult result = cycle(false);
    EXPECT_EQ(result.reason, StopReason::left_limits);
    EXPECT_FALSE(result.has_permit);
    EXPECT_FALSE(result.is_stop);
    EXPECT_TRUE(judge(certificate->cycle(), true, true).is_stop);
}

TEST_F(LeftLimits, AReceiverThatBeginsAnewForgets) {
    make();
    for (int i = 0; i < 20; ++i) {
        note(0);
    }
    sample = 0;
    note(0.4);
    note(0.4);
    EXPECT_EQ(cycle().reason, StopReason::none);
}

// Of several snapshots that wait the newest alone is judged: a fact waits for that.
TEST_F(LeftLimits, AFactIsNotLostBetweenTwoCycles) {
    m.can.sample_us = 250;
    make();
    for (int i = 0; i < 200; ++i) {
        note(0);
    }
    for (int i = 0; i < 600; ++i) {  // by now the window shows nothing of the step
        note(0.4);
    }
    EXPECT_EQ(cycle().reason, StopReason::left_limits);
    EXPECT_EQ(cycle().reason, StopReason::left_limits) << "the same for the same snapshots";
    for (int i = 0; i < 400; ++i) {
        note(0.4);
        (void)cycle();
    }
    EXPECT_EQ(cycle().reason, StopReason::none) << "at rest for long";
}

// A stop of the board's own is harder than free motion: what its positions say of the speed is
// wrong, though no bound contradicts another, so the certificate takes the whole range.
TEST_F(LeftLimits, InAStopOfTheBoardsOwnTheWholeRangeOfSpeedCounts) {
    m.guard.free_jerk_limited = false;
    make();
    const Axis& axis = m.axes[0];
    const double v = 0.6 * axis.speed_max, d = 1.1 * axis.acceleration_max;
    const double begins_s = 0.04, stops_s = v / d;
    for (int i = 0; i < 160; ++i) {
        const double t = i * 1e-3, braking = std::clamp(t - begins_s, 0.0, stops_s);
        note(v * std::min(t, begins_s) + v * braking - 0.5 * d * braking * braking);
        EXPECT_NE(cycle().reason, StopReason::left_limits) << i;
        const AxisRange now = certificate->now(0);
        const bool is_whole = now.speed_high == axis.speed_max && now.speed_low == -axis.speed_max;
        if (t > begins_s + 0.022 && t < begins_s + stops_s + 0.010) {
            EXPECT_TRUE(is_whole) << i;
        } else if ((i > 20 && t < begins_s) || t > begins_s + stops_s + 0.040) {
            EXPECT_FALSE(is_whole) << i;
        }
    }
}

}  // namespace
}  // namespace axg::test
