// SPDX-License-Identifier: Apache-2.0
// Prints which way each axis moves which bodies, and where the meshes are placed. The text comes
// from the kinematics that the guard uses: it shows a direction that was typed wrongly.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

constexpr double kStep = 1e-3;  // mm or rad: what an axis is jogged by to see where it leads
constexpr double kStraight = 1 - 1e-9;  // a direction along a machine axis

std::vector<Pose> motions_at(const Machine& machine, std::span<const double> position) {
    std::vector<Pose> moved(machine.bodies.size());
    move_bodies(machine, position, moved);
    return moved;
}

double length_of(Vec3d v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/// "+x", "-z", or the direction itself where it is slanted.
std::string words_of(Vec3d direction) {
    const std::array<double, 3> parts{direction.x, direction.y, direction.z};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (std::fabs(parts[i]) >= kStraight) {
            return fmt::format("{}{}", parts[i] > 0 ? '+' : '-', "xyz"[i]);
        }
    }
    return fmt::format("({:+.4f}, {:+.4f}, {:+.4f})", direction.x, direction.y, direction.z);
}

std::string point(Vec3d p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", p.x + 0.0, p.y + 0.0, p.z + 0.0);
}

/// Motion of a body at zero by one step of the axis: "to -x", "about +z through (0, 0, -380) mm".
std::string words_of_step(const Pose& step, AxisKind kind) {
    if (kind == AxisKind::linear) {
        const Vec3d way{step.t[0], step.t[1], step.t[2]};
        return "to " + words_of((1 / length_of(way)) * way);
    }
    // The antisymmetric part of a rotation matrix is its axis times sin; this is twice that.
    const Vec3d twice_sin{step.r[2][1] - step.r[1][2], step.r[0][2] - step.r[2][0],
                          step.r[1][0] - step.r[0][1]};
    const Vec3d axis = (1 / length_of(twice_sin)) * twice_sin;
    // The fixed point nearest to the origin: t is its motion, turned by a quarter and half a step.
    const Vec3d t{step.t[0], step.t[1], step.t[2]};
    const double half = 0.5 / std::tan(0.5 * kStep);
    const Vec3d across{axis.y * t.z - axis.z * t.y, axis.z * t.x - axis.x * t.z,
                       axis.x * t.y - axis.y * t.x};
    const Vec3d through = 0.5 * t + half * across;
    const auto rounded = [](double value) { return std::round(value * 1e6) * 1e-6; };
    return fmt::format("about {} through {}", words_of(axis),
                       point({rounded(through.x), rounded(through.y), rounded(through.z)}));
}

std::string limits_of(const Axis& axis) {
    const double unit = axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
    const char* const name = axis.kind == AxisKind::rotary ? "deg" : "mm";
    return axis.unlimited
               ? "endless"
               : fmt::format("{:.6g} to {:.6g} {}", axis.min * unit, axis.max * unit, name);
}

/// The bodies that the axis carries along, without those that it moves by their own joint.
std::string carried_by(const Machine& machine, const std::vector<bool>& moves) {
    std::string names;
    for (std::uint32_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        const bool is_carried = body.parent != kNoIndex && moves[body.parent];
        names += moves[i] && is_carried ? (names.empty() ? "" : ", ") + body.name : "";
    }
    return names.empty() ? "" : " with " + names;
}

}  // namespace

std::string describe_motion(const Machine& machine, std::uint32_t axis) {
    std::array<double, kAxesMax> position{};
    const std::span<const double> all(position.data(), machine.axes.size());
    const std::vector<Pose> before = motions_at(machine, all);
    position.at(axis) = kStep;
    const std::vector<Pose> after = motions_at(machine, all);
    std::vector<bool> moves(machine.bodies.size());
    std::string words;
    for (std::uint32_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        const bool is_own = body.joint.axis == axis;
        moves[i] = is_own || (body.parent != kNoIndex && moves[body.parent]);
        if (is_own) {
            const Pose step = compose(after[i], inverse(before[i]));
            words += fmt::format("{}{} {}", words.empty() ? "" : "; ", body.name,
                                 words_of_step(step, machine.axes[axis].kind));
        }
    }
    const Axis& one = machine.axes[axis];
    return fmt::format("{}+ {} {}{}", one.name, one.kind == AxisKind::rotary ? "turns" : "moves",
                       words, carried_by(machine, moves));
}

void report_motion(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    fmt::print(report.words, "\nmotion (from all axes at 0; rotation is right-handed)\n");
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        fmt::print(report.words, "  {}; {}\n", describe_motion(machine, i),
                   limits_of(machine.axes[i]));
    }
    fmt::print(report.words, "\nplacement of the meshes, with all axes at 0\n");
    for (const Body& body : machine.bodies) {
        if (!body.has_mesh && !body.is_tool) {
            continue;
        }
        const Pose& at = body.at;
        const bool is_turned = at.r[0][0] != 1 || at.r[1][1] != 1 || at.r[2][2] != 1;
        const std::string turn = is_turned
                                     ? fmt::format(", x along {}, z along {}",
                                                   words_of({at.r[0][0], at.r[1][0], at.r[2][0]}),
                                                   words_of({at.r[0][2], at.r[1][2], at.r[2][2]}))
                                     : "";
        fmt::print(report.words, "  {:<16} origin at {}{}\n", body.name,
                   point({at.t[0], at.t[1], at.t[2]}), turn);
    }
}

void report_pose_errors(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    if (!machine.pose_errors.are_stated || machine.pairs.empty()) {
        return;
    }
    const WorstPoseError& worst = report.facts.pose_errors.emplace(worst_pose_error(report.loaded));
    const Pair& pair = machine.pairs[worst.pair];
    fmt::print(
        report.words,
        "\nstated errors: pairs count as nearer than they are drawn, {}-{} most: {:.4f} mm\n",
        machine.bodies[pair.a].name, machine.bodies[pair.b].name, worst.mm);
    for (const PoseErrorPart& part : worst.parts) {
        fmt::print(report.words, "  {:<36} {:.4f} mm\n", part.key, part.mm);
    }
}

}  // namespace axg
