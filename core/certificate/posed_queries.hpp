// SPDX-License-Identifier: Apache-2.0
// Queries that an engine on a GPU poses itself: which pair, at which row of axis positions. One
// source for host and device: the same bits as make_contact_queries(). mm, rad.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/machine/joint_chain.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Two bodies and their surfaces.
struct PosedPair {
    std::uint32_t chain_a = 0, chain_b = 0;  // MachineChains::chains
    std::uint32_t mesh_a = 0, mesh_b = 0;    // Query::mesh_a, Query::mesh_b
};

/// A query of kind `farther` about a pair at a row of positions.
struct PosedQuery {
    std::uint32_t pair = 0, row = 0;
    double r_mm = 0, pose_error_mm = 0;
    bool is_float_only = false;
};

struct PosedQueries {
    std::span<const PosedQuery> queries{};  // their rows never fall
    std::span<const double> positions{};    // [rows][axes], mm or rad
};

/// The query that the device makes of it. False: an index is out of range, or the row may not be
/// posed; the engine refuses such a query (bad_query).
AXG_HD bool fill_posed(const ChainJoint* joints, const PlacedChain* chains, const PosedPair& pair,
                       const double* position, Query& query) noexcept {
    Pose a, b;
    if (!place_chain(joints, chains[pair.chain_a], position, a) ||
        !place_chain(joints, chains[pair.chain_b], position, b)) {
        return false;
    }
    query.mesh_a = pair.mesh_a;
    query.mesh_b = pair.mesh_b;
    query.pose = compose(inverse(b), a);  // relative_pose()
    return true;
}

/// Every pair without and with every tool.
struct PosedPairs {
    MachineChains chains;
    std::vector<PosedPair> pairs;  // by posed_pair()
};
[[nodiscard]] PosedPairs posed_pairs_of(const Machine& machine);

/// The place of a pair with the tool in the spindle (kNoIndex: none) in PosedPairs::pairs.
[[nodiscard]] std::uint32_t posed_pair(const Machine& machine, std::uint32_t pair,
                                       std::uint32_t tool) noexcept;

}  // namespace axg
