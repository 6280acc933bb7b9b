// SPDX-License-Identifier: Apache-2.0
// What was proven of pairs for the whole travel, as the cycle uses it: whether a position or a box
// is one that it holds for. Pure. Source: docs/theory/travel.md.
#pragma once

#include <cstdint>
#include <span>

#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The positions that a machine's proofs hold for: its travel, and the overrun of its rules.
[[nodiscard]] Travel travel_of(const Machine& machine);

/// Whether every position of the box is one of them, as far as it matters to the pair of `path`.
/// False where there are no proofs.
[[nodiscard]] bool is_in_travel(const Machine& machine, const JointPath& path,
                                const JointBox& box) noexcept;

/// Whether all axes are where the proofs hold; true where there are none.
[[nodiscard]] bool is_in_travel(const Machine& machine, std::span<const double> position) noexcept;

/// Whether the pair has the body with the tool in it: then it counts once for each tool.
[[nodiscard]] inline bool has_tool(const Machine& machine, const Pair& pair) noexcept {
    return machine.bodies[pair.a].is_tool || machine.bodies[pair.b].is_tool;
}
[[nodiscard]] inline std::uint32_t tasks_of(const Machine& machine, const Pair& pair) noexcept {
    return has_tool(machine, pair) ? static_cast<std::uint32_t>(machine.tools.size()) : 1;
}

/// What was proven of a pair with a tool, by its place among them all; nothing where there is none.
[[nodiscard]] inline TravelProof travel_proof(const Machine& machine,
                                              std::uint32_t place) noexcept {
    const std::vector<TravelProof>& proofs = machine.travel.proofs;
    return place < proofs.size() ? proofs[place] : TravelProof{};
}

}  // namespace axg
