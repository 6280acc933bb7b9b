// SPDX-License-Identifier: Apache-2.0
// The pairs that a cycle has to prove: one task for each pair, and for each tool if a tool is part
// of the pair and may be in the spindle. Memory for tasks, results and proofs.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/collision/containment.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"
#include "core/reach/reach.hpp"

namespace axg {

/// The task of a pair with one tool; the caller sets its box.
/// @param extents  [surfaces] in the engine's order; they must outlive the task
[[nodiscard]] JointBoxTask pair_task(const Machine& machine, std::uint32_t pair, std::uint32_t tool,
                                     std::span<const BodyExtent> extents) noexcept;

/// Number of pairs that one cycle may have to prove: a pair with a tool counts once for each tool.
[[nodiscard]] std::uint32_t stop_tasks(const Machine& machine) noexcept;

/// One pair, with one tool if a tool is part of it, over the reachable box.
struct PairProof {
    std::uint32_t pair = kNoIndex;  // Machine::pairs
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: none in this pair
    JointBoxResult surfaces;
    ContainmentResult containment_result;
};

/// The tools that may be in the spindle until no earlier permit is in force. A board may report the
/// number of the next tool while the last one is still in the spindle, so both count; if the number
/// changes again, all of them count. During a tool change every tool does.
class SpindleTools {
  public:
    /// @param before  the snapshot before `now`
    void note(const Machine& machine, const AxisSnapshot& before, const AxisSnapshot& now,
              bool is_first) noexcept;
    /// Whether the snapshot can be queried; finds its tool.
    [[nodiscard]] SnapshotStatus judge(const Machine& machine,
                                       const AxisSnapshot& snapshot) noexcept {
        return judge_snapshot(machine, snapshot, tool_);
    }
    /// @param tool  kNoIndex: a pair without a tool
    [[nodiscard]] bool may_hold(std::uint32_t tool, const AxisSnapshot& snapshot) const noexcept {
        return tool == kNoIndex || tool == tool_ || snapshot.sample < until_[tool] ||
               snapshot.mode == kModeToolChange;
    }

  private:
    std::uint32_t tool_ = kNoIndex;                 // of the newest judged snapshot
    std::array<std::uint64_t, kToolsMax> until_{};  // first sample at which each earlier tool no
                                                    // longer counts
};

/// A pair with one tool, at its place among all of them.
struct PairSlot {
    JointBoxTask task;  // without its box
    std::uint32_t pair, tool;
};

class PairTasks {
  public:
    [[nodiscard]] static std::size_t size_bytes(const Machine& machine,
                                                std::size_t surfaces) noexcept;
    /// Takes its memory from `arena`.
    PairTasks(const Machine& machine, std::span<const Mesh* const> surfaces, Arena& arena) noexcept;

    void clear() noexcept { count_ = 0; }
    /// Lists the tasks over these boxes.
    void list(const SpindleTools& tools, const AxisSnapshot& snapshot, const Reach& reach) noexcept;
    /// Copies the tasks behind themselves, over one larger box.
    void add_wider(const JointBox& box) noexcept;

    [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
    [[nodiscard]] std::span<const PairSlot> slots() const noexcept { return slots_; }
    /// Place in `slots` of the task.
    [[nodiscard]] std::uint32_t slot_of(std::uint32_t task) const noexcept { return listed_[task]; }
    // [twice count]: the wider ones follow
    [[nodiscard]] std::span<JointBoxTask> tasks() noexcept { return tasks_; }
    [[nodiscard]] std::span<const JointBoxTask> tasks() const noexcept { return tasks_; }
    [[nodiscard]] std::span<JointBoxResult> results() noexcept { return results_; }
    [[nodiscard]] std::span<PairProof> proofs() const noexcept { return proofs_.first(count_); }

  private:
    std::span<BodyExtent> extents_;      // [surfaces]
    std::span<PairSlot> slots_;          // [pairs with each tool]
    std::span<std::uint32_t> listed_;    // slots of the tasks
    std::span<JointBoxTask> tasks_;      // and as many for the longer permit
    std::span<JointBoxResult> results_;  // likewise
    std::span<PairProof> proofs_;
    std::uint32_t count_ = 0;
};

}  // namespace axg
