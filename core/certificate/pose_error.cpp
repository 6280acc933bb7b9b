// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/machine/kinematics.hpp"
#include "core/reach/stop_limits.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {
namespace {

constexpr double kRoundUp = 1.0 + 0x1p-40;  // exceeds the roundings of the formulas below

/// A ball that holds every point of a body, seen from a joint of the path, wherever the joints
/// between them are.
struct Ball {
    Vec3d centre_mm;
    double radius_mm = 0;
};

double length(Vec3d v) noexcept {
    return std::sqrt(dot(v, v));
}

Ball ball_of(const Machine& machine, std::uint32_t body, std::uint32_t tool,
             const BodyExtent& extent) noexcept {
    const Body& of = machine.bodies[body];
    const Pose at = of.is_tool && tool != kNoIndex ? compose(of.at, machine.tools[tool].at) : of.at;
    return {apply(at, extent.middle_mm), extent.radius_mm};
}

/// The sum of the place errors of both bodies, their tool and their carriers, common ones left out.
double place_errors_mm(const Machine& machine, const Pair& pair, std::uint32_t tool) noexcept {
    double sum = 0;
    std::uint32_t a = pair.a, b = pair.b;
    for (const std::uint32_t body : {a, b}) {
        const bool has_tool = machine.bodies[body].is_tool && tool != kNoIndex;
        sum += has_tool ? machine.tools[tool].place_error_mm : 0;
    }
    while (a != b) {  // parents have smaller indices
        std::uint32_t& end = b == kNoIndex || (a != kNoIndex && a > b) ? a : b;
        sum += machine.bodies[end].place_error_mm;
        end = machine.bodies[end].parent;
    }
    // One carries the other: its own surface may be off all the same.
    return a != kNoIndex && (a == pair.a || a == pair.b) ? sum + machine.bodies[a].place_error_mm
                                                         : sum;
}

/// A turn about an axis that is up to p beside its pivot and turned by up to phi moves a point at
/// most this much elsewhere.
double turn_error_mm(const Joint& joint, double radius_mm) noexcept {
    return 2 * joint.pivot_error_mm +
           2 * joint.direction_error_rad * (radius_mm + joint.pivot_error_mm);
}

/// How far a gantry may place a point between its rails, or as far from their middle as they are
/// apart, from where the mean of its joints does.
double skew_error_mm(const Axis& axis) noexcept {
    return axis.skew_mm > 0 ? axis.skew_mm + 2 * (axis.following_error + axis.position_error) : 0;
}

/// Walks from one body to the other and lowers the error of each joint to that seen from here.
/// @param errors  [path] mm
void walk(const Machine& machine, const JointPath& path, Ball ball, bool from_a,
          const std::array<double, kAxesMax>& within,
          std::array<double, kPathMax>& errors) noexcept {
    for (std::uint32_t k = 0; k < path.count; ++k) {
        const std::uint32_t at = from_a ? k : path.count - 1 - k;
        const Joint& joint = machine.bodies[path.body[at]].joint;
        const Axis& axis = machine.axes[joint.axis];
        if (axis.kind == AxisKind::linear) {
            const double error =
                joint.direction_error_rad * within[joint.axis] + skew_error_mm(axis);
            errors[at] = std::min(errors[at], error);
            ball.radius_mm += within[joint.axis] + error;
            continue;
        }
        const double radius = length(ball.centre_mm - joint.pivot_mm) + ball.radius_mm;
        const double error = turn_error_mm(joint, radius);
        errors[at] = std::min(errors[at], error);
        ball = {joint.pivot_mm, radius + error};
    }
}

}  // namespace

std::array<double, kAxesMax> error_range(const Machine& machine) noexcept {
    std::array<double, kAxesMax> out{};
    const double free_s = free_seconds(machine, machine.can.permit_samples.most);
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        if (axis.kind == AxisKind::linear) {
            const double stop_mm =
                forward_reach(stop_limits(machine, i), axis.speed_max, axis.speed_max, free_s);
            const double errors_mm = axis.position_error + axis.following_error;
            out[i] = std::max(std::fabs(axis.min), std::fabs(axis.max)) + 2 * stop_mm + errors_mm +
                     machine.guard.overrun_mm + 1;
        }
    }
    return out;
}

double pose_error_mm(const Machine& machine, const Pair& pair, std::uint32_t tool,
                     const BodyExtent& a, const BodyExtent& b,
                     const std::array<double, kAxesMax>& within) noexcept {
    const JointPath path = path_between(machine, pair.a, pair.b);
    const double places_mm = place_errors_mm(machine, pair, tool);
    std::array<double, kPathMax> errors{};
    std::fill_n(errors.begin(), path.count, std::numeric_limits<double>::infinity());
    Ball of_a = ball_of(machine, pair.a, tool, a), of_b = ball_of(machine, pair.b, tool, b);
    of_a.radius_mm += places_mm;
    of_b.radius_mm += places_mm;
    walk(machine, path, of_a, true, within, errors);
    walk(machine, path, of_b, false, within, errors);
    double sum = places_mm;
    for (std::uint32_t k = 0; k < path.count; ++k) {
        sum += errors[k];
    }
    return sum * kRoundUp;
}

}  // namespace axg
