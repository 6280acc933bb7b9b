// SPDX-License-Identifier: Apache-2.0
// The jog that the board reports, and each pair's floor during it: the least distance that the pair
// keeps while one axis leads away from an obstacle.
// Claim: no floor is 0 or less where the surfaces touch, and a second jog has no lower floor than
// the first. Proof: docs/theory/certificate.md, "Jogging out". Tests: unit and oracle jog_test.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/pair_tasks.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/jog.hpp"
#include "core/reach/sampled_motion.hpp"

namespace axg {

class JogFloors {
  public:
    [[nodiscard]] static std::size_t size_bytes(const Machine& machine,
                                                const CyclePlan& plan) noexcept;
    /// Takes its memory from `arena`. `machine` must outlive it.
    JogFloors(const Machine& machine, const CyclePlan& plan, Arena& arena) noexcept;

    void note(const SampledMotion& motion, bool is_first) noexcept;
    [[nodiscard]] bool is_on() const noexcept { return watch_.is_on(); }
    [[nodiscard]] const JogMove& move() const noexcept { return watch_.move(); }
    /// The axes do not follow the jog.
    [[nodiscard]] bool has_left() const noexcept { return has_left_; }

    void begin_cycle() noexcept { begins_ = false; }
    /// Replaces the margins of the tasks by the floors. False: there are none, or this call has
    /// just determined them: that needs as much time as a proof, and a cycle has time for only one.
    [[nodiscard]] bool apply(const Engine& engine, const SampledMotion& motion,
                             PairTasks& tasks) noexcept;
    /// This cycle determined the floors, and proves nothing.
    [[nodiscard]] bool begins() const noexcept { return begins_; }
    /// The pair at this slot is proven in the box, for its floor if a jog is on.
    void keep(std::uint32_t slot, const JointBox& box) noexcept;

  private:
    struct Floor {
        double mm;       // in the present jog
        double kept_mm;  // in the last proven jog; kNoJogFloor: none
        JointBox box;    // of that proof
    };
    /// The axes at the newest sample.
    struct Placed {
        std::span<const Pose> moved;
        JointBox errors;
    };

    void find(const Engine& engine, const SampledMotion& motion, const PairTasks& tasks) noexcept;
    void find_lower(const Engine& engine, const Placed& placed, const PairTasks& tasks,
                    std::uint32_t open) noexcept;
    void pose_rungs(const PairTasks& tasks, std::uint32_t task, const Placed& placed,
                    std::uint32_t first, std::span<Query> out) const noexcept;
    void ask_rungs(const Engine& engine, std::uint32_t pairs, std::uint32_t rungs,
                   const WorkLists& lists) noexcept;
    void take_floor(const PairTasks& tasks, std::uint32_t task, const JointBox& placed,
                    std::span<const QueryResult> rungs) noexcept;
    [[nodiscard]] double floor_before(const PairTasks& tasks, std::uint32_t task,
                                      const JointBox& placed) const noexcept;

    const Machine* machine_;
    CyclePlan plan_;
    JogWatch watch_;
    bool has_left_ = false;
    bool has_floors_ = false;         // for the present jog
    bool begins_ = false;             // the last `apply` determined them
    std::uint64_t found_at_ = 0;      // sample at which it did
    std::span<Floor> floors_;         // [slots]
    std::span<std::uint32_t> below_;  // at the start of a jog, tasks nearer than their margin
    std::span<Query> queries_;
    std::span<QueryResult> results_;
    std::span<GroupWork> groups_;  // one for each pair
};

}  // namespace axg
