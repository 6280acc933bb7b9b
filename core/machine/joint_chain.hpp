// SPDX-License-Identifier: Apache-2.0
// Poses of bodies from axis positions as plain data, for a GPU that makes them itself: each body's
// joints in a row, from the machine's frame on. One source for host and device; the same operations
// in the same order as place_bodies() and relative_pose(), so the same bits. Double, mm, rad.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/finite.hpp"
#include "core/base/host_device.hpp"
#include "core/base/limits.hpp"
#include "core/base/pose.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/machine.hpp"
#include "core/machine/pose_product.hpp"

namespace axg {

/// One joint of a chain.
struct ChainJoint {
    Vec3d direction{0, 0, 1}, pivot_mm{};
    std::uint32_t axis = 0;  // place in a row of positions
    bool is_linear = true;
};

/// A body: joints[first .. first + count), then its mesh's frame and, in the tool body, the tool's.
struct PlacedChain {
    std::uint32_t first = 0, count = 0;
    bool has_tool = false;
    Pose at, tool_at;
};

/// Whether a position may be posed: finite, and an angle within what sin_cos() allows.
AXG_HD bool may_pose(const ChainJoint& joint, double position) noexcept {
    return is_finite(position) &&
           (joint.is_linear ? __builtin_fabs(position) <= kCoordinateMmMax
                            : __builtin_fabs(position) <= kSinCosArgumentMax);
}

/// Places one body. False: a position may not be posed.
/// @param position  [axes] mm or rad
AXG_HD bool place_chain(const ChainJoint* joints, const PlacedChain& chain, const double* position,
                        Pose& placed) noexcept {
    placed = Pose{};
    for (std::uint32_t i = 0; i < chain.count; ++i) {
        const ChainJoint& joint = joints[chain.first + i];
        const double at = position[joint.axis];
        if (!may_pose(joint, at)) {
            return false;
        }
        placed = compose(placed, joint.is_linear
                                     ? linear_motion(joint.direction, at)
                                     : rotary_motion(joint.direction, joint.pivot_mm, sin_cos(at)));
    }
    placed = compose(placed, chain.at);
    if (chain.has_tool) {
        placed = compose(placed, chain.tool_at);
    }
    return true;
}

/// The chains of a machine: of each body, and of the tool body with each tool.
struct MachineChains {
    std::vector<ChainJoint> joints;
    std::vector<PlacedChain> chains;  // bodies, then tools: in the order of the engine's meshes
    std::uint32_t axes = 0;
};
[[nodiscard]] MachineChains chains_of(const Machine& machine);

}  // namespace axg
