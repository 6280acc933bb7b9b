// SPDX-License-Identifier: Apache-2.0
// The look-ahead path by hand: what is kept of it, what bridges a hole, how far along it a stop can
// still go, and when the axes have left it.
#include "core/reach/look_ahead_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/sincos.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kAxisZ = 2, kAxisC = 4;
constexpr double kPeriodS = 1e-3;
constexpr double kLongestS = 1.01 * kPeriodS;

class LookAheadPathTest : public testing::Test {
  protected:
    LookAheadPathTest() {
        m.can.format = CanFormat::fd;
        m.can.look_ahead_samples = 300;
        m.guard.free_jerk_limited = true;
        make();
    }
    void make() {
        path.reset();
        path.emplace(*LookAheadPath::create(m, options));
    }
    /// Z goes down at `speed` from 0 at sample 0; everything else stands.
    static PathPoints straight(std::uint64_t sample, double speed) {
        PathPoints points;
        points.sample = sample;
        points.position[kAxisZ] = -speed * kPeriodS * static_cast<double>(sample);
        points.before[kAxisZ] = -speed * kPeriodS * static_cast<double>(sample - 1);
        return points;
    }
    void note_path(std::uint64_t from, std::uint64_t to, double speed) {
        for (std::uint64_t k = from; k <= to; ++k) {
            ASSERT_TRUE(path->note_path(straight(k, speed)));
        }
    }

    Machine m = motion_test_machine();
    PathOptions options;
    std::optional<LookAheadPath> path;
};

// The rate falls from 1 by steps of a microsecond; deceleration 1 / p, jerk 1 / z.
double braked(double p, double z) {
    double rate = 1, deceleration = 0, covered = 0;
    constexpr double kStepS = 1e-6;
    while (rate > 0) {
        deceleration = std::min(1 / p, deceleration + kStepS / z);
        rate -= deceleration * kStepS;
        covered += std::max(0.0, rate) * kStepS;
    }
    return covered;
}

TEST(PathBraking, IsWhatSmallStepsComeTo) {
    for (const double p : {0.01, 0.1, 0.4}) {
        for (const double z : {1e-5, 1e-3, 2 * p * p, 0.05}) {
            EXPECT_NEAR(path_braking_s(p, z), braked(p, z), 3e-6) << p << ' ' << z;
        }
    }
    EXPECT_EQ(path_braking_s(0, 0), 0);
    EXPECT_NEAR(path_braking_s(0.1, 0), 0.05, 1e-12);
}

TEST(PathBraking, IsNeverLessForMoreOfEither) {
    for (double p = 0.001; p < 0.5; p *= 1.3) {
        for (double z = 1e-6; z < 0.1; z *= 1.3) {
            EXPECT_GE(path_braking_s(1.3 * p, z), path_braking_s(p, z));
            EXPECT_GE(path_braking_s(p, 1.3 * z), path_braking_s(p, z));
        }
    }
}

// At a steady 150 mm/s: 100 ms to stop at 1500 mm/s2, half of that on the path, and the ramp.
TEST_F(LookAheadPathTest, AStretchIsTheHorizonAndTheStop) {
    note_path(1, 300, 150);
    const PathStretch stretch = path->stretch(100, 5e-3);
    ASSERT_TRUE(stretch.is_known);
    const double steady = 5 + path_braking_s(150.0 / 1500, 150.0 / 50000) / kPeriodS;
    EXPECT_GE(stretch.end, steady);
    EXPECT_LE(stretch.end, steady * 1.002);
    // Without a limit of jerk the speed may be larger between two points by half a period's worth.
    m.guard.free_jerk_limited = false;
    const double looser = path->stretch(100, 5e-3).end;
    EXPECT_GE(looser, 5 + path_braking_s(151.0 / 1500, 151.0 / 50000) / kPeriodS - 1e-6);
    EXPECT_GT(looser, stretch.end);
}

