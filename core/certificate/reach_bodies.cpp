// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/reach_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

constexpr double kUp = 1.0 + 0x1p-40;  // exceeds the roundings of the formulas below

/// Largest distance of a placed box' corners from a line.
double lever_mm(const BodyExtent& extent, const Pose& placed, Vec3d on_line, Vec3d along) noexcept {
    double most_mm = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3d at{(corner & 1U) != 0 ? extent.high_mm.x : extent.low_mm.x,
                       (corner & 2U) != 0 ? extent.high_mm.y : extent.low_mm.y,
                       (corner & 4U) != 0 ? extent.high_mm.z : extent.low_mm.z};
        const Vec3d off = cross(apply(placed, at) - on_line, along);
        most_mm = std::max(most_mm, std::sqrt(dot(off, off)));
    }
    return most_mm;
}

}  // namespace

ReachBody reach_body(const Machine& machine, std::uint32_t body, const Pose& at,
                     const BodyExtent& extent, const JointBox& box) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, box.centre, moved);
    ReachBody out{.body = body, .placed = compose(moved[body], at)};
    // From the body's own joint to the outermost: earlier joints move it by at most `moves_mm`.
    for (std::uint32_t carrier = body; carrier != kNoIndex;
         carrier = machine.bodies[carrier].parent) {
        const Joint& joint = machine.bodies[carrier].joint;
        if (joint.axis == kNoIndex) {
            continue;
        }
        const double half = box.half[joint.axis];
        if (machine.axes[joint.axis].kind == AxisKind::linear) {
            out.moves_mm += half * kUp;
            continue;
        }
        // A turn about the axis does not move the axis.
        const Vec3d on_line = apply(moved[carrier], joint.pivot_mm);
        const Vec3d along = rotate(moved[carrier], joint.direction);
        const double lever = lever_mm(extent, out.placed, on_line, along) + out.moves_mm;
        out.moves_mm += lever * std::min(half, 2.0) * kUp;  // the arc, or the diameter
    }
    const Vec3d wider{out.moves_mm, out.moves_mm, out.moves_mm};
    out.low_mm = extent.low_mm - wider;
    out.high_mm = extent.high_mm + wider;
    return out;
}

}  // namespace axg
