// SPDX-License-Identifier: Apache-2.0
// Proves that pairs of bodies keep their margin everywhere in a joint box: every
// instant in it, with no tunnelling between samples. A box that is not proven in one query is
// split along the axis that moves most, breadth first, within a fixed number of rounds and
// queries. Budget spent = not proven. Source: docs/theory/certificate.md, "The prover".
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

/// What is left of a pair's surfaces once the never-colliding set is pruned, for queries about
/// boxes within the travel (core/certificate/travel.hpp).
struct PrunedSurfaces {
    double up_to_mm = -1;   // for margins up to this; negative: nothing was pruned
    bool is_apart = false;  // nothing is left: such a box is proven as it is
    std::uint32_t mesh_a = 0, mesh_b = 0;
};

/// One pair over one box, or over a stretch of a path that the box lies around.
struct JointBoxTask {
    std::uint32_t body_a = 0, body_b = 0;  // Machine::bodies
    std::uint32_t mesh_a = 0, mesh_b = 0;  // as the engine was given them
    const BodyExtent* extent_a = nullptr;
    const BodyExtent* extent_b = nullptr;
    Pose at_a, at_b;  // mesh frames to the bodies' frames at the zero pose (Body::at, Tool::at)
    JointPath path;
    double margin_mm = 0;
    // Of every query: arithmetic, and what simplified surfaces cost.
    double pose_error_mm = kPlacementErrorMm;
    PrunedSurfaces pruned;
    JointBox box;
    // The stretch in pieces: the first lies around all of it, and the children of piece i are
    // 2 i + 1 and 2 i + 2. These are queried before a box is split. Empty: the box alone.
    std::span<const JointBox> pieces{};
};

/// A pair's two bodies, placed.
struct PlacedPair {
    PlacedBody a, b;
};
/// @param moved  [bodies] motions at some position of the axes (move_bodies)
[[nodiscard]] PlacedPair placed_pair(const JointBoxTask& task,
                                     std::span<const Pose> moved) noexcept;

/// Whether the pair is more than `r_mm` apart there.
[[nodiscard]] Query query_of(const JointBoxTask& task, const PlacedPair& pair,
                             double r_mm) noexcept;

/// Half of the box: lower or upper. Together the two cover it, roundings included, and they are
/// equally wide, as all boxes are that were cut from the grid along the same axes.
/// @param grid  the whole box that this one was cut from, or is
[[nodiscard]] JointBox half_of(const JointBox& box, std::uint32_t axis, bool is_upper,
                               const JointBox& grid) noexcept;
/// The same in its place.
void halve(JointBox& box, std::uint32_t axis, bool is_upper, const JointBox& grid) noexcept;

/// Whether what was pruned keeps the margin everywhere in the box: queries about it are then of
/// what is left.
[[nodiscard]] bool is_pruned_for(const Machine& machine, const JointBoxTask& task,
                                 const JointBox& box) noexcept;

/// Whether a smaller box may be proven where this one was not: it needs less distance, and less
/// work.
[[nodiscard]] bool may_help_to_split(QueryStatus status, double r_mm) noexcept;

enum class JointBoxProof : std::uint8_t {
    not_run = 0,
    proven,         // farther apart than the margin, everywhere in the box
    budget_spent,   // not proven within the rounds or queries
    engine_failed,  // a result other than ok: `status` says which
    bad_box,        // not finite, or outside of what kinematics takes
};

struct JointBoxResult {
    JointBoxProof proof = JointBoxProof::not_run;
    QueryStatus status = QueryStatus::not_run;
    std::uint32_t queries = 0;  // run for this task
    JointBox open;              // the first box that was left unproven, where there is one
};

struct JointBoxBudget {
    std::uint32_t rounds = 7;      // 6 splits: 64 boxes a pair
    std::uint32_t queries = 1024;  // of all tasks together
    // The known-far and known-near queries ride in every batch (core/collision/known_answer.hpp),
    // on top of the queries; kNoIndex: no known-answer test.
    std::uint32_t known_answer_mesh = kNoIndex;
};

/// The pair's surfaces at a position that its proof holds for. Of a stretch in pieces the leaves
/// are proven and nothing else of the boxes around them, so the position is looked for in the
/// first leaf, where the stretch begins. Not proven: it lies outside, or the task is not proven.
/// @param position  [axes] mm or rad
/// @param moved     [bodies] motions there (move_bodies)
[[nodiscard]] ApartPose apart_pose_in(const Machine& machine, const JointBoxTask& task,
                                      const JointBoxResult& result,
                                      std::span<const double> position,
                                      std::span<const Pose> moved) noexcept;

/// What one call may spend of the budget.
struct JointBoxSpend {
    std::uint32_t rounds = UINT32_MAX, queries = UINT32_MAX;
};

/// What a call of `prove` came to, all tasks together.
struct JointBoxWork {
    std::uint32_t rounds = 0, queries = 0;     // the known-answer test's do not count
    std::uint16_t known_answer_signature = 0;  // kKnownAnswerSignature: right in every batch
};

/// A part of a task's box.
struct BoxItem {
    std::uint32_t task;
    std::uint32_t widest_axis;  // kNoIndex: it cannot be cut
    std::uint32_t piece;        // of the task's; kNoIndex: part of one
    std::uint32_t grid;         // the piece that it is a part of; kNoIndex: of the task's own box
    std::uint32_t cut;          // along which axes it was cut from it, one bit each
    JointBox box;
};

class BoxQueries;

class JointBoxProver {
  public:
    /// Reserves everything for at most `tasks` tasks at a time. Empty: not that much memory.
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
    std::span<Query> queries_;         // and two of the known-answer test
    std::span<QueryResult> query_results_;
};

}  // namespace axg
