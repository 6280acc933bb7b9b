// SPDX-License-Identifier: Apache-2.0
// Builds the queries of one cycle from one axis snapshot: every checked pair at the sampled pose,
// and the known-answer test.
#pragma once

#include <array>
#include <cstdint>

#include "core/collision/engine.hpp"
#include "core/collision/known_answer.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// The engine receives the machine's surfaces in this order: bodies, tools, known-answer test
/// (known_answer_mesh()), pair-specific surfaces (Machine::pair_surfaces).
[[nodiscard]] constexpr std::uint32_t tool_mesh_index(const Machine& machine,
                                                      std::uint32_t tool) noexcept {
    return static_cast<std::uint32_t>(machine.bodies.size()) + tool;
}
[[nodiscard]] constexpr std::uint32_t known_answer_mesh_index(const Machine& machine) noexcept {
    return static_cast<std::uint32_t>(machine.bodies.size() + machine.tools.size());
}
[[nodiscard]] constexpr std::uint32_t pair_mesh_index(const Machine& machine,
                                                      std::uint32_t surface) noexcept {
    return known_answer_mesh_index(machine) + 1 + surface;
}

/// A surface with its never-colliding set pruned; `whole` if there is none.
[[nodiscard]] constexpr std::uint32_t pruned_mesh_index(const Machine& machine,
                                                        std::uint32_t surface,
                                                        std::uint32_t whole) noexcept {
    return surface == kNoIndex ? whole : pair_mesh_index(machine, surface);
}

/// Index of the surface of `body` in queries about it and `against`, in the engine's order;
/// kNoIndex for the tool body if there is no tool.
/// @param tool  the slot in the spindle
[[nodiscard]] std::uint32_t mesh_in_pair(const Machine& machine, std::uint32_t body,
                                         std::uint32_t against, std::uint32_t tool) noexcept;

inline constexpr std::uint32_t kQueriesMax =
    kPairsMax + 2;  // pairs, known-answer test far and near

struct PairQueries {
    SnapshotStatus status = SnapshotStatus::not_run;
    std::uint32_t count = 0;        // queried pairs; the two known-answer queries follow them
    std::uint32_t tool = kNoIndex;  // slot in the spindle; kNoIndex: none
    std::array<std::uint32_t, kPairsMax> pair{};  // index into Machine::pairs
    std::array<Query, kQueriesMax> queries{};
};

/// Checks whether a snapshot can be queried, and finds the slot of the tool in the spindle. Tool
/// number 0 means that the board does not report it: uses Machine::first_tool. Any other number
/// without a slot: unknown_tool.
[[nodiscard]] SnapshotStatus judge_snapshot(const Machine& machine, const AxisSnapshot& snapshot,
                                            std::uint32_t& tool) noexcept;

/// The surfaces that queries of contact mode cover.
enum class QueryScope : std::uint8_t {
    whole = 0,  // every pair with its whole surfaces: for any distance
    needed,     // without the never-colliding set: only for margins and clearance levels
};

/// Contact mode: queries whether each pair is farther apart than its margin, only at the sampled
/// pose. Skips pairs whose tool body is empty (no tool in the spindle). Makes no queries if the
/// snapshot cannot be queried.
void make_contact_queries(const Machine& machine, const AxisSnapshot& snapshot, PairQueries& out,
                          QueryScope scope = QueryScope::whole) noexcept;

}  // namespace axg
