// SPDX-License-Identifier: Apache-2.0
#include "core/machine/kinematics.hpp"

#include <cstddef>

namespace axg {

Pose linear_motion(const Joint& joint, double q_mm) noexcept {
    const Vec3d d = joint.direction;
    Pose m;
    m.t[0] = q_mm * d.x;
    m.t[1] = q_mm * d.y;
    m.t[2] = q_mm * d.z;
    return m;
}

Pose rotary_motion(const Joint& joint, const SinCos& sines) noexcept {
    const Vec3d d = joint.direction;
    Pose m;
    const double v = 1.0 - sines.cos;
    m.r[0][0] = sines.cos + v * d.x * d.x;
    m.r[0][1] = v * d.x * d.y - sines.sin * d.z;
    m.r[0][2] = v * d.x * d.z + sines.sin * d.y;
    m.r[1][0] = v * d.x * d.y + sines.sin * d.z;
    m.r[1][1] = sines.cos + v * d.y * d.y;
    m.r[1][2] = v * d.y * d.z - sines.sin * d.x;
    m.r[2][0] = v * d.x * d.z - sines.sin * d.y;
    m.r[2][1] = v * d.y * d.z + sines.sin * d.x;
    m.r[2][2] = sines.cos + v * d.z * d.z;
    const Vec3d turned = rotate(m, joint.pivot_mm);
    m.t[0] = joint.pivot_mm.x - turned.x;
    m.t[1] = joint.pivot_mm.y - turned.y;
    m.t[2] = joint.pivot_mm.z - turned.z;
    return m;
}

Pose joint_motion(const Axis& axis, const Joint& joint, double q) noexcept {
    return axis.kind == AxisKind::linear ? linear_motion(joint, q)
                                         : rotary_motion(joint, sin_cos(q));
}

void move_bodies(const Machine& machine, std::span<const double> position,
                 std::span<Pose> moved) noexcept {
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        Pose pose = body.parent == kNoIndex ? Pose{} : moved[body.parent];
        if (body.joint.axis != kNoIndex) {
            const Axis& axis = machine.axes[body.joint.axis];
            pose = compose(pose, joint_motion(axis, body.joint, position[body.joint.axis]));
        }
        moved[i] = pose;
    }
}

void place_bodies(const Machine& machine, std::span<const double> position,
                  std::span<Pose> placed) noexcept {
    move_bodies(machine, position, placed);
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        placed[i] = compose(placed[i], machine.bodies[i].at);
    }
}

Pose relative_pose(const Pose& placed_a, const Pose& placed_b) noexcept {
    return compose(inverse(placed_b), placed_a);
}

}  // namespace axg