TEST_F(LookAheadPathTest, ThePathMustReachAsFarAsTheStop) {
    note_path(1, 300, 150);
    const double end = path->stretch(100, 5e-3).end;
    const auto last = static_cast<std::uint64_t>(300 - std::ceil(end));
    EXPECT_TRUE(path->stretch(last, 5e-3).is_known);
    EXPECT_FALSE(path->stretch(last + 1, 5e-3).is_known);
    EXPECT_FALSE(path->stretch(301, 5e-3).is_known);
    path->clear();
    EXPECT_FALSE(path->stretch(100, 5e-3).is_known);
}

TEST_F(LookAheadPathTest, ThePiecesCoverTheWayAndNoMore) {
    m.axes[kAxisZ].following_error = 0.02;
    options.count[kAxisZ] = 0.0001;
    make();
    note_path(1, 300, 150);
    const PathStretch stretch = path->stretch(100, 5e-3);
    std::array<JointBox, kPathPieces> pieces;
    path->cut(100, stretch.end, pieces);
    const double bulge = 2000 * kLongestS * kLongestS / 8;
    const double wide = 0.02 + 0.00005 + bulge;
    EXPECT_NEAR(pieces[0].centre[kAxisZ] + pieces[0].half[kAxisZ], -0.15 * 100 + wide, 1e-7);
    EXPECT_NEAR(pieces[0].centre[kAxisZ] - pieces[0].half[kAxisZ],
                -0.15 * (100 + stretch.end) - wide, 1e-7);
    EXPECT_NEAR(pieces[0].half[0], bulge, 1e-7) << "an axis that stands: what it may bulge";
    for (std::uint32_t i = 0; i < kPathPieces / 2; ++i) {
        for (const std::uint32_t child : {2 * i + 1, 2 * i + 2}) {
            EXPECT_GE(pieces[i].half[kAxisZ] - pieces[child].half[kAxisZ],
                      std::abs(pieces[i].centre[kAxisZ] - pieces[child].centre[kAxisZ]) - 1e-12);
        }
    }
    // The leaves follow each other without a hole, each a 64th of the way.
    for (std::uint32_t i = kPathLeaves - 1; i + 1 < kPathPieces; ++i) {
        EXPECT_GE(pieces[i].half[kAxisZ] + pieces[i + 1].half[kAxisZ],
                  std::abs(pieces[i].centre[kAxisZ] - pieces[i + 1].centre[kAxisZ]) + 2 * bulge);
        EXPECT_NEAR(pieces[i].half[kAxisZ], 0.5 * 0.15 * stretch.end / kPathLeaves + wide, 1e-7);
    }
}

TEST_F(LookAheadPathTest, OneFrameLostCostsNothingAndTwoAreBridged) {
    for (std::uint64_t k = 1; k <= 300; ++k) {
        if (k != 50 && k != 120 && k != 121) {
            ASSERT_TRUE(path->note_path(straight(k, 150)));
        }
    }
    EXPECT_DOUBLE_EQ(path->at(50)[kAxisZ], -7.5) << "the next frame says it too";
    EXPECT_NEAR(path->at(120)[kAxisZ], -18, 1e-12) << "half way";
    std::array<JointBox, kPathPieces> whole, bridged;
    path->cut(30, 2, whole);
    path->cut(119, 2, bridged);
    EXPECT_NEAR(bridged[0].half[kAxisZ] - whole[0].half[kAxisZ],
                3 * 2000 * kLongestS * kLongestS / 8, 1e-9)
        << "the chord of two periods bulges four times as much";
    EXPECT_GT(path->stretch(100, 5e-3).end, path->stretch(130, 5e-3).end);
}

// Points on either side of a hole say what the axis may accelerate by in it, and jerk adds little:
// a stop from there leads about as far as from anywhere else.
TEST_F(LookAheadPathTest, AHoleWidensTheReachOfAStopByWhatTheJerkMayDoInIt) {
    const auto reach_at = [this](std::uint64_t sample) {
        std::array<JointBox, kReachPieces> pieces;
        EXPECT_TRUE(path->reach(sample, 8e-3, pieces));
        return pieces[0].half[kAxisZ];
    };
    for (std::uint64_t k = 1; k <= 300; ++k) {
        if (k != 120 && k != 121) {
            ASSERT_TRUE(path->note_path(straight(k, 50)));
        }
    }
    const double whole = reach_at(30), with_hole = reach_at(115);
    m.guard.free_jerk_limited = false;
    make();
    note_path(1, 300, 50);
    const double any_acceleration = reach_at(30);
    EXPECT_GT(with_hole, whole);
    EXPECT_LT(with_hole - whole, 0.25 * (any_acceleration - whole));
}

