// SPDX-License-Identifier: Apache-2.0
// The stop certificate of one sample: for any start of braking until the permit has ended and the
// board has reacted, every checked pair stays beyond its margin to standstill. Turns snapshots and
// the look-ahead path into joint boxes, and runs the prover. Pure; reserves all memory at create.
// Source: docs/theory/certificate.md, "The certificate".
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

/// The task of a pair with one tool; the caller sets its box.
/// @param extents  [surfaces] in the engine's order; they must outlive the task
[[nodiscard]] JointBoxTask pair_task(const Machine& machine, std::uint32_t pair, std::uint32_t tool,
                                     std::span<const BodyExtent> extents) noexcept;

/// Number of pairs that one cycle may have to prove: a pair with a tool counts once for each tool.
[[nodiscard]] std::uint32_t stop_tasks(const Machine& machine) noexcept;

struct StopOptions {
    CyclePlan plan;                        // cycle_plan. Has no effect on the meaning of a proof
    std::array<double, kAxesMax> count{};  // mm or rad of one count on the wire
};

/// One pair, with one tool if a tool is part of it, over the reachable box.
struct PairProof {
    std::uint32_t pair = kNoIndex;  // Machine::pairs
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: none in this pair
    JointBoxResult surfaces;
    ContainmentResult containment_result;
};

/// The proofs of a cycle, for its decision.
struct StopCycle {
    SnapshotStatus status = SnapshotStatus::not_run;
    std::uint16_t known_answer_signature = 0;
    // The history is full, so that speeds and accelerations have their tightest bounds; or the
    // look-ahead path is as long as a stop may need; or a jog is on. False if begins_jog.
    bool is_settled = false;
    std::uint8_t samples = 0;  // n: the proofs hold for a permit that is valid for n samples
    // All pairs are proven for the longer permit, too, with the bounds of ask_raise if called.
    bool is_longer_proven = false;
    bool is_jog = false;      // the proofs hold only for the jog that the board reports
    bool begins_jog = false;  // this cycle determined the jog floors and proved nothing
    bool is_moving = false;   // the board reports that its axes move
    std::span<const PairProof> proofs{};
    LimitFact limit{};  // for left_limits and own_stop
};

class StopCertificate {
  public:
    /// @param surfaces  in the engine's order (core/certificate/pair_queries.hpp)
    /// `machine` must outlive the certificate. Empty: out of memory.
    [[nodiscard]] static std::optional<StopCertificate> create(
        const Machine& machine, std::span<const Mesh* const> surfaces, const StopOptions& options);

    /// Adds the newest coherent snapshot.
    /// @param is_first  the receiver has restarted: discards earlier snapshots
    void note(const AxisSnapshot& snapshot, bool is_first) noexcept;

    /// Adds commands that the board announces: until a stop begins, or through the stop, too.
    void note_path(const PathPoints& points) noexcept;

    /// Bounds the speed of all axes from the newest snapshot to standstill, by an enforced cap.
    /// Valid for each `prove` until the next call. Does not apply to a jog or a look-ahead path,
    /// which have bounds of their own.
    /// @param speeds  [axes] mm/s or rad/s, 0 or more; no bound if above the axis' largest speed
    void bound_speeds(std::span<const double> speeds) noexcept;

    /// Makes `prove` try the longer permit with these bounds until `keep`, to find whether a cap
    /// may be raised. They are no lower than the present ones. Only with GuardRules::cap.
    void ask_raise(std::span<const double> speeds) noexcept;

    /// Bounds the reach of the axes, and runs the queries. Repeated calls with the same snapshots
    /// give the same results until `keep`. Cost: at most the plan, and a containment test for each
    /// pair whose position has left the box proven last. The start of a jog proves nothing: two
    /// calls and the known-answer test replace the plan (jog_lists).
    void prove(const Engine& engine, const ContainmentTest& containment_test) noexcept;

    /// Commits the proofs: the next cycle compares its position with these boxes.
    void keep() noexcept;

    /// Reach of each axis by itself, from the newest snapshot to standstill, for a permit that is
    /// valid for so many samples.
    [[nodiscard]] JointBox reach(std::uint32_t samples) const noexcept;

    // Results of the last `prove`:
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
    /// The tasks of the last `prove`, for more queries about the same pairs.
    [[nodiscard]] std::span<const JointBoxTask> tasks() const noexcept {
        return tasks_.first(proof_count_);
    }

