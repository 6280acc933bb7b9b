// SPDX-License-Identifier: Apache-2.0
// ctest-labels: long
// Shares of each axis that jump about, with rests among them: what the planner said that an axis
// needs, it never exceeds, and it needs no more than it may have once that has been so for long
// enough.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/count.hpp"
#include "tests/support/random_program.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr int kPeriodSteps = 10;
constexpr double kSlack = 1e-3;    // of a speed: differences on a grid against derivatives
constexpr double kDust = 1e-6;     // of rapid: the path is counted in whole units
constexpr double kLongestS = 120;  // of a program that is held back; then it may go on
constexpr double kSettling = 1;    // times what the slowest axis takes to brake from rapid
constexpr double kTamed = 0.5;     // of rapid: a share that tells something

using Shares = std::array<double, kAxesMax>;

/// As AxisCapKeeper does it: what is wanted, or what the planner said within the time that acts on.
class Promise {
  public:
    Promise(double smooth_s, std::uint32_t axes)
        : axes_(axes),
          needed_(2 +
                  static_cast<std::size_t>(std::ceil(smooth_s / (kPeriodSteps * kMotionStepS)))) {}

    void end_period(AxisShares& shares) {
        needed_[slot_++ % needed_.size()] = shares.needed;
        shares.needed = {};
        kept_ = shares.wanted;
        for (const Shares& one : needed_) {
            for (std::uint32_t i = 0; i < axes_; ++i) {
                kept_[i] = std::max({kept_[i], one[i], fastest_[i]});
            }
        }
        fastest_ = {};
    }
    void note(std::uint32_t axis, double share) {
        fastest_[axis] = std::max(fastest_[axis], share);
    }
    [[nodiscard]] double kept(std::uint32_t axis) const { return kept_[axis]; }

  private:
    std::uint32_t axes_;
    std::vector<Shares> needed_;
    std::size_t slot_ = 0;
    Shares fastest_{}, kept_{};
};

struct Tally {
    std::uint64_t periods = 0, near = 0;  // near: within a tenth of what is kept
    std::uint64_t settled = 0;            // and of those, how often no more was needed than wanted
    double worst = 0;                     // speed of what is kept
};

void follow(Dice& dice, const Program& program, const MotionLimits& limits, Tally& tally) {
    const MotionOptions motion;
    MotionSampler sampler(program, limits, motion);
    AxisShares shares;
    shares.wanted.fill(1);
    sampler.obey(&shares);
    Promise promise(limits.smooth_s, limits.axis_count);
    double settling_s = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        settling_s = std::max(settling_s, kSettling * limits.speed[i] / limits.acceleration[i]);
    }
    settling_s += 2 * limits.smooth_s;
    const double changes = dice.magnitude(3e-5, 0.03);  // a period
    std::uint64_t changed = 0;
    MotionSample before, now;
    ASSERT_TRUE(sampler.next(before));
    promise.end_period(shares);
    while (sampler.next(now)) {
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            const double rounding = std::abs(now.position[i]) * 0x1p-51 / kMotionStepS;
            const double speed = std::abs(now.position[i] - before.position[i]) / kMotionStepS;
            const double share = std::max(0.0, speed - rounding) / limits.speed[i];
            promise.note(i, share);
            ASSERT_LE(share, promise.kept(i) * (1 + kSlack) + kDust)
                << "axis " << i << " at " << now.index << ", line " << now.line;
            tally.worst = std::max(tally.worst, share / std::max(promise.kept(i), 1e-3));
            tally.near += promise.kept(i) < kTamed && share > 0.9 * promise.kept(i) ? 1 : 0;
        }
        before = now;
        if (now.index % kPeriodSteps != 0) {
            continue;
        }
        const bool is_settled =
            static_cast<double>(now.index - changed) * kMotionStepS > settling_s;
        for (std::uint32_t i = 0; i < limits.axis_count && is_settled; ++i) {
            ASSERT_LE(shares.needed[i], shares.wanted[i] * (1 + kSlack) + kDust)
                << "axis " << i << " at " << now.index << ", line " << now.line;
            tally.settled += shares.wanted[i] < kTamed && shares.needed[i] > 0.9 * shares.wanted[i];
        }
        tally.periods += limits.axis_count;
        const auto axis = static_cast<std::size_t>(dice.in(0, limits.axis_count));
        const bool is_free = static_cast<double>(now.index) * kMotionStepS > kLongestS;
        if (is_free || dice.chance(changes)) {
            shares.wanted.fill(1);
            changed = now.index;
        } else if (dice.chance(changes)) {
            shares.wanted[axis] = dice.chance(0.1) ? 0 : dice.magnitude(0.05, 1);
            changed = now.index;
        }
        promise.end_period(shares);
    }
    EXPECT_EQ(now.position, program.moves.back().target) << "it arrives all the same";
}

TEST(PlannedClock, NoAxisIsFasterThanWasSaid) {
    const std::uint64_t seed = printed_seed(20261127);
    const std::uint64_t count = count_from_environment(12, 12);
    Tally tally;
    for (std::uint64_t round = 0; round < count && !testing::Test::HasFailure(); ++round) {
        Dice dice(seed + round);
        const Machine machine = random_motion_machine(dice);
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(random_program(dice), machine, options);
        ASSERT_TRUE(reading.faults.empty());
        SCOPED_TRACE("round " + std::to_string(round));
        follow(dice, reading.program, make_motion_limits(machine), tally);
    }
    std::printf("%llu periods of an axis, %llu settled below %.1f, %llu samples near, worst %.6f\n",
                static_cast<unsigned long long>(tally.periods),
                static_cast<unsigned long long>(tally.settled), kTamed,
                static_cast<unsigned long long>(tally.near), tally.worst);
    EXPECT_GT(tally.settled, 100U) << "too restless to tell anything";
    EXPECT_GT(tally.near, 100U) << "too tame to tell anything";
}

}  // namespace
}  // namespace axg::test
