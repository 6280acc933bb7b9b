// SPDX-License-Identifier: Apache-2.0
// Where a body can get while the axes stay in a joint box: its own box, turned as the body is at
// the centre, and wider on all sides by the farthest that any point of the body moves. For pages.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct ReachBody {
    std::uint32_t body = kNoIndex;
    Pose placed;                // the mesh frame in machine coordinates, at the box's centre
    Vec3d low_mm{}, high_mm{};  // in the mesh frame: every point of the surface stays within
    double moves_mm = 0;        // no point of it gets farther from its place at the centre
};

/// @param at      mesh frame to the body's frame at the zero pose (JointBoxTask::at_a)
/// @param extent  of the surface, in its mesh frame
/// Source: as core/certificate/joint_path.hpp: a joint moves a point by its half width, or by the
/// arc at the point's largest distance from its axis, and the joints' parts add up.
[[nodiscard]] ReachBody reach_body(const Machine& machine, std::uint32_t body, const Pose& at,
                                   const BodyExtent& extent, const JointBox& box) noexcept;

}  // namespace axg