// A board whose period is 1 % longer, at full acceleration through a hole: found from outside,
// where the chord was taken to be as long as the nominal period says.
TEST_F(LookAheadPathTest, AChordBulgesByTheLongestPeriod) {
    for (const std::uint64_t gap : {4U, 16U, 64U}) {
        path.reset();
        path.emplace(*LookAheadPath::create(m, options));
        const auto at = [](double period) {
            const double t = period * kLongestS;
            return 10 * t + 0.5 * 2000 * t * t;
        };
        for (std::uint64_t k = 96; k <= 170; ++k) {
            PathPoints points;
            points.sample = k;
            points.position[kAxisZ] = at(static_cast<double>(k) - 96);
            points.before[kAxisZ] = at(static_cast<double>(k) - 97);
            if (k <= 100 || k > 100 + gap) {
                ASSERT_TRUE(path->note_path(points)) << k;
            }
        }
        const std::uint64_t middle = 100 + gap / 2;
        std::array<JointBox, kReachPieces> pieces;
        ASSERT_TRUE(path->reach(middle, 8e-3, pieces));
        double outside = HUGE_VAL;
        for (std::size_t i = kReachLeaves - 1; i < kReachPieces; ++i) {
            const double away =
                std::abs(at(static_cast<double>(middle) - 96) - pieces[i].centre[kAxisZ]);
            outside = std::min(outside, away - pieces[i].half[kAxisZ]);
        }
        EXPECT_LE(outside, 0) << "a hole of " << gap << " periods";
    }
}

TEST_F(LookAheadPathTest, ItsEndSaysHowTheAxisGoesOn) {
    EXPECT_FALSE(path->end(kAxisZ));
    note_path(1, 1, 50);
    EXPECT_FALSE(path->end(kAxisZ)) << "one step says nothing about a speed before";
    note_path(2, 40, 50);
    const auto end = path->end(kAxisZ);
    ASSERT_TRUE(end);
    EXPECT_NEAR(0.5 * (end->low + end->high), -0.05 * 39, 1e-9) << "a period before the last point";
    EXPECT_LT(end->speed_low, -50);
    EXPECT_GT(end->speed_high, -50);
    EXPECT_LT(end->speed_high - end->speed_low, 10);
    EXPECT_LT(end->acceleration_high - end->acceleration_low, 400);
    path->clear();
    EXPECT_FALSE(path->end(kAxisZ));
}

TEST_F(LookAheadPathTest, ALargeHoleLeavesNothingBeforeIt) {
    note_path(1, 100, 150);
    ASSERT_TRUE(path->note_path(straight(100 + kPathGapMax + 1, 150)));
    EXPECT_TRUE(path->holds(100)) << "64 periods from 100 to the nearer point: bridged";
    ASSERT_TRUE(path->note_path(straight(400, 150)));
    EXPECT_FALSE(path->holds(150));
    EXPECT_FALSE(path->stretch(150, 5e-3).is_known);
    EXPECT_TRUE(path->holds(399));
}

TEST_F(LookAheadPathTest, OldPointsLeave) {
    note_path(1, 1000, 150);
    EXPECT_TRUE(path->holds(1000 - 300));
    EXPECT_FALSE(path->holds(1000 - 300 - 64));
    EXPECT_DOUBLE_EQ(path->at(700)[kAxisZ], -0.15 * 700);
}

// A board that takes back what it has sent can take back anything.
TEST_F(LookAheadPathTest, AnotherPositionForTheSameInstantForgetsEverything) {
    note_path(1, 300, 150);
    PathPoints changed = straight(301, 150);
    changed.before[0] = 1e-4;
    EXPECT_FALSE(path->note_path(changed));
    EXPECT_FALSE(path->holds(299));
    EXPECT_TRUE(path->holds(301)) << "what it says now is where it begins anew";
    EXPECT_TRUE(path->note_path(straight(302, 150)));
}

