// SPDX-License-Identifier: Apache-2.0
// The always-stoppable certificate of one sample: for any start of braking until the permit for it
// has run out and the board has reacted, every checked pair keeps its margin to standstill. From
// the snapshots and the look-ahead path to joint boxes, to the prover's results. Pure;
// everything is reserved at create. Source: docs/theory/certificate.md, "The certificate".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/jog.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/limit_evidence.hpp"
#include "core/certificate/look_ahead_path.hpp"
#include "core/certificate/motion_history.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/certificate/permit_ladder.hpp"
#include "core/certificate/staged_proof.hpp"
#include "core/certificate/stop_limits.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// A pair with one tool, its box still to be said.
/// @param extents  [surfaces] the engine's, in its order; they must outlive the task
[[nodiscard]] JointBoxTask pair_task(const Machine& machine, std::uint32_t pair, std::uint32_t tool,
                                     std::span<const BodyExtent> extents) noexcept;

/// Pairs that one cycle may have to prove: a pair with a tool in it counts once for each tool.
[[nodiscard]] std::uint32_t stop_tasks(const Machine& machine) noexcept;

struct StopOptions {
    CyclePlan plan;                        // cycle_plan. Of no effect on what a proven box means
    std::array<double, kAxesMax> count{};  // mm or rad of one count on the wire
};

/// One pair, with one tool where a tool is in it, over the reachable box.
struct PairProof {
    std::uint32_t pair = kNoIndex;  // Machine::pairs
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: none in this pair
    JointBoxResult surfaces;
    ContainmentResult containment_result;
};

/// What a cycle proved, for whoever decides.
struct StopCycle {
    SnapshotStatus status = SnapshotStatus::not_run;
    std::uint16_t known_answer_signature = 0;
    // Enough snapshots were seen to know speeds and accelerations as well as they can be known; or
    // the path is known as far as a stop may need it.
    bool is_settled = false;
    std::uint8_t samples = 0;  // n: all of it is proven of a permit that is valid for so many
    // The longer permit that was tried is, with the bounds of ask_raise where that was called.
    bool is_longer_proven = false;
    bool is_jog = false;      // proven of the jog that the board reports, and of nothing else
    bool begins_jog = false;  // what each pair keeps in it was found, and nothing is proven yet
    bool is_moving = false;   // the board says that its axes move
    std::span<const PairProof> proofs{};
    LimitFact limit{};  // for left_limits and own_stop
};

class StopCertificate {
  public:
    /// @param surfaces  the engine's, in its order (core/certificate/pair_queries.hpp)
    /// `machine` must outlive the certificate. Empty: memory ran out.
    [[nodiscard]] static std::optional<StopCertificate> create(
        const Machine& machine, std::span<const Mesh* const> surfaces, const StopOptions& options);

    /// The newest coherent snapshot.
    /// @param is_first  nothing before it counts: the receiver began anew
    void note(const AxisSnapshot& snapshot, bool is_first) noexcept;

    /// Commands that the board announces: until a stop begins, or through the stop too.
    void note_path(const PathPoints& points) noexcept;

    /// From the newest snapshot to standstill no axis is faster than this, by an enforced cap: in
    /// the next `prove`s, until it is called again. Not for a jog, and not for a look-ahead path,
    /// which have bounds of their own.
    /// @param speeds  [axes] mm/s or rad/s, 0 or more; beyond the largest it bounds nothing
    void bound_speeds(std::span<const double> speeds) noexcept;

    /// The longer permit of the next `prove` is tried with these bounds, which are no lower:
    /// whether a cap may be raised. Machines with GuardRules::cap alone.
    void ask_raise(std::span<const double> speeds) noexcept;

    /// Bounds where the axes can get, and runs the queries. The same for the same snapshots, until
    /// `keep`. Cost: at most the plan, and a containment test for each pair whose position has left
    /// the box that was proven last. Where a jog begins nothing is proven: two calls and the
    /// known-answer test take the plan's place (jog_lists).
    void prove(const Engine& engine, const ContainmentTest& containment_test) noexcept;

    /// What was proven becomes what the next position is looked for in.
    void keep() noexcept;

