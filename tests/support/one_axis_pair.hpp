// SPDX-License-Identifier: Apache-2.0
// A machine of one axis that carries a body past another, which stands still: whether they stay
// apart over a travel is put to a prover with time, which checks again in double what float leaves
// undecided, and to that of a cycle with its usual plan, which does not.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/staged_proof.hpp"
#include "core/machine/cycle_plan.hpp"
#include "tests/support/engine_fixture.hpp"

namespace axg::test {

inline constexpr JointBoxBudget kPatience{.rounds = 40, .queries = 1U << 15};

class OneAxisPair {
  public:
    OneAxisPair(Mesh moves, Mesh stands, AxisKind kind, Vec3d direction, Vec3d pivot_mm = {})
        : meshes_{std::move(moves), std::move(stands)},
          extents_{extent_of(meshes_[0]), extent_of(meshes_[1])},
          engine_(engine_over(meshes_)) {
        machine_.axes.resize(1);
        machine_.axes[0].kind = kind;
        machine_.bodies.resize(2);
        machine_.bodies[0].joint = {0, direction, pivot_mm};
        task_.body_b = task_.mesh_b = 1;
        task_.extent_a = &extents_[0];
        task_.extent_b = &extents_[1];
        task_.path = path_between(machine_, 0, 1);
    }
    OneAxisPair(const OneAxisPair&) = delete;  // the task points into it
    OneAxisPair& operator=(const OneAxisPair&) = delete;

    /// Whether they are proven more than the margin apart from `low` to `high`, mm or rad. The sums
    /// are rounded: the middle and half of the difference decide.
    [[nodiscard]] bool is_apart(double low, double high, double margin_mm = 0,
                                const JointBoxBudget& budget = kPatience) {
        set(low, high, margin_mm);
        Machine machine = machine_;
        machine.cycle.lists.rechecks = Capacities{}.rechecks;
        std::optional<JointBoxProver> prover = JointBoxProver::create(machine, 1, budget);
        EXPECT_TRUE(prover.has_value());
        prover->prove(engine_->engine(), {&task_, 1}, {&result_, 1});
        return judged();
    }
    /// The same with the queries that a cycle has by default.
    [[nodiscard]] bool is_apart_in_a_cycle(double low, double high, double margin_mm = 0) {
        set(low, high, margin_mm);
        std::optional<StagedProver> prover =
            StagedProver::create(machine_, 1, cycle_plan(machine_, 1), kNoIndex);
        EXPECT_TRUE(prover.has_value());
        static_cast<void>(prover->prove(engine_->engine(), {&task_, 1}, {&result_, 1}));
        return judged();
    }
    /// Of the last call.
    [[nodiscard]] const JointBoxResult& result() const { return result_; }

  private:
    void set(double low, double high, double margin_mm) {
        task_.box.centre[0] = 0.5 * (low + high);
        task_.box.half[0] = 0.5 * (high - low);
        task_.margin_mm = margin_mm;
    }
    [[nodiscard]] bool judged() const {
        EXPECT_NE(result_.proof, JointBoxProof::not_run);
        EXPECT_NE(result_.proof, JointBoxProof::engine_failed);
        EXPECT_NE(result_.proof, JointBoxProof::bad_box);
        return result_.proof == JointBoxProof::proven;
    }

    std::vector<Mesh> meshes_;
    std::array<BodyExtent, 2> extents_;
    std::optional<CpuEngine> engine_;
    Machine machine_;
    JointBoxTask task_;
    JointBoxResult result_;
};

}  // namespace axg::test
