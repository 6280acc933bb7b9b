// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/program_motion.hpp"

#include <cmath>
#include <memory>

namespace axg {

namespace {

constexpr double kSettledShare = 1e-9;  // of a mm or rad: the drive has caught up

struct Follower {
    Follower(const Program& program, const MotionLimits& limits, const MotionOptions& options,
             const double* speed_share, AxisShares* axis_shares)
        : sampler(program, limits, options), keep(std::exp(-kMotionStepS / kDriveLagS)) {
        sampler.obey(speed_share);
        sampler.obey(axis_shares);
        has_more = sampler.next(now);
        next = now;
    }

    MotionSampler sampler;
    MotionSample now, next;  // commands at the beginning and the end of the tick
    double keep;             // share of the distance to the command that remains after a tick
    bool has_more = false;
};

/// The command runs straight from `now` to `next`: p' = (command - p) / lag has this solution.
void follow(const Follower& f, std::uint32_t axis, AxisMotion& at) noexcept {
    const double rate = (f.next.position[axis] - f.now.position[axis]) / kMotionStepS;
    const double behind = f.now.position[axis] - at.position;
    at.speed = behind / kDriveLagS;
    at.acceleration = (rate - at.speed) / kDriveLagS;
    at.jerk = -at.acceleration / kDriveLagS;
}

/// Sets the exact position at the end of the last tick; the polynomial of the tick approximates it.
void settle(const Follower& f, double from, std::uint32_t axis, AxisMotion& at) noexcept {
    const double rate = (f.next.position[axis] - f.now.position[axis]) / kMotionStepS;
    const double steady = rate * kDriveLagS;  // lag behind the command at a steady speed
    const double behind = f.now.position[axis] - from;
    at.position = f.next.position[axis] - steady - (behind - steady) * f.keep;
}

}  // namespace

CommandedMotion make_program_motion(const Program& program, const MotionLimits& limits,
                                    const MotionOptions& options, const double* speed_share,
                                    double* lost_s, AxisShares* axis_shares) {
    const auto follower =
        std::make_shared<Follower>(program, limits, options, speed_share, axis_shares);
    const auto from = std::make_shared<AxisPositions>(program.start);
    return [follower, from, lost_s](std::span<AxisMotion> axes) {
        Follower& f = *follower;
        bool is_settled = true;
        for (std::uint32_t i = 0; i < axes.size(); ++i) {
            settle(f, (*from)[i], i, axes[i]);
            (*from)[i] = axes[i].position;
            is_settled =
                is_settled && std::abs(f.next.position[i] - axes[i].position) < kSettledShare;
        }
        f.now = f.next;
        f.has_more = f.has_more && f.sampler.next(f.next);
        if (lost_s != nullptr) {
            *lost_s = static_cast<double>(f.sampler.lost_steps()) * kMotionStepS;
        }
        const bool is_over = !f.has_more && is_settled;
        for (std::uint32_t i = 0; i < axes.size(); ++i) {
            if (is_over) {
                axes[i] = {.position = f.now.position[i]};
            } else {
                follow(f, i, axes[i]);
            }
        }
        return MotionTick{.is_over = is_over, .tool = f.now.tool, .line = f.now.line};
    };
}

double motion_seconds(const Program& program, const MotionLimits& limits,
                      const MotionOptions& options) {
    const CommandedMotion motion = make_program_motion(program, limits, options);
    AxisMotions axes{};
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        axes[i].position = program.start[i];
    }
    std::uint64_t ticks = 0;
    while (!motion({axes.data(), limits.axis_count}).is_over) {
        ++ticks;
    }
    return static_cast<double>(ticks) * kMotionStepS;
}

}  // namespace axg