    /// Where the axes can get, from the newest snapshot to standstill, each by itself, if the
    /// permit is valid for so many samples.
    [[nodiscard]] JointBox reach(std::uint32_t samples) const noexcept;

    // Of the last `prove`:
    [[nodiscard]] StopCycle cycle() const noexcept {
        return {.status = status_,
                .known_answer_signature = work_.known_answer_signature,
                .is_settled = !begins_jog_ && (is_path_known_ || jog_.is_on() || knows_speeds()),
                .samples = samples_,
                .is_longer_proven = is_longer_proven_,
                .is_jog = jog_.is_on(),
                .begins_jog = begins_jog_,
                .is_moving = snapshot_.mode == kModeMoving,
                .proofs = proofs_.first(begins_jog_ ? 0 : proof_count_),
                .limit = status_ == SnapshotStatus::own_stop ? own_stop_ : broken_limit_};
    }
    [[nodiscard]] const StagedWork& work() const noexcept { return work_; }
    [[nodiscard]] const CyclePlan& plan() const noexcept { return options_.plan; }
    [[nodiscard]] std::uint32_t containment_tests() const noexcept { return containment_tests_; }
    /// What was queried, for whoever queries more about the same pairs.
    [[nodiscard]] std::span<const JointBoxTask> tasks() const noexcept {
        return tasks_.first(proof_count_);
    }

