// SPDX-License-Identifier: Apache-2.0
// Poses of one body in another's frame, as products along the joints between them: constant factors
// are multiplied once for many positions, and only the free joints are multiplied anew.
// One source for the host and for a GPU, so that both get the same bits. Double, mm, rad.
// Source: docs/theory/certificate.md, "Levers once".
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"
#include "core/base/pose.hpp"
#include "core/base/sincos.hpp"
#include "core/base/vec3.hpp"

namespace axg {

/// The motion of a linear joint along its direction, by q mm.
AXG_HD Pose linear_motion(Vec3d d, double q_mm) noexcept {
    Pose m;
    m.t[0] = q_mm * d.x;
    m.t[1] = q_mm * d.y;
    m.t[2] = q_mm * d.z;
    return m;
}

/// The turn of a rotary joint about the line through pivot_mm along d, by the angle with these
/// sines (Rodrigues' formula).
AXG_HD Pose rotary_motion(Vec3d d, Vec3d pivot_mm, const SinCos& sines) noexcept {
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
    const Vec3d turned = rotate(m, pivot_mm);
    m.t[0] = pivot_mm.x - turned.x;
    m.t[1] = pivot_mm.y - turned.y;
    m.t[2] = pivot_mm.z - turned.z;
    return m;
}

/// A joint on the way from one body to another. sign: 1 where it carries the first body; -1 where
/// it carries the other, for the way leads against it.
struct PathJoint {
    Vec3d direction{0, 0, 1}, pivot_mm{};
    double sign = 1;
    bool is_linear = true;
};

/// Moves `pose` by one joint.
/// @param sines  SinCos of an angle, rad
template <class Sines>
AXG_HD void move_by(const PathJoint& joint, double position, const Sines& sines,
                    Pose& pose) noexcept {
    if (joint.is_linear) {
        const Pose moved = linear_motion(joint.direction, joint.sign * position);
        for (int i = 0; i < 3; ++i) {
            pose.t[i] += moved.t[i];
        }
        return;
    }
    const SinCos turn = sines(position);
    pose = compose(
        rotary_motion(joint.direction, joint.pivot_mm, {joint.sign * turn.sin, turn.cos}), pose);
}

/// Joints and fixed stretches in turn, from the first body on: fixed[i] is before joint i, and the
/// last one after the last joint.
struct PoseProduct {
    const PathJoint* joints;
    const Pose* fixed;           // [count + 1]
    std::uint32_t count, split;  // joints; those of the first half
};

/// From fixed[begin] past the joints up to `end`.
/// @param at  position of joint i
template <class At, class Sines>
AXG_HD Pose stretch_of(const PoseProduct& p, std::uint32_t begin, std::uint32_t end, const At& at,
                       const Sines& sines) noexcept {
    Pose out = p.fixed[begin];
    for (std::uint32_t i = begin; i < end; ++i) {
        if (i != begin) {
            out = compose(p.fixed[i], out);
        }
        move_by(p.joints[i], at(i), sines, out);
    }
    return out;
}

/// From the first body to the middle of the path.
template <class At, class Sines>
AXG_HD Pose right_of(const PoseProduct& p, const At& at, const Sines& sines) noexcept {
    return stretch_of(p, 0, p.split, at, sines);
}

/// From the middle of the path to the second body.
template <class At, class Sines>
AXG_HD Pose left_of(const PoseProduct& p, const At& at, const Sines& sines) noexcept {
    return p.split == p.count
               ? p.fixed[p.count]
               : compose(p.fixed[p.count], stretch_of(p, p.split, p.count, at, sines));
}

/// The whole product.
template <class At, class Sines>
AXG_HD Pose pose_of(const PoseProduct& p, const At& at, const Sines& sines) noexcept {
    if (p.count == 0) {
        return p.fixed[0];
    }
    return compose(left_of(p, at, sines), right_of(p, at, sines));
}

}  // namespace axg