// Both sides of each bound: the period may be longer by a hundredth, and a point is rounded by half
// a count. At 0 mm/s, mm/s2 and mm/s3 of the others, Z goes `share` of its limit.
TEST_F(LookAheadPathTest, APathThatNoAxisCanFollowIsNotBelieved) {
    options.count[kAxisZ] = 1e-4;
    for (const bool is_endless : {false, true}) {
        m.axes[kAxisZ].unlimited = is_endless;
        for (const std::uint32_t order : {1U, 2U, 3U}) {
            const auto is_believed = [&](double share) {
                make();
                bool all = true;
                for (std::uint64_t k = 1; k <= 40; ++k) {
                    const auto at = [&](std::uint64_t sample) {
                        const double s = kPeriodS * static_cast<double>(sample);
                        const Axis& z = m.axes[kAxisZ];
                        const double q = order == 1   ? z.speed_max * s
                                         : order == 2 ? z.acceleration_max * s * (s - 0.04) / 2
                                                      : z.jerk_max * s * s * s / 6;
                        const double rounded = 1e-4 * std::round(share * q / 1e-4);
                        return is_endless ? rounded - 2 * kPi * std::floor(rounded / (2 * kPi))
                                          : rounded;
                    };
                    PathPoints points;
                    points.sample = k;
                    points.position[kAxisZ] = at(k);
                    points.before[kAxisZ] = at(k - 1);
                    all = path->note_path(points) && all;
                }
                return all;
            };
            // Over 8 periods counts hide 1e-4 of 1.3 mm, 2e-4 of 0.13 mm, 4e-4 of 0.026 mm.
            const double hidden = order == 1 ? 0.0002 : order == 2 ? 0.004 : 0.032;
            EXPECT_TRUE(is_believed(std::pow(1.0099, order))) << order << is_endless;
            EXPECT_FALSE(is_believed(std::pow(1.0101, order) + hidden)) << order << is_endless;
        }
    }
}

// One instant is enough: where a path goes on somewhere else, or turns round at once.
TEST_F(LookAheadPathTest, AJumpIsSeenInThePeriodItComesIn) {
    for (const double limit : {1e4, 1e6}) {  // the jerk of the axes: no limit that matters, then
        m.axes[kAxisZ].jerk_max = limit;
        m.guard.free_jerk_limited = limit < 1e5;
        make();
        note_path(1, 100, 150);
        PathPoints back = straight(101, 150);
        back.position[kAxisZ] = back.before[kAxisZ] + 0.15;
        EXPECT_FALSE(path->note_path(back)) << "300 mm/s in 1 ms are 150 times the acceleration";
        EXPECT_FALSE(path->holds(99));
        PathPoints jump = straight(300, 150);
        jump.position[kAxisZ] += 1;
        EXPECT_FALSE(path->note_path(jump));
        EXPECT_FALSE(path->holds(300)) << "not even these two";
        EXPECT_TRUE(path->note_path(straight(301, 150)));
    }
}

// Without a promise of jerk an axis may turn its acceleration round at once.
TEST_F(LookAheadPathTest, JerkIsLookedAtWhereItIsPromised) {
    for (const bool is_promised : {true, false}) {
        m.guard.free_jerk_limited = is_promised;
        make();
        bool is_believed = true;
        for (std::uint64_t k = 1; k <= 60; ++k) {
            const auto at = [](std::uint64_t sample) {
                const double s = std::max(0.0, kPeriodS * (static_cast<double>(sample) - 30));
                return 0.5 * 1500 * s * s;
            };
            PathPoints points;
            points.sample = k;
            points.position[kAxisZ] = at(k);
            points.before[kAxisZ] = at(k - 1);
            is_believed = path->note_path(points) && is_believed;
        }
        EXPECT_EQ(is_believed, !is_promised);
    }
}

// What two lost frames hid is looked at from one end of the hole to the other.
TEST_F(LookAheadPathTest, AHoleHidesNoJump) {
    note_path(1, 100, 150);
    PathPoints far = straight(106, 150);
    far.position[kAxisZ] -= 1;
    far.before[kAxisZ] -= 1;
    EXPECT_FALSE(path->note_path(far)) << "1.75 mm in 5 ms are 350 mm/s";
    make();
    note_path(107, 207, 150);
    PathPoints back = straight(213, 0);
    back.before[kAxisZ] = -0.15 * 207 + 0.15 * 5;
    back.position[kAxisZ] = back.before[kAxisZ] + 0.15;
    EXPECT_FALSE(path->note_path(back)) << "turned round in 5 ms";
}

