// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/box_queries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/fetch.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {

namespace {

constexpr std::size_t kAhead = 8;  // queries

/// Whether the box is finite and within the range of kinematics, of the engine, and of the stated
/// errors.
bool is_good(const Machine& machine, const JointBox& box) noexcept {
    const PoseErrors& errors = machine.pose_errors;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double limit = machine.axes[i].kind == AxisKind::rotary ? kSinCosArgumentMax
                             : errors.are_stated                      ? errors.within[i]
                                                                      : kCoordinateMmMax;
        if (!(box.half[i] >= 0 && std::fabs(box.centre[i]) + box.half[i] <= limit)) {  // NaN fails
            return false;
        }
    }
    return true;
}

/// The box that is cut into a grid's parts: a leaf of the task's pieces, or its own box.
const JointBox& grid_of(const JointBoxTask& task, std::uint32_t grid) noexcept {
    return grid == kNoIndex ? task.box : task.pieces[grid];
}

/// Copies only the machine's axes. Copying all kAxesMax would cost half the time of posing.
void copy_box(const Machine& machine, const JointBox& from, JointBox& to) noexcept {
    std::copy_n(from.centre.begin(), machine.axes.size(), to.centre.begin());
    std::copy_n(from.half.begin(), machine.axes.size(), to.half.begin());
}

}  // namespace

BoxQueries::BoxQueries(const Machine& machine, std::size_t tasks, bool are_float_only,
                       Arena& arena) noexcept
    : machine_(&machine),
      are_float_only_(are_float_only),
      levers_(arena.take<PathLevers>(tasks)),
      poses_(std::construct_at(arena.take<BoxPoses>(1).data(), machine)) {}

bool BoxQueries::is_proven_already(const JointBoxTask& task, const JointBox& box) const noexcept {
    return task.pruned.is_apart && is_pruned_for(*machine_, task, box);
}

std::uint32_t BoxQueries::find_roots(std::span<const JointBoxTask> tasks,
                                     std::span<JointBoxResult> results,
                                     std::span<BoxItem> roots) noexcept {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < tasks.size(); ++i) {
        results[i] = JointBoxResult{};
        const bool has_pieces = !tasks[i].pieces.empty();
        const JointBox& box = has_pieces ? tasks[i].pieces[0] : tasks[i].box;
        if (!is_good(*machine_, box)) {
            results[i].proof = JointBoxProof::bad_box;
            results[i].open = box;
            continue;
        }
        results[i].proof = JointBoxProof::proven;  // until an item of it remains unproven
        if (is_proven_already(tasks[i], box)) {
            continue;
        }
        roots[count++] = {i, kNoIndex, has_pieces ? 0 : kNoIndex, kNoIndex, 0, box};
    }
    find_levers(tasks, roots.first(count));
    return count;
}

/// Computes the levers of every root over its whole box: they are valid for every part of it.
void BoxQueries::find_levers(std::span<const JointBoxTask> tasks,
                             std::span<const BoxItem> roots) noexcept {
    std::array<Pose, kBodiesMax> moved;
    const JointBox* before = nullptr;
    for (const BoxItem& item : roots) {
        const JointBoxTask& task = tasks[item.task];
        if (before == nullptr || before->centre != item.box.centre) {  // mostly the same
            move_bodies(*machine_, item.box.centre, moved);
        }
        before = &item.box;
        const PlacedPair pair = placed_pair(task, moved);
        levers_[item.task] = levers_over(*machine_, task.path, moved, pair.a, pair.b, item.box);
    }
}

void BoxQueries::pose(std::span<const JointBoxTask> tasks, std::span<BoxItem> items,
                      std::span<Query> queries) noexcept {
    for (std::size_t first = 0, end = 0; first < items.size(); first = end) {
        const BoxItem& item = items[first];
        end = first + 1;
        while (end < items.size() && items[end].task == item.task && item.piece == kNoIndex &&
               items[end].grid == item.grid) {
            ++end;
        }
        pose_grid(tasks[item.task], items.subspan(first, end - first),
                  queries.empty() ? queries : queries.subspan(first, end - first));
    }
}

void BoxQueries::pose_grid(const JointBoxTask& task, std::span<BoxItem> items,
                           std::span<Query> queries) noexcept {
    const BoxItem& first = items.front();
    const PathMotion motion = motion_by(*machine_, task.path, levers_[first.task], first.box.half);
    for (BoxItem& item : items) {
        item.widest_axis = motion.widest_axis;
    }
    if (queries.empty()) {
        return;
    }
    poses_->begin(task, grid_of(task, first.grid), first.box, first.cut);
    for (std::size_t i = 0; i < items.size(); ++i) {
        // Only the remaining triangles need the motion bound. Levers of whole surfaces are no
        // shorter than theirs.
        const bool is_pruned = is_pruned_for(*machine_, task, items[i].box);
        fetch_to_write(queries, i + kAhead);
        queries[i] = Query{.is_float_only = are_float_only_,
                           .mesh_a = is_pruned ? task.pruned.mesh_a : task.mesh_a,
                           .mesh_b = is_pruned ? task.pruned.mesh_b : task.mesh_b,
                           .r_mm = task.margin_mm + motion.total_mm,
                           .pose_error_mm = task.pose_error_mm,
                           .pose = poses_->at(items[i].box.centre)};
    }
}

