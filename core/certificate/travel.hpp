// SPDX-License-Identifier: Apache-2.0
// Travel proofs of pairs, as a cycle uses them: whether a proof holds for a position or a box.
// Pure. Source: docs/theory/travel.md.
#pragma once

#include <cstdint>
#include <span>

#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The positions for which a machine's proofs hold: its travel plus the overrun of its rules.
[[nodiscard]] Travel travel_of(const Machine& machine);

/// All of these; wider than what is_in_travel() lets in, by more than its sums are rounded.
[[nodiscard]] JointBox travel_box(const Machine& machine);

/// Whether the travel contains the box, on the axes of `path`. False without proofs.
[[nodiscard]] bool is_in_travel(const Machine& machine, const JointPath& path,
                                const JointBox& box) noexcept;

/// Whether the proofs hold for the positions of all axes; true without proofs.
[[nodiscard]] bool is_in_travel(const Machine& machine, std::span<const double> position) noexcept;

/// Whether the pair contains the tool body: then it counts once for each tool.
[[nodiscard]] inline bool has_tool(const Machine& machine, const Pair& pair) noexcept {
    return machine.bodies[pair.a].is_tool || machine.bodies[pair.b].is_tool;
}
[[nodiscard]] inline std::uint32_t tasks_of(const Machine& machine, const Pair& pair) noexcept {
    return has_tool(machine, pair) ? static_cast<std::uint32_t>(machine.tools.size()) : 1;
}

/// The travel proof at this place in the list of pairs with each tool; a default one if missing.
[[nodiscard]] inline TravelProof travel_proof(const Machine& machine,
                                              std::uint32_t place) noexcept {
    const std::vector<TravelProof>& proofs = machine.travel.proofs;
    return place < proofs.size() ? proofs[place] : TravelProof{};
}

}  // namespace axg
