// SPDX-License-Identifier: Apache-2.0
#include "core/machine/kinematics.hpp"

#include <cstddef>

#include "core/base/sincos.hpp"

namespace axg {

Pose joint_motion(const Axis& axis, const Joint& joint, double q) noexcept {
    const Vec3d d = joint.direction;
    Pose m;
    if (axis.kind == AxisKind::linear) {
        m.t[0] = q * d.x;
        m.t[1] = q * d.y;
        m.t[2] = q * d.z;
        return m;
    }
    const SinCos sc = sin_cos(q);
    const double v = 1.0 - sc.cos;
    m.r[0][0] = sc.cos + v * d.x * d.x;
    m.r[0][1] = v * d.x * d.y - sc.sin * d.z;
    m.r[0][2] = v * d.x * d.z + sc.sin * d.y;
    m.r[1][0] = v * d.x * d.y + sc.sin * d.z;
    m.r[1][1] = sc.cos + v * d.y * d.y;
    m.r[1][2] = v * d.y * d.z - sc.sin * d.x;
    m.r[2][0] = v * d.x * d.z - sc.sin * d.y;
    m.r[2][1] = v * d.y * d.z + sc.sin * d.x;
    m.r[2][2] = sc.cos + v * d.z * d.z;
    const Vec3d turned = rotate(m, joint.pivot_mm);
    m.t[0] = joint.pivot_mm.x - turned.x;
    m.t[1] = joint.pivot_mm.y - turned.y;
    m.t[2] = joint.pivot_mm.z - turned.z;
    return m;
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
