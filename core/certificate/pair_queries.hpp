// SPDX-License-Identifier: Apache-2.0
// From one axis snapshot to the queries of one cycle: every checked pair at the sampled pose, and
// the known-answer test.
#pragma once

#include <array>
#include <cstdint>

#include "core/collision/engine.hpp"
#include "core/collision/known_answer.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// The engine is given the machine's surfaces in this order: bodies, tools, known-answer test
/// (known_answer_mesh()), those that pairs have of their own (Machine::pair_surfaces).
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

/// A surface with its never-colliding set pruned, where there is one.
[[nodiscard]] constexpr std::uint32_t pruned_mesh_index(const Machine& machine,
                                                        std::uint32_t surface,
                                                        std::uint32_t whole) noexcept {
    return surface == kNoIndex ? whole : pair_mesh_index(machine, surface);
}

/// Surface of `body` in queries about it and `against`, as passed to the engine; kNoIndex
/// for the body that carries the tool while there is none.
/// @param tool  the slot in the spindle
[[nodiscard]] std::uint32_t mesh_in_pair(const Machine& machine, std::uint32_t body,
                                         std::uint32_t against, std::uint32_t tool) noexcept;

inline constexpr std::uint32_t kQueriesMax =
    kPairsMax + 2;  // pairs, known-answer test far and near

enum class SnapshotStatus : std::uint8_t {
    not_run = 0,
    ok,
    wrong_axes,
    not_finite,
    unknown_tool,
    left_path,    // the axes are not where the board said, or it took back what it had said
    left_jog,     // another axis moved, or the one that may moved back, too fast, or is none
    left_travel,  // beyond what was proven of the travel, overrun included
    left_limits,  // an axis broke a declared limit (core/certificate/limit_evidence.hpp)
    own_stop,     // an axis stops as only a stop of the board's own explains
};

struct PairQueries {
    SnapshotStatus status = SnapshotStatus::not_run;
    std::uint32_t count = 0;        // pairs queried; the two known-answer queries follow them
    std::uint32_t tool = kNoIndex;  // slot in the spindle; kNoIndex: none
    std::array<std::uint32_t, kPairsMax> pair{};  // index into Machine::pairs
    std::array<Query, kQueriesMax> queries{};
};

/// Whether a snapshot can be queried, and the slot of the tool in the spindle. Tool number 0
/// means that the board does not report it: Machine::first_tool. Any other number without a slot:
/// unknown_tool.
[[nodiscard]] SnapshotStatus judge_snapshot(const Machine& machine, const AxisSnapshot& snapshot,
                                            std::uint32_t& tool) noexcept;

/// What queries of contact mode are about.
enum class QueryScope : std::uint8_t {
    whole = 0,  // every pair, and all of it: for distances, whatever they are
    needed,     // less what was proven of the travel: for margins and clearance levels alone
};

/// Contact mode: is each pair farther apart than its margin, only at the sampled pose?
/// A pair whose tool body is empty (no tool in the spindle) is left out. Unless the snapshot can be
/// queried, there are no queries.
void make_contact_queries(const Machine& machine, const AxisSnapshot& snapshot, PairQueries& out,
                          QueryScope scope = QueryScope::whole) noexcept;

}  // namespace axg
