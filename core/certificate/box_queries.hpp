// SPDX-License-Identifier: Apache-2.0
// From tasks to boxes, and from boxes to queries: the roots, their halves, levers once, poses of a
// grid. Which boxes are queried is the prover's matter.
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
    /// @param are_float_only  of every query: Query::is_float_only
    BoxQueries(const Machine& machine, std::size_t tasks, bool are_float_only,
               Arena& arena) noexcept;

    [[nodiscard]] bool are_float_only() const noexcept { return are_float_only_; }

    /// Starts over: the whole boxes that have to be queried, with their levers. The results of the
    /// others say why not; those of these say `proven`, until a part is left unproven.
    /// @return  how many, at most one a task
    std::uint32_t find_roots(std::span<const JointBoxTask> tasks, std::span<JointBoxResult> results,
                             std::span<BoxItem> roots) noexcept;

    /// Says which axis each item is cut along. Parts of one box stand together in `items`, and all
    /// of them were cut alike: a grid.
    /// @param queries  [items] out; empty: not requested
    void pose(std::span<const JointBoxTask> tasks, std::span<BoxItem> items,
              std::span<Query> queries) noexcept;

    /// One of the two that cover it, of the machine's axes. Precondition: it can be cut.
    void halve(const JointBoxTask& task, const BoxItem& item, bool is_upper,
               BoxItem& out) const noexcept;

    /// How an engine poses the parts of boxes that were all cut alike, `depth` times more.
    struct TreePlan {
        std::uint32_t axes[kTreeDepthOfParts];  // that are cut along, level by level
        std::uint32_t widest_axis;              // of a part (BoxItem)
    };
    /// Empty: of more trees or joints than an engine has room for, of pieces of a path, or of boxes
    /// that cannot be cut so often.
    /// @param roots  each task's together
    /// @param trees, plans  [kQueryTreesMax] out
    /// @param out    [roots] which tree and where; the group is the caller's to say
    /// @return how many trees
    [[nodiscard]] std::optional<std::uint32_t> plan_parts(
        std::span<const JointBoxTask> tasks, std::span<const BoxItem> roots, std::uint32_t depth,
        std::span<QueryTree> trees, std::span<TreePlan> plans, std::span<TreeRoot> out) noexcept;

    /// One of those parts. Precondition: as planned.
    void make_part(const JointBoxTask& task, const BoxItem& root, const TreePlan& plan,
                   std::uint32_t depth, std::uint32_t part, BoxItem& out) const noexcept;

    /// Of a pair that was proven for the whole travel.
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