    [[nodiscard]] const AxisSnapshot& snapshot() const noexcept { return snapshot_; }
    /// Range of `axis` at the newest snapshot; its whole range of speed and acceleration in a stop
    /// of the board's own, until 16 strides of rest are over. Precondition: a snapshot was noted.
    [[nodiscard]] AxisRange now(std::uint32_t axis) const noexcept;
    /// The same at the end of the look-ahead path; without a path, `now`.
    [[nodiscard]] AxisRange announced(std::uint32_t axis) const noexcept {
        const auto end = path_ ? path_->end(axis) : std::nullopt;
        return end ? *end : now(axis);
    }
    /// The promised limits, with the speed lowered to that of `bound_speeds`.
    [[nodiscard]] AxisLimits bounded_limits(std::uint32_t axis) const noexcept;
    /// Largest distance of `axis` from its position in the newest snapshot while it has no command
    /// to move, mm or rad: the snapshot may differ from the command, and so may later positions.
    [[nodiscard]] double held_error(std::uint32_t axis) const noexcept {
        return errors_of(axis).position + machine_->axes[axis].following_error;
    }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes() + (path_ ? path_->memory_bytes() : 0);
    }

  private:
    /// A pair with one tool: its constants and its last proof.
    struct Slot {
        JointBoxTask task;
        std::uint32_t pair, tool;
        double floor_mm;       // floor in the present jog
        double floor_kept_mm;  // floor in the last proven jog; kNoJogFloor: none
        JointBox floor_box;    // box of that proof
        bool has_box;
        JointBox box;
        bool by_path;  // the box encloses a path, proven up to sample proven_until
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
    std::optional<LookAheadPath> path_;  // empty: the board sends none
    Arena arena_;
    std::span<BodyExtent> extents_;      // [surfaces]
    std::span<Slot> slots_;              // [pairs with each tool]
    std::span<std::uint32_t> queried_;   // slots of the tasks
    std::span<JointBoxTask> tasks_;      // and as many for the longer permit
    std::span<JointBoxResult> results_;  // likewise
    std::span<PairProof> proofs_;
    std::span<std::uint32_t> untested_;  // proofs that need a containment test
    std::span<std::uint32_t> below_;     // at the start of a jog, pairs nearer than their margin
    std::span<Query> rung_queries_;
    std::span<QueryResult> rung_results_;
    std::span<GroupWork> rung_groups_;  // one group for each pair
    std::span<JointBox> pieces_;        // memory for the pieces of the path
    std::uint32_t slot_count_ = 0, proof_count_ = 0;

    AxisSnapshot snapshot_;
    std::array<double, kAxesMax> speed_bound_{}, raised_bound_{};
    bool asks_raise_ = false;        // until `keep`
    bool is_longer_proven_ = false;  // by the last `prove`
    MotionHistory history_;
    LimitRules limit_rules_;
    LimitWatch limit_watch_;
    LimitFact broken_limit_;       // held until a cycle has used it and the window shows none
    LimitFact own_stop_;           // likewise, for a stop of the board's own
    bool is_limit_judged_ = true;  // a cycle has used them; it judges only the newest snapshot
    SnapshotStatus status_ = SnapshotStatus::not_run;
    bool is_path_known_ = false;  // as far as a stop may need it
    bool has_left_path_ = false;  // by the newest snapshot, or by a path frame before it
    bool took_back_ = false;      // by a path frame since the newest snapshot
    JogWatch jog_;
    bool has_left_jog_ = false;
    bool has_floors_ = false;                     // for the present jog
    bool begins_jog_ = false;                     // the last `prove` determined the floors
    std::uint64_t floors_at_ = 0;                 // sample at which it did
    std::uint64_t path_until_ = 0;                // sample up to which the path is queried
    JointBox box_;                                // the queried box
    std::span<const JointBox> queried_pieces_{};  // its pieces; empty without a path
    PermitLadder ladder_, ladder_next_;           // of this cycle and of the next
    std::uint8_t samples_;                        // proven n
    bool has_wider_ = false;                      // this cycle tries the longer permit
    JointBox wider_box_;                          // box of the longer permit
    std::uint32_t tool_ = kNoIndex;
    std::array<std::uint64_t, kToolsMax> tool_until_{};  // first sample at which each earlier tool
                                                         // no longer counts
    StagedWork work_;
    std::uint32_t containment_tests_ = 0;
};

}  // namespace axg