/// Computes what is common to the parts of boxes cut like this one. False: the box cannot be cut
/// `depth` times, or too many joints.
bool BoxQueries::plan_tree(const JointBoxTask& task, const BoxItem& root, std::uint32_t depth,
                           QueryTree& tree, TreePlan& plan) noexcept {
    const JointBox& grid = grid_of(task, root.grid);
    JointBox box = root.box;
    std::uint32_t cut = root.cut;
    for (std::uint32_t level = 0; level < depth; ++level) {
        const std::uint32_t axis =
            motion_by(*machine_, task.path, levers_[root.task], box.half).widest_axis;
        if (axis == kNoIndex) {
            return false;
        }
        plan.axes[level] = axis;
        tree.quarter[level] = 0.5 * box.half[axis];
        cut |= 1U << axis;
        axg::halve(box, axis, false, grid);
    }
    const PathMotion motion = motion_by(*machine_, task.path, levers_[root.task], box.half);
    plan.widest_axis = motion.widest_axis;
    poses_->begin(task, grid, box, cut);
    const PoseProduct product = poses_->product();
    if (product.count > kTreeJointsMax) {
        return false;
    }
    tree.kind = QueryKind::farther;
    tree.is_float_only = are_float_only_;
    tree.joints = product.count;
    tree.split = product.split;
    tree.r_mm = task.margin_mm + motion.total_mm;
    tree.pose_error_mm = task.pose_error_mm;
    tree.is_apart = task.pruned.is_apart;
    std::copy_n(product.joints, product.count, tree.joint);
    std::copy_n(product.fixed, product.count + 1, tree.fixed);
    JointBox uncut = box;  // its axes along which no part is cut; the others inside the travel
    const Travel& travel = machine_->travel;
    for (std::uint32_t i = 0; i < product.count; ++i) {
        const std::uint32_t axis = poses_->axis(i);
        const bool is_bounded = !machine_->axes[axis].unlimited;
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        TreeCut& to = tree.cut[i];
        to = {box.half[axis], is_bounded ? travel.low[axis] : -kInfinity,
              is_bounded ? travel.high[axis] : kInfinity};
        for (std::uint32_t level = 0; level < depth; ++level) {
            to.levels |= plan.axes[level] == axis ? 1U << level : 0;
        }
        uncut.centre[axis] = 0.5 * (travel.low[axis] + travel.high[axis]);
        uncut.half[axis] = 0;
    }
    tree.may_be_pruned = is_pruned_for(*machine_, task, uncut);
    return true;
}

std::optional<std::uint32_t> BoxQueries::plan_parts(std::span<const JointBoxTask> tasks,
                                                    std::span<const BoxItem> roots,
                                                    std::uint32_t depth, std::span<QueryTree> trees,
                                                    std::span<TreePlan> plans,
                                                    std::span<TreeRoot> out) noexcept {
    std::uint32_t count = 0;
    const BoxItem* before = nullptr;
    for (std::size_t i = 0; i < roots.size(); ++i) {
        const BoxItem& root = roots[i];
        const JointBoxTask& task = tasks[root.task];
        const bool is_alike =
            before != nullptr && before->task == root.task && before->piece == root.piece &&
            before->grid == root.grid && before->cut == root.cut &&
            std::equal(root.box.half.begin(),
                       root.box.half.begin() + static_cast<std::ptrdiff_t>(machine_->axes.size()),
                       before->box.half.begin());
        if (!is_alike) {
            if (root.piece != kNoIndex || count == kQueryTreesMax ||
                !plan_tree(task, root, depth, trees[count], plans[count])) {
                return std::nullopt;
            }
            ++count;
        }
        before = &root;
        TreeRoot& to = out[i];
        to.mesh_a = task.mesh_a;
        to.mesh_b = task.mesh_b;
        to.pruned_a = task.pruned.mesh_a;
        to.pruned_b = task.pruned.mesh_b;
        to.tree = static_cast<std::uint16_t>(count - 1);
        // Alike roots share a tree: the cut axes are those of the newest plan_tree.
        const QueryTree& tree = trees[count - 1];
        for (std::uint32_t k = 0; k < tree.joints; ++k) {
            to.centre[k] = root.box.centre[poses_->axis(k)];
        }
    }
    return count;
}

void BoxQueries::make_part(const JointBoxTask& task, const BoxItem& root, const TreePlan& plan,
                           std::uint32_t depth, std::uint32_t part, BoxItem& out) const noexcept {
    out.task = root.task;
    out.widest_axis = plan.widest_axis;
    out.piece = kNoIndex;
    out.grid = root.grid;
    out.cut = root.cut;
    copy_box(*machine_, root.box, out.box);
    for (std::uint32_t level = 0; level < depth; ++level) {
        const bool is_upper = (part >> (depth - 1 - level) & 1U) != 0;
        axg::halve(out.box, plan.axes[level], is_upper, grid_of(task, root.grid));
        out.cut |= 1U << plan.axes[level];
    }
}

void BoxQueries::halve(const JointBoxTask& task, const BoxItem& item, bool is_upper,
                       BoxItem& out) const noexcept {
    const bool is_cut = item.piece != kNoIndex && 2 * item.piece + 2 < task.pieces.size();
    out.task = item.task;
    out.widest_axis = kNoIndex;
    out.piece = is_cut ? 2 * item.piece + (is_upper ? 2U : 1U) : kNoIndex;
    out.grid = item.piece != kNoIndex && !is_cut ? item.piece : item.grid;
    out.cut = is_cut ? 0 : item.cut | 1U << item.widest_axis;
    copy_box(*machine_, is_cut ? task.pieces[out.piece] : item.box, out.box);
    if (!is_cut) {
        axg::halve(out.box, item.widest_axis, is_upper, grid_of(task, out.grid));
    }
}

}  // namespace axg
