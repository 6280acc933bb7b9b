// SPDX-License-Identifier: Apache-2.0
// Turns tasks into boxes and boxes into queries: the roots, their halves, levers computed once, and
// poses of a grid. The prover decides which boxes to query.
// Source: docs/theory/certificate.md, "The prover".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/box_poses.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/query_tree.hpp"
#include "core/machine/machine.hpp"

namespace axg {

class BoxQueries {
  public:
    [[nodiscard]] static constexpr std::size_t size_bytes(std::size_t tasks) noexcept {
        return Arena::size_bytes<PathLevers>(tasks) + Arena::size_bytes<BoxPoses>(1);
    }
    /// `machine` and `arena` must outlive this.
    /// @param are_float_only  Query::is_float_only of every query
    BoxQueries(const Machine& machine, std::size_t tasks, bool are_float_only,
               Arena& arena) noexcept;

    [[nodiscard]] bool are_float_only() const noexcept { return are_float_only_; }

    /// Starts over: finds the whole boxes that need queries, and computes their levers. Sets the
    /// result of a task without root to `bad_box` or, if pruning proves it, `proven`. A task with a
    /// root starts as `proven` until one of its parts remains unproven.
    /// @return  number of roots, at most one per task
    std::uint32_t find_roots(std::span<const JointBoxTask> tasks, std::span<JointBoxResult> results,
                             std::span<BoxItem> roots) noexcept;

    /// Sets the axis along which to cut each item. Precondition: parts of one box are adjacent in
    /// `items` and were cut along the same axes: a grid.
    /// @param queries  [items] out; empty: not requested
    void pose(std::span<const JointBoxTask> tasks, std::span<BoxItem> items,
              std::span<Query> queries) noexcept;

    /// One of the two items that cover it; copies only the machine's axes. Precondition: the item
    /// can be cut.
    void halve(const JointBoxTask& task, const BoxItem& item, bool is_upper,
               BoxItem& out) const noexcept;

    /// Cuts of boxes of one grid into parts, `depth` levels deep, for an engine that poses parts.
    struct TreePlan {
        std::uint32_t axes[kTreeDepthOfParts];  // axis to cut along at each level
        std::uint32_t widest_axis;              // of a part (BoxItem)
    };
    /// Empty: the engine's limit of trees or joints is exceeded, a root is a piece of a path, or a
    /// box cannot be cut `depth` times.
    /// @param roots  the roots of each task adjacent
    /// @param trees, plans  [kQueryTreesMax] out
    /// @param out    [roots] tree and centres of each root; the caller sets the group
    /// @return number of trees
    [[nodiscard]] std::optional<std::uint32_t> plan_parts(
        std::span<const JointBoxTask> tasks, std::span<const BoxItem> roots, std::uint32_t depth,
        std::span<QueryTree> trees, std::span<TreePlan> plans, std::span<TreeRoot> out) noexcept;

    /// One of those parts. Precondition: plan_parts returned `plan` for this root and depth.
    void make_part(const JointBoxTask& task, const BoxItem& root, const TreePlan& plan,
                   std::uint32_t depth, std::uint32_t part, BoxItem& out) const noexcept;

    /// Whether pruning left no triangle of this pair and the box is within the travel.
    [[nodiscard]] bool is_proven_already(const JointBoxTask& task,
                                         const JointBox& box) const noexcept;

  private:
    void find_levers(std::span<const JointBoxTask> tasks, std::span<const BoxItem> roots) noexcept;
    [[nodiscard]] bool plan_tree(const JointBoxTask& task, const BoxItem& root, std::uint32_t depth,
                                 QueryTree& tree, TreePlan& plan) noexcept;
    void pose_grid(const JointBoxTask& task, std::span<BoxItem> items,
                   std::span<Query> queries) noexcept;

    const Machine* machine_;
    bool are_float_only_;
    std::span<PathLevers> levers_;  // [tasks] over the whole boxes
    BoxPoses* poses_;               // in the arena
};

}  // namespace axg
