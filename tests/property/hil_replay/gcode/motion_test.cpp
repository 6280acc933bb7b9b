// SPDX-License-Identifier: Apache-2.0
// Random programs on machines with random limits: whatever comes out keeps every limit on the 0.1
// ms grid, stays on the programmed path within the tolerance, and ends exactly where the program
// says.
// ctest-labels: long
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/random_program.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::append;
using test::Dice;
using test::random_motion_machine;
using test::random_program;

constexpr double kLimitSlack = 1e-3;  // of the limit: differences on a grid against derivatives
#ifdef NDEBUG
constexpr int kMachines = 60;
#else
constexpr int kMachines = 20;  // unoptimised, ten times as slow
#endif

double distance_to_line(const MotionLimits& limits, const AxisPositions& at,
                        const AxisPositions& from, const AxisPositions& to) {
    double along = 0, square = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const double m = limits.metric[i] * limits.metric[i];
        along += m * (at[i] - from[i]) * (to[i] - from[i]);
        square += m * (to[i] - from[i]) * (to[i] - from[i]);
    }
    const double share = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
    double sum = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const double off = limits.metric[i] * (at[i] - from[i] - share * (to[i] - from[i]));
        sum += off * off;
    }
    return std::sqrt(sum);
}

/// Follows the program's moves beside the samples: the sample's line says which moves it may be on.
class PathJudge {
  public:
    PathJudge(const Program& program, const MotionLimits& limits, double blend_mm)
        : program_(program), limits_(limits), blend_mm_(blend_mm) {}

    /// Distance beyond what the tolerance allows, mm; arcs allow 1 nm.
    double excess(const MotionSample& sample) {
        double least = HUGE_VAL;
        while (next_ + 1 < program_.moves.size() && program_.moves[next_].line < sample.line) {
            ++next_;
        }
        const std::size_t first = next_ > 2 ? next_ - 2 : 0;
        for (std::size_t i = first; i < std::min(next_ + 3, program_.moves.size()); ++i) {
            least = std::min(least, excess_of(i, sample.position));
        }
        return least;
    }

  private:
    [[nodiscard]] double excess_of(std::size_t index, const AxisPositions& at) const {
        const Move& move = program_.moves[index];
        const AxisPositions& from = index == 0 ? program_.start : program_.moves[index - 1].target;
        if (move.kind == MoveKind::arc) {
            const double radius = std::hypot(at[move.arc.first] - move.arc.center_first_mm,
                                             at[move.arc.second] - move.arc.center_second_mm);
            const double spiral = std::abs(move.arc.radius_end_mm - move.arc.radius_start_mm);
            return std::abs(radius - move.arc.radius_start_mm) - spiral - 1e-6;
        }
        double tolerance = move.blend_mm >= 0 ? move.blend_mm : blend_mm_;
        if (index > 0) {  // the corner at its start is the tolerance of the move before
            const double before = program_.moves[index - 1].blend_mm;
            tolerance = std::max(tolerance, before >= 0 ? before : blend_mm_);
        }
        return distance_to_line(limits_, at, from, move.target) - tolerance - 1e-9;
    }

    const Program& program_;
    const MotionLimits& limits_;
    double blend_mm_;
    std::size_t next_ = 0;
};

/// As fast as the program says; at one share of rapid; at a share that changes all the time, or
/// another for each axis.
enum class Share { none, constant, changing, of_axes };

