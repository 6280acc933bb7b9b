// SPDX-License-Identifier: Apache-2.0
// The worst-case batch: trees and queries that use every list of a batch up to its last
// place, with entries that cause the most work in every kernel. The trees are constructed: boxes
// may be larger than their contents, and nodes share children, so that every count is chosen and
// none is left to chance. No CUDA here: the CPU's traversal counts the same.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/tree.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Work of one batch, as its kernels count it.
struct BatchWork {
    std::array<std::uint32_t, kTreeDepthMax + 1> level_pairs{};  // pairs of nodes opened
    std::uint32_t leaf_pairs = 0, box_rows = 0, triangle_pairs = 0, rechecks = 0;

    friend constexpr bool operator==(const BatchWork&, const BatchWork&) = default;
};

/// How the work is distributed. even: pairs of triangles dealt out to all pairs of leaves, rows of
/// boxes to the opening of nodes. heaped: pairs of triangles in whole leaves, rows in the clipping.
/// overflowing: all triangles near all others, every list too short.
enum class WorstCaseLayout : std::uint8_t { even, heaped, overflowing };
inline constexpr std::array kWorstCaseLayouts = {WorstCaseLayout::even, WorstCaseLayout::heaped,
                                                 WorstCaseLayout::overflowing};
[[nodiscard]] const char* name_of(WorstCaseLayout layout) noexcept;

struct WorstCaseBatch {
    TreeBodies bodies;           // two a kind of query
    std::vector<Query> queries;  // all of one batch; the caller adds lists
    BatchWork work;              // work of the queries; all 0 for overflowing
};

inline constexpr double kWorstCaseMarginMm = 1.0;

/// Makes a batch of `queries` queries that open `tree_levels` levels of pairs. Returns an empty
/// string, or a message that names the capacities that cannot be filled together.
[[nodiscard]] std::string make_worst_case_batch(const Capacities& capacities, std::uint32_t queries,
                                                std::uint32_t tree_levels, WorstCaseLayout layout,
                                                WorstCaseBatch& out);

}  // namespace axg
