// SPDX-License-Identifier: Apache-2.0
// How near the ranges of speed come to what no observer of positions can know: an axis that rests,
// and one that rests an error below, then speeds up to an error above, report the same positions.
// docs/theory/certificate.md, "Speed from positions".
#include "core/reach/motion_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace axg::test {
namespace {

constexpr double kStepS = 1e-3, kLatchJitterS = 2e-5;
constexpr double kMostRatio = 1.15;

struct HiddenCase {
    double error_mm, acceleration, jerk, speed;
};

/// The range after more samples than are kept, of an axis at this speed.
AxisRange steady_range(const HiddenCase& one, bool is_jerk_limited, double period_share) {
    MotionHistory history;
    AxisSnapshot snapshot;
    snapshot.axis_count = 1;
    for (std::uint64_t k = 1; k <= 2 * kSamplesKept; ++k) {
        snapshot.sample = k;
        snapshot.position[0] = one.speed * kStepS * static_cast<double>(k);
        note_snapshot(history, snapshot, history_stride(kStepS));
    }
    const AxisLimits limits{
        .speed_max = 1000, .acceleration_max = one.acceleration, .jerk_max = one.jerk};
    return find_range(history, 0, limits, false,
                      {.period_s = kStepS,
                       .period_share = period_share,
                       .latch_jitter_s = kLatchJitterS,
                       .position = one.error_mm,
                       .is_jerk_limited = is_jerk_limited})
        .range;
}

/// Speed that the positions hide: of rest at -e', then the acceleration, up to +e'.
double hidden_speed(const HiddenCase& one) {
    const double error_mm = one.error_mm + 0.5 * one.speed * kLatchJitterS;
    return 2 * std::sqrt(one.acceleration * error_mm);
}

/// The time in which that happens.
double hidden_s(const HiddenCase& one) {
    return hidden_speed(one) / one.acceleration;
}

/// Largest and least ratio over errors, accelerations and speeds whose hidden motion takes from one
/// stride to all that are kept.
struct Ratios {
    double least = 1e9, most = 0;
    unsigned cases = 0;
};
Ratios ratios(bool is_jerk_limited, double speed, double period_share) {
    Ratios out;
    for (double error_mm = 1e-4; error_mm < 0.2; error_mm *= 1.3) {
        for (double acceleration = 200; acceleration < 20'000; acceleration *= 1.2) {
            const HiddenCase one{error_mm, acceleration, 50 * acceleration, speed};
            if (hidden_s(one) < kStepS || hidden_s(one) > (kSamplesKept - 1) * kStepS) {
                continue;
            }
            const AxisRange range = steady_range(one, is_jerk_limited, period_share);
            const double ratio = 0.5 * (range.speed_high - range.speed_low) / hidden_speed(one);
            out.least = std::min(out.least, ratio);
            out.most = std::max(out.most, ratio);
            ++out.cases;
        }
    }
    return out;
}

// At rest with the period's own error, moving without it: 1 % of a speed is no error of a position.
TEST(MotionHistoryBound, RangesAreAtMostAFewPercentWiderThanWhatNoObserverKnows) {
    for (const bool is_jerk_limited : {false, true}) {
        for (const double speed : {0.0, 10.0, 100.0}) {
            const Ratios found = ratios(is_jerk_limited, speed, speed == 0 ? kPeriodShare : 0);
            RecordProperty(std::string(is_jerk_limited ? "limited" : "any") + "_at_" +
                               std::to_string(static_cast<int>(speed)),
                           std::to_string(found.most));
            EXPECT_GT(found.cases, 300U);
            EXPECT_LE(found.most, kMostRatio) << is_jerk_limited << " at " << speed;
            if (!is_jerk_limited) {
                EXPECT_GE(found.least, 1) << "a range below the bound would be wrong, at " << speed;
            }
        }
    }
}

// Both motions stay within the error of the same reports, and the range holds the speeds of both.
TEST(MotionHistoryBound, TheHiddenSpeedIsInTheRangeOfAnAxisThatRests) {
    const HiddenCase one{.error_mm = 0.01, .acceleration = 1000, .jerk = 50'000, .speed = 0};
    const AxisRange range = steady_range(one, false, kPeriodShare);
    EXPECT_GE(range.speed_high, hidden_speed(one));
    EXPECT_LE(range.speed_low, -hidden_speed(one));
    const double travelled_mm = 0.5 * one.acceleration * hidden_s(one) * hidden_s(one);
    EXPECT_NEAR(travelled_mm, 2 * one.error_mm, 1e-12) << "from -e to +e";
}

}  // namespace
}  // namespace axg::test
