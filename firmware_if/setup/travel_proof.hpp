// SPDX-License-Identifier: Apache-2.0
// The never-colliding set of each pair: proven once for the whole travel, overrun included, and
// pruned from what a cycle queries. Offline: allocates, and limits its effort in queries instead of
// time, so that the same machine gives the same result on every processor.
// Source: docs/theory/travel.md; the idea: operating-range pruning in the seed paper.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// One pair with one tool, in the order of stop_tasks().
struct KeptTriangles {
    std::uint32_t pair = 0, tool = kNoIndex;  // Machine::pairs, Machine::tools
    // All pruned triangles are farther away than this, for every position in travel_of(machine).
    double distance_mm = 0;
    bool is_apart = false;  // a or b is empty, and neither body is inside the other
    // Remaining triangles of the engine's surfaces for a and for b: indices, in rising order.
    std::vector<std::uint32_t> a, b;
    std::uint32_t whole_a = 0, whole_b = 0;  // triangles that there are
    std::uint64_t queries = 0;               // run for this pair

    friend bool operator==(const KeptTriangles&, const KeptTriangles&) = default;
};

/// Enough for the pairs that never meet; how much more triangles cost to find, and how little they
/// save: docs/measurements/travel.md.
struct TravelEffort {
    std::uint32_t poses = 512;    // at which touching triangles are marked, not proven
    std::uint32_t clusters = 64;  // that a surface is cut into at most
    std::uint32_t queries = 256;  // about one cluster; about a whole pair 64 times as many
};

/// Empty: this processor has no lane set, or memory ran out.
/// @param loaded  without proofs of the travel so far
/// @param on_progress  what share of the pairs is done, after each; may be empty
[[nodiscard]] std::optional<std::vector<KeptTriangles>> prove_travel(
    const LoadedMachine& loaded, const TravelEffort& effort = {},
    const std::function<void(double share)>& on_progress = {});

/// Restricts the engines of `loaded` to the remaining triangles where that saves time; its cycles
/// do not query pairs that are apart.
/// @param kept  result of prove_travel for this machine
void apply_travel(const std::vector<KeptTriangles>& kept, LoadedMachine& loaded);

}  // namespace axg
