// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/pair_tasks.hpp"

#include <cmath>

#include "core/base/assert.hpp"
#include "core/certificate/travel.hpp"
#include "core/machine/kinematics.hpp"
#include "core/reach/stop_limits.hpp"

namespace axg {
namespace {

std::uint32_t tasks_at_once(const Machine& machine) noexcept {
    return stop_tasks(machine) * (tries_longer(machine.can.permit_samples) ? 2 : 1);
}

}  // namespace

std::uint32_t stop_tasks(const Machine& machine) noexcept {
    std::uint32_t count = 0;
    for (const Pair& pair : machine.pairs) {
        count += tasks_of(machine, pair);
    }
    return count;
}

JointBoxTask pair_task(const Machine& machine, std::uint32_t pair, std::uint32_t tool,
                       std::span<const BodyExtent> extents) noexcept {
    const Pair& p = machine.pairs[pair];
    JointBoxTask task;
    // Uses the extent of the queried surface for levers: no other surface has to stay away.
    const auto place = [&](std::uint32_t body, std::uint32_t against, std::uint32_t& mesh, Pose& at,
                           const BodyExtent*& extent) {
        const bool is_tool = machine.bodies[body].is_tool;
        mesh = mesh_in_pair(machine, body, against, tool);
        AXG_ASSERT(mesh < extents.size());
        at = machine.bodies[body].at;
        at = is_tool ? compose(at, machine.tools[tool].at) : at;
        extent = &extents[mesh];
        task.pose_error_mm += deviation_of(machine, body, tool);
    };
    task.pose_error_mm = kPlacementErrorMm + pose_error_of(machine, pair);
    task.body_a = p.a;
    task.body_b = p.b;
    place(p.a, p.b, task.mesh_a, task.at_a, task.extent_a);
    place(p.b, p.a, task.mesh_b, task.at_b, task.extent_b);
    task.path = path_between(machine, p.a, p.b);
    task.margin_mm = p.margin_mm;
    return task;
}

/// An older permit may end after a newer one, so this assumes the longest permit, whatever was
/// sent.
void SpindleTools::note(const Machine& machine, const AxisSnapshot& before, const AxisSnapshot& now,
                        bool is_first) noexcept {
    if (is_first) {
        until_ = {};
        return;
    }
    std::uint32_t was = kNoIndex, is = kNoIndex;
    const bool are_known = judge_snapshot(machine, before, was) == SnapshotStatus::ok &&
                           judge_snapshot(machine, now, is) == SnapshotStatus::ok;
    if (are_known && was != is && was != kNoIndex) {
        const double longest_s = free_seconds(machine, machine.can.permit_samples.most);
        const double samples = std::ceil(longest_s * 1e6 / machine.can.sample_us);
        until_[was] = now.sample + static_cast<std::uint64_t>(samples) + 1;
    }
}

std::size_t PairTasks::size_bytes(const Machine& machine, std::size_t surfaces) noexcept {
    const std::uint32_t slots = stop_tasks(machine), tasks = tasks_at_once(machine);
    return Arena::size_bytes<BodyExtent>(surfaces) + Arena::size_bytes<PairSlot>(slots) +
           Arena::size_bytes<std::uint32_t>(slots) + Arena::size_bytes<JointBoxTask>(tasks) +
           Arena::size_bytes<JointBoxResult>(tasks) + Arena::size_bytes<PairProof>(slots);
}

PairTasks::PairTasks(const Machine& machine, std::span<const Mesh* const> surfaces,
                     Arena& arena) noexcept
    : extents_(arena.take<BodyExtent>(surfaces.size())),
      slots_(arena.take<PairSlot>(stop_tasks(machine))),
      listed_(arena.take<std::uint32_t>(slots_.size())),
      tasks_(arena.take<JointBoxTask>(tasks_at_once(machine))),
      results_(arena.take<JointBoxResult>(tasks_.size())),
      proofs_(arena.take<PairProof>(slots_.size())) {
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        extents_[i] = extent_of(*surfaces[i]);
    }
    std::uint32_t place = 0;
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            const std::uint32_t tool = has_tool(machine, pair) ? k : kNoIndex;
            PairSlot& slot = slots_[place];
            slot = {pair_task(machine, i, tool, extents_), i, tool};
            const TravelProof known = travel_proof(machine, place++);
            slot.task.pruned = {
                .up_to_mm = known.distance_mm,
                .is_apart = known.is_apart,
                .mesh_a = pruned_mesh_index(machine, known.surface_a, slot.task.mesh_a),
                .mesh_b = pruned_mesh_index(machine, known.surface_b, slot.task.mesh_b)};
        }
    }
}

void PairTasks::list(const SpindleTools& tools, const AxisSnapshot& snapshot,
                     const Reach& reach) noexcept {
    count_ = 0;
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        if (tools.may_hold(slots_[i].tool, snapshot)) {
            listed_[count_] = i;
            tasks_[count_] = slots_[i].task;
            tasks_[count_].box = reach.box;
            tasks_[count_].pieces = reach.pieces;
            ++count_;
        }
    }
}

void PairTasks::add_wider(const JointBox& box) noexcept {
    for (std::uint32_t i = 0; i < count_; ++i) {
        JointBoxTask& task = tasks_[count_ + i] = tasks_[i];
        task.box = box;
        task.pieces = {};
    }
}

}  // namespace axg
