// SPDX-License-Identifier: Apache-2.0
// Queries about the parts of boxes that were all cut alike, in few numbers: a part's place among
// them determines its centre, and the centre its pose. An engine on a GPU poses them itself, with
// the same code as the host, so the queries are equal bit by bit.
// Source: docs/theory/certificate.md, "Levers once".
#pragma once

#include <cstdint>
#include <span>

#include "core/base/host_device.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/pose_product.hpp"

namespace axg {

inline constexpr std::uint32_t kTreeJointsMax = 6;  // of one box
inline constexpr std::uint32_t kTreeDepthOfParts = 10;
inline constexpr std::uint32_t kQueryTreesMax = 64;  // in a call

/// How boxes were cut along the axis of a joint.
struct TreeCut {
    double half = 0;           // of every part, mm or rad
    double low = 0, high = 0;  // of the travel that pruned surfaces are for
    std::uint32_t levels = 0;  // one bit each
    std::uint32_t unused = 0;
};

/// The data that all parts of a task share.
struct alignas(16) QueryTree {
    QueryKind kind = QueryKind::farther;
    bool is_float_only = false;
    // The margin and the axes that are not cut along allow for pruned surfaces.
    bool may_be_pruned = false;
    bool is_apart = false;                // and pruning left no surface there: such a part is far
    std::uint32_t joints = 0, split = 0;  // PoseProduct::count and split
    double r_mm = 0, pose_error_mm = 0;
    double quarter[kTreeDepthOfParts] = {};  // by level: how far a centre moves
    PathJoint joint[kTreeJointsMax];         // those that boxes were cut along, in the path's order
    TreeCut cut[kTreeJointsMax];
    Pose fixed[kTreeJointsMax + 1];
};

/// One box; each of its 2^depth parts is a query.
struct alignas(16) TreeRoot {
    double centre[kTreeJointsMax] = {};    // by joint, mm or rad
    std::uint32_t mesh_a = 0, mesh_b = 0;  // Query::mesh_a, Query::mesh_b
    std::uint32_t pruned_a = 0, pruned_b = 0;
    std::uint16_t tree = 0;   // rising by at most one from root to root
    std::uint16_t group = 0;  // Query::group
};

/// The parts of a root are in the order of their places, the first cut first.
struct PartQueries {
    std::span<const QueryTree> trees{};  // at most kQueryTreesMax
    std::span<const TreeRoot> roots{};
    std::uint32_t depth = 1;  // cuts of each: 1 to kTreeDepthOfParts

    [[nodiscard]] std::size_t count() const noexcept { return roots.size() << depth; }
};

/// The lowest bit that is set. Precondition: one is.
AXG_HD std::uint32_t lowest_bit(std::uint32_t bits) noexcept {
#if defined(__CUDA_ARCH__)
    return static_cast<std::uint32_t>(__ffs(static_cast<int>(bits))) - 1;
#else
    return static_cast<std::uint32_t>(__builtin_ctz(bits));
#endif
}

/// A part of a root; computes its centre.
struct Part {
    const QueryTree& tree;
    const TreeRoot& root;
    std::uint32_t depth, place;

    /// Centre along the axis of a joint, mm or rad.
    AXG_HD double operator()(std::uint32_t joint) const noexcept {
        double centre = root.centre[joint];
        for (std::uint32_t left = tree.cut[joint].levels; left != 0; left &= left - 1) {
            const std::uint32_t level = lowest_bit(left);
            const bool is_upper = (place >> (depth - 1 - level) & 1U) != 0;
            centre = is_upper ? centre + tree.quarter[level] : centre - tree.quarter[level];
        }
        return centre;
    }
};

AXG_HD PoseProduct product_of(const QueryTree& tree) noexcept {
    return {tree.joint, tree.fixed, tree.joints, tree.split};
}

/// Fills the query about a part, except for its pose. True: the part is far without a query.
AXG_HD bool fill_query(const Part& part, Query& query) noexcept {
    const QueryTree& tree = part.tree;
    const TreeRoot& root = part.root;
    bool is_pruned = tree.may_be_pruned;
    for (std::uint32_t i = 0; is_pruned && i < tree.joints; ++i) {
        const TreeCut& cut = tree.cut[i];
        const double centre = part(i);
        is_pruned = centre - cut.half >= cut.low && centre + cut.half <= cut.high;
    }
    query.kind = tree.kind;
    query.is_float_only = tree.is_float_only;
    query.group = root.group;
    query.mesh_a = is_pruned ? root.pruned_a : root.mesh_a;
    query.mesh_b = is_pruned ? root.pruned_b : root.mesh_b;
    query.r_mm = tree.r_mm;
    query.pose_error_mm = tree.pose_error_mm;
    return is_pruned && tree.is_apart;
}

/// Fills the whole query; as above.
AXG_HD bool part_query(const Part& part, Query& query) noexcept {
    query.pose =
        pose_of(product_of(part.tree), part, [](double angle_rad) { return sin_cos(angle_rad); });
    return fill_query(part, query);
}

}  // namespace axg
