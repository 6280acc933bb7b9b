// SPDX-License-Identifier: Apache-2.0
// Proves that pairs of bodies are farther apart than their margin everywhere in a joint box. The
// proof covers every instant in it, with no tunnelling between samples. The prover splits a box
// that one query does not prove along the axis that moves most, breadth first, within a fixed
// number of rounds and queries. Budget spent = not proven.
// Source: docs/theory/certificate.md, "The prover".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// A pair's surfaces without the never-colliding set, for queries about boxes within the travel
/// (core/certificate/travel.hpp).
struct PrunedSurfaces {
    double up_to_mm = -1;   // valid for margins up to this; negative: no pruning
    bool is_apart = false;  // no triangle remains: a box needs no query
    std::uint32_t mesh_a = 0, mesh_b = 0;
};

/// One pair over one box, or over a stretch of a path that the box encloses.
struct JointBoxTask {
    std::uint32_t body_a = 0, body_b = 0;  // Machine::bodies
    std::uint32_t mesh_a = 0, mesh_b = 0;  // indices of the engine's surfaces
    const BodyExtent* extent_a = nullptr;
    const BodyExtent* extent_b = nullptr;
    Pose at_a, at_b;  // mesh frames to the bodies' frames at the zero pose (Body::at, Tool::at)
    JointPath path;
    double margin_mm = 0;
    // Error of every query: arithmetic, plus the deviation of simplified surfaces.
    double pose_error_mm = kPlacementErrorMm;
    PrunedSurfaces pruned;
    JointBox box;
    // The stretch as a binary tree of boxes: piece 0 encloses all of it, and the children of piece
    // i are 2 i + 1 and 2 i + 2. The prover queries these before it splits a box. Empty: no
    // stretch, only `box`.
    std::span<const JointBox> pieces{};
};

/// The placed bodies of a pair.
struct PlacedPair {
    PlacedBody a, b;
};
/// @param moved  [bodies] motions at some position of the axes (move_bodies)
[[nodiscard]] PlacedPair placed_pair(const JointBoxTask& task,
                                     std::span<const Pose> moved) noexcept;

/// Query whether the pair is more than `r_mm` apart at these poses.
[[nodiscard]] Query query_of(const JointBoxTask& task, const PlacedPair& pair,
                             double r_mm) noexcept;

/// The lower or upper half of the box. Both halves together cover it, roundings included. They are
/// equally wide, like all boxes cut from the grid along the same axes.
/// @param grid  the whole box that this one was cut from, or this box itself
[[nodiscard]] JointBox half_of(const JointBox& box, std::uint32_t axis, bool is_upper,
                               const JointBox& grid) noexcept;
/// The same in place.
void halve(JointBox& box, std::uint32_t axis, bool is_upper, const JointBox& grid) noexcept;

/// Whether the pruned triangles stay beyond the margin everywhere in the box: queries about the box
/// may then use the pruned surfaces.
[[nodiscard]] bool is_pruned_for(const Machine& machine, const JointBoxTask& task,
                                 const JointBox& box) noexcept;

/// Whether the halves of an unproven box may be proven: each needs less distance and less work.
[[nodiscard]] bool may_help_to_split(QueryStatus status, double r_mm) noexcept;

enum class JointBoxProof : std::uint8_t {
    not_run = 0,
    proven,         // farther apart than the margin, everywhere in the box
    budget_spent,   // not proven within the rounds or queries
    engine_failed,  // splitting cannot help: `status` is the engine's result
    bad_box,        // not finite, or outside the range of kinematics
};

struct JointBoxResult {
    JointBoxProof proof = JointBoxProof::not_run;
    QueryStatus status = QueryStatus::not_run;
    std::uint32_t queries = 0;  // run for this task
    JointBox open;              // the first unproven box, if any
};

struct JointBoxBudget {
    std::uint32_t rounds = 7;      // 6 splits: 64 boxes a pair
    std::uint32_t queries = 1024;  // total of all tasks
    // Every batch contains the two queries of the known-answer test in addition to the budget
    // (core/collision/known_answer.hpp). kNoIndex: no known-answer test.
    std::uint32_t known_answer_mesh = kNoIndex;
};

/// The pair's surfaces at a position inside its proven box. A proof of a stretch in pieces covers
/// only the leaves, not the rest of the boxes around them, so this checks the position against the
/// first leaf, where the stretch begins. Not proven: position outside, or task not proven.
/// @param position  [axes] mm or rad
/// @param moved     [bodies] motions there (move_bodies)
[[nodiscard]] ApartPose apart_pose_in(const Machine& machine, const JointBoxTask& task,
                                      const JointBoxResult& result,
                                      std::span<const double> position,
                                      std::span<const Pose> moved) noexcept;

/// Share of the budget that one call may use.
struct JointBoxSpend {
    std::uint32_t rounds = UINT32_MAX, queries = UINT32_MAX;
};

/// Work of one call of `prove`, total of all tasks.
struct JointBoxWork {
    std::uint32_t rounds = 0, queries = 0;     // without those of the known-answer test
    std::uint16_t known_answer_signature = 0;  // kKnownAnswerSignature: correct in every batch
};

/// A part of a task's box.
struct BoxItem {
    std::uint32_t task;
    std::uint32_t widest_axis;  // kNoIndex: cannot be cut
    std::uint32_t piece;        // index in JointBoxTask::pieces; kNoIndex: part of a box
    std::uint32_t grid;         // the piece it was cut from; kNoIndex: the task's own box
    std::uint32_t cut;          // axes along which it was cut from the grid, one bit each
    JointBox box;
};

class BoxQueries;

class JointBoxProver {
  public:
    /// Reserves memory for at most `tasks` tasks per call. Empty: not enough memory.
    [[nodiscard]] static std::optional<JointBoxProver> create(const Machine& machine,
                                                              std::uint32_t tasks,
                                                              const JointBoxBudget& budget);

    /// results[i] belongs to tasks[i]. Precondition: at most the number passed to `create`.
    /// Cost: at most budget.queries queries, run in at most budget.rounds batches, and no
    /// more than `spend` allows. With a known-answer test there is at least one batch.
    JointBoxWork prove(const Engine& engine, std::span<const JointBoxTask> tasks,
                       std::span<JointBoxResult> results, const JointBoxSpend& spend = {}) noexcept;

    [[nodiscard]] std::size_t memory_bytes() const noexcept { return arena_.size(); }

  private:
    JointBoxProver(const JointBoxBudget& budget, Arena arena) noexcept
        : budget_(budget), arena_(static_cast<Arena&&>(arena)) {}
    void run(const Engine& engine, std::uint32_t count, JointBoxWork& work) noexcept;
    std::uint32_t split(std::span<const JointBoxTask> tasks, std::span<JointBoxResult> results,
                        std::uint32_t count) noexcept;
    std::uint32_t drop_given_up(std::span<const JointBoxResult> results,
                                std::uint32_t count) noexcept;

    JointBoxBudget budget_;
    Arena arena_;
    std::span<BoxItem> items_, next_;  // [queries]
    BoxQueries* boxes_ = nullptr;      // in the arena
    std::span<Query> queries_;         // plus two for the known-answer test
    std::span<QueryResult> query_results_;
};

}  // namespace axg
