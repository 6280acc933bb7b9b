// SPDX-License-Identifier: Apache-2.0
#include "core/machine/kinematics.hpp"

#include <cstddef>

#include "core/machine/pose_product.hpp"

namespace axg {

Pose joint_motion(const Axis& axis, const Joint& joint, double q) noexcept {
    return axis.kind == AxisKind::linear
               ? linear_motion(joint.direction, q)
               : rotary_motion(joint.direction, joint.pivot_mm, sin_cos(q));
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
