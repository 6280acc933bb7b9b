// SPDX-License-Identifier: Apache-2.0
// Kernels of the translation unit of each instruction set: the same source
// (core/collision/traverse.inl), compiled for its lanes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/pair_tile.hpp"
#include "core/collision/tree.hpp"

namespace axg {

namespace sat {
// Not included: core/collision/tri_sat.hpp is read after the lanes that it is instantiated for.
template <class V>
struct TrianglePair;
}  // namespace sat

/// Two nodes still to be compared; low_mm: a certified lower bound of the distance of their
/// triangles.
struct NodePair {
    std::uint32_t a, b;
    float low_mm;
};

/// Fixed lists of one traversal, from the arena.
struct TraversalLists {
    std::span<NodePair> nodes;  // [node_pairs]
    std::span<std::uint64_t>
        keys;                      // [kNodeWidth * kNodeWidth], clearance: child pairs to be sorted
    std::uint32_t node_pairs = 0;  // capacities a query
    std::uint32_t triangle_pairs = 0;
    std::uint32_t rechecks = 0;
    GroupWork* group = nullptr;  // the group that is charged; null: none
    bool counts_all = false;     // no early exit: counts all that another engine counts
};

struct LaneKernels {
    const char* name;
    unsigned width;
    void (*run)(std::span<const Tree> trees, const TraversalLists& lists, const Query& query,
                QueryResult& result) noexcept;
    // Independent pairs: proven apart or not by the shared axes only; by every stage; and with the
    // proven distance in addition.
    void (*share_tiles)(const PairTile* tiles, std::size_t count, TileResult* results) noexcept;
    void (*test_tiles)(const PairTile* tiles, std::size_t count, TileResult* results) noexcept;
    void (*measure_tiles)(const PairTile* tiles, std::size_t count, TileResult* results) noexcept;
    // One pair in double: proven apart; certified lower bound of its distance, mm, 0 for none.
    bool (*apart_in_double)(const sat::TrianglePair<double>& pair) noexcept;
    double (*distance_in_double)(const sat::TrianglePair<double>& pair) noexcept;
};

// Null where this build has no such lanes.
[[nodiscard]] const LaneKernels* avx512_kernels() noexcept;
[[nodiscard]] const LaneKernels* avx2_kernels() noexcept;
[[nodiscard]] const LaneKernels* neon_kernels() noexcept;

}  // namespace axg
