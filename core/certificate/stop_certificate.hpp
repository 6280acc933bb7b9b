// SPDX-License-Identifier: Apache-2.0
// The stop certificate of one sample, as a pipe: sampled motion, reach, tasks, prover, containment,
// result. Pure; reserves all memory at create.
// Claim: for any start of braking until the permit has ended and the board has reacted, every
// checked pair stays beyond its margin to standstill. Proof: docs/theory/certificate.md, "The
// certificate". Tests: stop_certificate_test, closed_loop_test.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/jog_floors.hpp"
#include "core/certificate/pair_tasks.hpp"
#include "core/certificate/permit_search.hpp"
#include "core/certificate/proven_boxes.hpp"
#include "core/certificate/staged_proof.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"
#include "core/reach/independent_reach.hpp"
#include "core/reach/path_reach.hpp"
#include "core/reach/reach.hpp"
#include "core/reach/sampled_motion.hpp"

namespace axg {

struct StopOptions {
    CyclePlan plan;                        // cycle_plan. Has no effect on the meaning of a proof
    std::array<double, kAxesMax> count{};  // mm or rad of one count on the wire
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
    /// Every position until standstill, for a permit of `cycle().samples`.
    [[nodiscard]] const JointBox& proven_reach() const noexcept { return proven_reach_; }
    [[nodiscard]] StopCycle cycle() const noexcept {
        return {.status = status_,
                .known_answer_signature = work_.known_answer_signature,
                .is_settled =
                    !jog_.begins() && (reach_.is_known_path() || jog_.is_on() || knows_speeds()),
                .samples = permits_.samples(),
                .is_longer_proven = permits_.is_longer_proven(),
                .is_jog = jog_.is_on(),
                .begins_jog = jog_.begins(),
                .is_moving = snapshot().mode == kModeMoving,
                .proofs = tasks_.proofs().first(jog_.begins() ? 0 : tasks_.count()),
                .limit = motion_.fact(status_)};
    }
    [[nodiscard]] const StagedWork& work() const noexcept { return work_; }
    [[nodiscard]] const CyclePlan& plan() const noexcept { return options_.plan; }
    [[nodiscard]] std::uint32_t containment_tests() const noexcept { return boxes_.tests(); }
    /// The tasks of the last `prove`, for more queries about the same pairs.
    [[nodiscard]] std::span<const JointBoxTask> tasks() const noexcept {
        return tasks_.tasks().first(tasks_.count());
    }

    [[nodiscard]] const AxisSnapshot& snapshot() const noexcept { return motion_.snapshot(); }
    /// See SampledMotion::now.
    [[nodiscard]] AxisRange now(std::uint32_t axis) const noexcept { return motion_.now(axis); }
    /// The same at the end of the look-ahead path; without a path, `now`.
    [[nodiscard]] AxisRange announced(std::uint32_t axis) const noexcept {
        const auto end = path_ ? path_->path().end(axis) : std::nullopt;
        return end ? *end : now(axis);
    }
    /// The promised limits, with the speed lowered to that of `bound_speeds`.
    [[nodiscard]] AxisLimits bounded_limits(std::uint32_t axis) const noexcept;
    /// See SampledMotion::held_error.
    [[nodiscard]] double held_error(std::uint32_t axis) const noexcept {
        return motion_.held_error(axis);
    }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes() + (path_ ? path_->memory_bytes() : 0);
    }

  private:
    /// Speeds of an enforced cap, and for one cycle those of a cap that may be raised.
    struct SpeedBounds {
        std::array<double, kAxesMax> now{}, raised{};
        bool asks_raise = false;  // until `keep`
    };

    StopCertificate(const Machine& machine, std::span<const Mesh* const> surfaces,
                    const StopOptions& options, StagedProver prover, std::optional<PathReach> path,
                    Arena arena) noexcept;
    [[nodiscard]] bool keeps_path() const noexcept {
        return machine_->guard.promise == StopPromise::path_keeping;
    }
    [[nodiscard]] bool keeps_cap() const noexcept {
        return machine_->guard.cap != CapPromise::none;
    }
    [[nodiscard]] bool knows_speeds() const noexcept {
        return !keeps_path() && !(path_ && path_->has_left()) && motion_.is_settled();
    }
    [[nodiscard]] SnapshotStatus judge_status() noexcept;
    [[nodiscard]] Reach reach_for(std::uint32_t samples,
                                  const std::array<double, kAxesMax>& speeds) noexcept;
    void prove_tasks(const Engine& engine, bool is_known, const Reach& wider) noexcept;
    void take_wider(const JointBox& box) noexcept;

    const Machine* machine_;
    StopOptions options_;
    StagedProver prover_;
    Arena arena_;  // of tasks, jog and boxes
    SampledMotion motion_;
    std::optional<PathReach> path_;  // empty: the board announces none
    SpindleTools tools_;
    PairTasks tasks_;
    JogFloors jog_;
    ProvenBoxes boxes_;
    PermitSearch permits_;
    SpeedBounds bounds_;
    SnapshotStatus status_ = SnapshotStatus::not_run;
    Reach reach_;  // of the last `prove`
    JointBox proven_reach_;
    StagedWork work_;
};

}  // namespace axg
