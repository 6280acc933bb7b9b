// SPDX-License-Identifier: Apache-2.0
// Deals a group's share out to its queries, and constructs bodies whose query causes that work.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/collision/tree.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/worst_case/longest_cycle.hpp"
#include "core/worst_case/tree_maker.hpp"

namespace axg {

/// A leaf of a that is near `times` leaves of b, all alike.
struct LeafRow {
    LeafRecipe recipe;
    std::uint32_t times = 1;

    friend auto operator<=>(const LeafRow&, const LeafRow&) = default;
};

/// One query: `node_pairs` pairs of nodes, each below the one before it; leaves and rows are dealt
/// out to all of them and to the roots.
struct QueryDeal {
    std::uint32_t node_pairs = 0;
    std::uint32_t rows = 0;  // of boxes, where nodes are opened
    std::vector<LeafRow> leaves;

    friend auto operator<=>(const QueryDeal&, const QueryDeal&) = default;
};
[[nodiscard]] WorkLists work_of(const QueryDeal& deal) noexcept;

/// Returns an empty string, or a message if these lists cannot be filled together.
[[nodiscard]] std::string deal_group(const WorkLists& share, std::uint32_t queries,
                                     CycleLayout layout, std::vector<QueryDeal>& out);

/// Adds two bodies. Returns their size in bytes.
std::size_t make_bodies(const QueryDeal& deal, TreeBodies& out);

}  // namespace axg