    [[nodiscard]] const AxisSnapshot& snapshot() const noexcept { return snapshot_; }
    /// Everything `axis` may be doing at the newest snapshot; its whole range of speed in a stop of
    /// the board's own and until 16 strides of rest are over. Precondition: one was noted.
    [[nodiscard]] AxisRange now(std::uint32_t axis) const noexcept;
    /// The same where the look-ahead path ends; without one, now.
    [[nodiscard]] AxisRange announced(std::uint32_t axis) const noexcept {
        const auto end = path_ ? path_->end(axis) : std::nullopt;
        return end ? *end : now(axis);
    }
    /// What it is promised to keep to, and no faster than `bound_speeds` has it.
    [[nodiscard]] AxisLimits bounded_limits(std::uint32_t axis) const noexcept;
    /// How far `axis` may be from where the newest snapshot has it as long as nothing commands it
    /// to move, mm or rad: the snapshot may have been off its command, and it may be off later.
    [[nodiscard]] double held_error(std::uint32_t axis) const noexcept {
        return errors_of(axis).position + machine_->axes[axis].following_error;
    }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes() + (path_ ? path_->memory_bytes() : 0);
    }

  private:
    /// A pair with one tool: what stays the same from cycle to cycle, and what was proven last.
    struct Slot {
        JointBoxTask task;
        std::uint32_t pair, tool;
        double floor_mm;       // what it keeps in the jog that is on
        double floor_kept_mm;  // and kept in the last one that was proven; kNoJogFloor: none
        JointBox floor_box;    // where
        bool has_box;
        JointBox box;
        bool by_path;  // and it is around a path, proven up to this sample
        std::uint64_t proven_until;
    };

    StopCertificate(const Machine& machine, const StopOptions& options, StagedProver prover,
                    std::optional<LookAheadPath> path, Arena arena) noexcept;
    [[nodiscard]] bool keeps_path() const noexcept {
        return machine_->guard.promise == StopPromise::path_keeping;
    }
    void add_slot(std::uint32_t pair, std::uint32_t tool) noexcept;
    [[nodiscard]] bool is_queried(const Slot& slot) const noexcept;
    [[nodiscard]] SampleErrors errors_of(std::uint32_t axis) const noexcept {
        return sample_errors(*machine_, axis, options_.count[axis]);
    }
    void watch_limits(bool is_first) noexcept;
    void note_jog(bool is_first) noexcept;
    void note_tool(const AxisSnapshot& before, bool is_first) noexcept;
    [[nodiscard]] JointBox jog_box(std::uint32_t samples) const noexcept;
    [[nodiscard]] bool knows_speeds() const noexcept {
        return !keeps_path() && !has_left_path_ && history_.count == kSamplesKept;
    }
    [[nodiscard]] bool keep_floors(const Engine& engine) noexcept;
    void find_floors(const Engine& engine) noexcept;
    void find_lower_floors(const Engine& engine, std::span<const Pose> moved,
                           const JointBox& errors, std::uint32_t open) noexcept;
    void pose_rungs(std::uint32_t place, std::span<const Pose> moved, const JointBox& errors,
                    std::uint32_t first, std::span<Query> out) const noexcept;
    void ask_rungs(const Engine& engine, std::uint32_t pairs, std::uint32_t rungs,
                   const WorkLists& lists) noexcept;
    void take_floor(std::uint32_t place, std::span<const QueryResult> rungs) noexcept;
    [[nodiscard]] double floor_before(const Slot& slot) const noexcept;
    [[nodiscard]] bool is_in(const JointBox& box, const JointPath& path) const noexcept;
    void list_tasks() noexcept;
    [[nodiscard]] JointBox reach_within(std::uint32_t samples,
                                        const std::array<double, kAxesMax>& bounds) const noexcept;
    [[nodiscard]] bool bound_box(std::uint32_t samples,
                                 const std::array<double, kAxesMax>& bounds) noexcept;
    [[nodiscard]] bool keeps_cap() const noexcept {
        return machine_->guard.cap != CapPromise::none;
    }
    [[nodiscard]] bool bound_path(double free_s) noexcept;
    void take_wider() noexcept;
    [[nodiscard]] bool is_inside_proven(const Slot& slot) const noexcept;
    void test_containment(const ContainmentTest& containment_test) noexcept;

    const Machine* machine_;
    StopOptions options_;
    std::uint32_t stride_ = 1;
    StagedProver prover_;
    std::optional<LookAheadPath> path_;  // where the board sends one
    Arena arena_;
    std::span<BodyExtent> extents_;      // [surfaces]
    std::span<Slot> slots_;              // [pairs with each tool]
    std::span<std::uint32_t> queried_;   // slots of the tasks
    std::span<JointBoxTask> tasks_;      // and as many of the longer permit
    std::span<JointBoxResult> results_;  // likewise
    std::span<PairProof> proofs_;
    std::span<std::uint32_t> untested_;  // proofs that want a containment test
    std::span<std::uint32_t> below_;     // where a jog begins, proofs with less than the margin
    std::span<Query> rung_queries_;
    std::span<QueryResult> rung_results_;
    std::span<GroupWork> rung_groups_;  // a pair is one
    std::span<JointBox> pieces_;        // room for those of the path
    std::uint32_t slot_count_ = 0, proof_count_ = 0;

    AxisSnapshot snapshot_;
    std::array<double, kAxesMax> speed_bound_{}, raised_bound_{};
    bool asks_raise_ = false;        // until `keep`
    bool is_longer_proven_ = false;  // by the last `prove`
    MotionHistory history_;
    LimitRules limit_rules_;
    LimitWatch limit_watch_;
    LimitFact broken_limit_;       // until a cycle was judged by it and the window shows none
    LimitFact own_stop_;           // likewise, of a stop of the board's own
    bool is_limit_judged_ = true;  // of several snapshots noted, the newest alone is judged
    SnapshotStatus status_ = SnapshotStatus::not_run;
    bool is_path_known_ = false;  // as far as a stop may need it
    bool has_left_path_ = false;  // the newest snapshot says so, or a path frame before it
    bool took_back_ = false;      // a path frame since the newest snapshot
    JogWatch jog_;
    bool has_left_jog_ = false;
    bool has_floors_ = false;                     // of the jog that is on
    bool begins_jog_ = false;                     // they were found by the last `prove`
    std::uint64_t floors_at_ = 0;                 // the sample that they were found at
    std::uint64_t path_until_ = 0;                // sample up to which the path is queried
    JointBox box_;                                // that is queried
    std::span<const JointBox> queried_pieces_{};  // and in which pieces, where the path is known
    PermitLadder ladder_, ladder_next_;           // what this cycle tries, and the next
    std::uint8_t samples_;                        // n that was proven
    bool has_wider_ = false;                      // it was tried
    JointBox wider_box_;                          // with it
    std::uint32_t tool_ = kNoIndex;
    std::array<std::uint64_t, kToolsMax> tool_until_{};  // the first sample at which each of those
                                                         // before it counts no more
    StagedWork work_;
    std::uint32_t containment_tests_ = 0;
};

}  // namespace axg