void keeps_limits_path_and_end(Share kind) {
    const std::uint64_t seed = test::printed_seed(20261121);
    std::uint64_t samples = 0, blends = 0;
    for (int round = 0; round < (kind == Share::none ? kMachines : kMachines / 5); ++round) {
        Dice dice(seed + static_cast<std::uint64_t>(round));
        const Machine machine = random_motion_machine(dice);
        GcodeOptions options;
        options.start = default_start(machine);
        const std::string text = random_program(dice);
        const GcodeResult reading = read_gcode(text, machine, options);
        ASSERT_TRUE(reading.faults.empty())
            << "round " << round << ": " << reading.faults[0].line << ": " << reading.faults[0].word
            << ": " << reading.faults[0].message << "\n"
            << text;
        const MotionLimits limits = make_motion_limits(machine);
        const MotionOptions motion;
        MotionSampler sampler(reading.program, limits, motion);
        double share = kind == Share::constant ? dice.magnitude(0.1, 1) : 1;
        const double speed_share = share;
        AxisShares shares;
        shares.wanted.fill(1);
        if (kind == Share::of_axes) {
            sampler.obey(&shares);
        } else if (kind != Share::none) {
            sampler.obey(&share);
        }
        PathJudge judge(reading.program, limits, motion.blend_mm);
        LimitMeter meter(limits.axis_count);
        MotionSample sample;
        double worst = -HUGE_VAL;
        AxisPositions largest{};
        while (sampler.next(sample)) {
            meter.add(sample.position);
            worst = std::max(worst, judge.excess(sample));
            for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
                largest[i] = std::max(largest[i], std::abs(sample.position[i]));
            }
            ++samples;
            if (kind == Share::changing && dice.chance(0.01)) {
                share = dice.magnitude(0.05, 1);
            }
            if (kind == Share::of_axes && dice.chance(0.01)) {
                shares.wanted[static_cast<std::size_t>(dice.in(0, limits.axis_count))] =
                    dice.magnitude(0.05, 1);
            }
        }
        blends += sampler.blend_count();
        EXPECT_LE(worst, 0.0) << "round " << round << ": off the path";
        EXPECT_EQ(sample.position, reading.program.moves.back().target) << "round " << round;
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            const LimitMeter::Peak& peak = meter.peak(i);
            const double rounding = largest[i] * 0x1p-52;  // of one position
            const std::string where =
                "round " + std::to_string(round) + " axis " + machine.axes[i].name;
            EXPECT_LE(peak.speed,
                      speed_share * limits.speed[i] * (1 + kLimitSlack) + 2 * rounding / 1e-4)
                << where;
            EXPECT_LE(peak.acceleration,
                      limits.acceleration[i] * (1 + kLimitSlack) + 4 * rounding / 1e-8)
                << where;
            EXPECT_LE(peak.jerk, limits.jerk[i] * (1 + kLimitSlack) + 8 * rounding / 1e-12)
                << where;
        }
    }
    std::printf("%llu samples, %llu blended corners\n", static_cast<unsigned long long>(samples),
                static_cast<unsigned long long>(blends));
    EXPECT_GT(blends, 20U) << "the test must not only see standstills";
}

TEST(Motion, RandomProgramsKeepLimitsPathAndEnd) {
    keeps_limits_path_and_end(Share::none);
}

TEST(Motion, AShareOfRapidIsKeptByEveryAxis) {
    keeps_limits_path_and_end(Share::constant);
}

// However the share jumps about, speeds follow it with the accelerations of the plan.
TEST(Motion, AShareThatJumpsBreaksNoLimit) {
    keeps_limits_path_and_end(Share::changing);
}

TEST(Motion, SharesOfEachAxisThatJumpBreakNoLimit) {
    keeps_limits_path_and_end(Share::of_axes);
}

TEST(Motion, TheMeterSeesWhatBreaksALimit) {
    // A step of 1 mm between two samples: 1e4 mm/s, 1e8 mm/s2, and the jerk of leaving it again.
    LimitMeter meter(1);
    AxisPositions at{};
    for (int i = 0; i < 4; ++i) {
        meter.add(at);
    }
    at[0] = 1;
    meter.add(at);
    meter.add(at);
    EXPECT_NEAR(meter.peak(0).speed, 1e4, 1e-6);
    EXPECT_NEAR(meter.peak(0).acceleration, 1e8, 1e-2);
    EXPECT_NEAR(meter.peak(0).jerk, 2e12, 1e3);
}

double duration_of(const Program& program, const Machine& machine, std::uint32_t* runs = nullptr) {
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    MotionSampler sampler(program, limits, motion);
    MotionSample sample;
    while (sampler.next(sample)) {
    }
    if (runs != nullptr) {
        *runs = sampler.run_count();
    }
    return static_cast<double>(sample.index) * kMotionStepS;
}