TEST_F(LookAheadPathTest, AnEndlessAxisGoesTheShortWayRound) {
    for (std::uint64_t k = 1; k <= 300; ++k) {
        PathPoints points;
        points.sample = k;
        const auto at = [](std::uint64_t sample) {
            const double turned = 6.2 + 1e-3 * static_cast<double>(sample);
            return turned - 2 * kPi * std::floor(turned / (2 * kPi));
        };
        points.position[kAxisC] = at(k);
        points.before[kAxisC] = at(k - 1);
        ASSERT_TRUE(path->note_path(points));
    }
    const PathStretch stretch = path->stretch(70, 5e-3);
    ASSERT_TRUE(stretch.is_known);
    std::array<JointBox, kPathPieces> pieces;
    path->cut(70, stretch.end, pieces);
    EXPECT_NEAR(2 * pieces[0].half[kAxisC], 1e-3 * stretch.end, 1e-5);
    EXPECT_NEAR(pieces[0].centre[kAxisC] - pieces[0].half[kAxisC], 6.27, 1e-5);
    AxisSnapshot snapshot;
    snapshot.sample = 84;
    snapshot.position[kAxisC] = 6.2 + 0.084 - 2 * kPi;
    m.axes[kAxisC].position_error = 1e-6;
    EXPECT_TRUE(path->keeps_to(snapshot));
    snapshot.position[kAxisC] += 2 * kPi - 2e-5;
    EXPECT_TRUE(path->keeps_to(snapshot)) << "20 us of jitter at 1 rad/s";
}

// 20 us at 150 mm/s are 3 um; a count of each frame is one together.
TEST_F(LookAheadPathTest, TheAxesKeepToThePathOrTheyDoNot) {
    m.axes[kAxisZ].following_error = 0.02;
    m.axes[kAxisZ].position_error = 0.001;
    options.count[kAxisZ] = 0.0001;
    make();
    note_path(1, 300, 150);
    AxisSnapshot snapshot;
    snapshot.sample = 100;
    for (const double side : {-1.0, 1.0}) {
        snapshot.position[kAxisZ] = -15 + side * (0.0211 + 0.003);
        EXPECT_TRUE(path->keeps_to(snapshot));
        snapshot.position[kAxisZ] = -15 + side * (0.0211 + 0.003 + 1e-5);
        EXPECT_FALSE(path->keeps_to(snapshot));
    }
    snapshot.position[kAxisZ] = std::nan("");
    EXPECT_FALSE(path->keeps_to(snapshot));
    snapshot.sample = 1000;  // nothing was said of it
    EXPECT_TRUE(path->keeps_to(snapshot));
}

// Between the positions of one and two periods before, 0.15 mm each, and 1 % of two periods.
TEST_F(LookAheadPathTest, PositionsOfBeforeKeepToWhereThePathWasThen) {
    m.can.latched_age = {1000, 2000};
    m.axes[kAxisZ].following_error = 0.02;
    m.axes[kAxisZ].position_error = 0.001;
    options.count[kAxisZ] = 0.0001;
    make();
    note_path(1, 300, 150);
    AxisSnapshot snapshot;
    snapshot.sample = 100;
    const double allowed = 0.0211 + 0.003 + 0.003;
    for (const double off : {-14.7 + allowed, -14.85 - allowed, -14.75}) {
        snapshot.position[kAxisZ] = off;
        EXPECT_TRUE(path->keeps_to(snapshot)) << off;
    }
    for (const double off : {-14.7 + allowed + 0.002, -14.85 - allowed - 0.002, -15.0}) {
        snapshot.position[kAxisZ] = off;
        EXPECT_FALSE(path->keeps_to(snapshot)) << off;
    }
    snapshot.sample = 1;  // of two periods before nothing was said
    EXPECT_TRUE(path->keeps_to(snapshot));
}

}  // namespace
}  // namespace axg::test
