// SPDX-License-Identifier: Apache-2.0
// Bounds the space that a body can reach while the axes stay in a joint box: the body's own box,
// placed as at the centre, widened on all sides by the largest motion of any point. For pages.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct ReachBody {
    std::uint32_t body = kNoIndex;
    Pose placed;                // the mesh frame in machine coordinates, at the box's centre
    Vec3d low_mm{}, high_mm{};  // in the mesh frame: contains every point of the surface
    double moves_mm = 0;        // bound of the motion of its points from the box's centre
};

/// @param at      mesh frame to the body's frame at the zero pose (JointBoxTask::at_a)
/// @param extent  of the surface, in its mesh frame
/// Source: as core/certificate/joint_path.hpp: a joint moves a point by its half width, or by the
/// arc at the point's largest distance from its axis; the motions of all joints add up.
[[nodiscard]] ReachBody reach_body(const Machine& machine, std::uint32_t body, const Pose& at,
                                   const BodyExtent& extent, const JointBox& box) noexcept;

}  // namespace axg