/// With the share 1 the machine moves as it does without: a tick more or less in each stretch, for
/// the end of one is met by steps and not by formula.
TEST(Motion, TheWholeOfRapidCostsNothing) {
    const std::uint64_t seed = test::printed_seed(20261122);
    for (int round = 0; round < kMachines / 5; ++round) {
        Dice dice(seed + static_cast<std::uint64_t>(round));
        const Machine machine = random_motion_machine(dice);
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(random_program(dice), machine, options);
        ASSERT_TRUE(reading.faults.empty());
        const MotionLimits limits = make_motion_limits(machine);
        const MotionOptions motion;
        MotionSampler free(reading.program, limits, motion), all(reading.program, limits, motion);
        const double share = 1;
        all.obey(&share);
        MotionSample one, other;
        while (free.next(one)) {
        }
        while (all.next(other)) {
        }
        EXPECT_EQ(one.position, other.position);
        EXPECT_NEAR(static_cast<double>(other.index), static_cast<double>(one.index),
                    2.0 * free.run_count() + 2e-4 * static_cast<double>(one.index));
    }
}

Program program_of(const std::string& text, const Machine& machine) {
    GcodeOptions options;
    GcodeResult reading = read_gcode(text, machine, options);
    EXPECT_TRUE(reading.faults.empty());
    return reading.program;
}

TEST(Motion, OneLongMoveTakesTheTimeOfItsSCurve) {
    const Machine machine = motion_test_machine();
    const double speed = 50, acceleration = 2000;
    const double smooth_s = make_motion_limits(machine).smooth_s;
    const double seconds = duration_of(program_of("G1 X100 F3000\n", machine), machine);
    EXPECT_NEAR(seconds, 100 / speed + speed / acceleration + smooth_s, 2e-4);
}

TEST(Motion, FeedsMeanWhatTheirModeSays) {
    const Machine machine = motion_test_machine();
    // The speed in the middle of long moves, without the ends: two lengths of the same move.
    const auto slope = [&](const char* one, const char* two) {
        return duration_of(program_of(two, machine), machine) -
               duration_of(program_of(one, machine), machine);
    };
    EXPECT_NEAR(slope("G1 X100 F1200\n", "G1 X200 F1200\n"), 5.0, 2e-4) << "mm/min";
    EXPECT_NEAR(slope("G1 C100 F1200\n", "G1 C200 F1200\n"), 5.0, 2e-4) << "deg/min";
    EXPECT_NEAR(slope("G1 X100 C100 F1200\n", "G1 X200 C200 F1200\n"), 5.0, 2e-4)
        << "mm/min of X Y Z alone";
    EXPECT_NEAR(slope("G0 X100\n", "G0 X200\n"), 0.6, 2e-4) << "the cap of 10 m/min";
    EXPECT_NEAR(slope("G93 G1 X100 F3\n", "G93 G1 X100 F2\n"), 10.0, 1e-2)
        << "30 s and 20 s, the ends a little later";
}

TEST(Motion, ShortStepsDoNotStopAtEveryBlock) {
    const Machine machine = motion_test_machine();
    std::string straight = "G1 F3000\n", curved = "G1 F3000\n";
    for (int i = 1; i <= 2000; ++i) {
        append(straight, "X%.4f\n", 0.1 * i);
        append(curved, "X%.4f Y%.4f\n", 200 * std::sin(5e-4 * i), 200 * (1 - std::cos(5e-4 * i)));
    }
    std::uint32_t runs = 0;
    const double seconds = duration_of(program_of(straight, machine), machine, &runs);
    EXPECT_EQ(runs, 1U);
    EXPECT_LT(seconds, 200.0 / 50 + 0.2);
    // A circle of radius 200 mm in steps of 0.1 mm, rounded to 0.1 um.
    const double around = duration_of(program_of(curved, machine), machine, &runs);
    EXPECT_EQ(runs, 1U);
    EXPECT_LT(around, 200.0 / 50 * 2);
}

TEST(Motion, TheSameProgramGivesTheSameBits) {
    Dice dice(7);
    const Machine machine = random_motion_machine(dice);
    GcodeOptions options;
    const GcodeResult reading = read_gcode(random_program(dice), machine, options);
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    MotionSampler one(reading.program, limits, motion), two(reading.program, limits, motion);
    MotionSample a, b;
    while (one.next(a)) {
        ASSERT_TRUE(two.next(b));
        ASSERT_EQ(a.position, b.position);
    }
    EXPECT_FALSE(two.next(b));
}

}  // namespace
}  // namespace axg
