// SPDX-License-Identifier: Apache-2.0
// The box in which each pair was proven last. While the axes stay in it, no body can be inside the
// other: its surface would have had to cross the other's. Elsewhere the pair is tested.
// Claim: a pair with Containment::none has no part of one body inside the other. Proof:
// docs/theory/certificate.md, "Containment". Tests: stop_certificate_test,
// stop_certificate_path_test.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/jog_floors.hpp"
#include "core/certificate/pair_tasks.hpp"
#include "core/collision/containment.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/reach.hpp"

namespace axg {

class ProvenBoxes {
  public:
    [[nodiscard]] static std::size_t size_bytes(const Machine& machine) noexcept;
    /// Takes its memory from `arena`. `machine` must outlive it.
    ProvenBoxes(const Machine& machine, Arena& arena) noexcept;

    void begin_cycle() noexcept { tests_ = 0; }
    /// Adds the containment result of each proven pair to its proof.
    /// @param position  the sampled positions or, with a path, those commanded for the sample. The
    ///     box proven just now contains them, so its surfaces need no query
    void judge(const ContainmentTest& containment_test, PairTasks& tasks, const Reach& reach,
               const AxisSnapshot& snapshot, const std::array<double, kAxesMax>& position) noexcept;
    /// Commits the proofs: the next cycle compares its position with these boxes.
    void keep(const PairTasks& tasks, const Reach& reach, JogFloors& floors) noexcept;
    /// Of the last `judge`.
    [[nodiscard]] std::uint32_t tests() const noexcept { return tests_; }

  private:
    struct Kept {
        bool has_box;
        JointBox box;
        bool by_path;  // the box encloses a path, proven up to sample `until`
        std::uint64_t until;
    };
    [[nodiscard]] bool holds(const Kept& kept, const JointPath& path, const Reach& reach,
                             const AxisSnapshot& snapshot) const noexcept;

    const Machine* machine_;
    std::span<Kept> kept_;               // [slots]
    std::span<std::uint32_t> untested_;  // tasks that need a containment test
    std::uint32_t tests_ = 0;
};

}  // namespace axg
