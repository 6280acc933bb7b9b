// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/posed_queries.hpp"

#include "core/certificate/pair_queries.hpp"

namespace axg {
namespace {

/// A body's chain: the tool body's is that of the tool in it.
std::uint32_t chain_of(const Machine& machine, std::uint32_t body, std::uint32_t tool) noexcept {
    return machine.bodies[body].is_tool && tool != kNoIndex ? tool_mesh_index(machine, tool) : body;
}

}  // namespace

PosedPairs posed_pairs_of(const Machine& machine) {
    PosedPairs out{chains_of(machine), {}};
    for (const Pair& pair : machine.pairs) {
        for (std::uint32_t slot = 0; slot <= machine.tools.size(); ++slot) {
            const std::uint32_t tool = slot == 0 ? kNoIndex : slot - 1;
            const std::uint32_t a = mesh_in_pair(machine, pair.a, pair.b, tool),
                                b = mesh_in_pair(machine, pair.b, pair.a, tool);
            // An empty tool body has no surface, and no query.
            out.pairs.push_back(a == kNoIndex || b == kNoIndex
                                    ? PosedPair{}
                                    : PosedPair{chain_of(machine, pair.a, tool),
                                                chain_of(machine, pair.b, tool), a, b});
        }
    }
    return out;
}

std::uint32_t posed_pair(const Machine& machine, std::uint32_t pair, std::uint32_t tool) noexcept {
    const auto slots = static_cast<std::uint32_t>(machine.tools.size()) + 1;
    return pair * slots + (tool == kNoIndex ? 0 : tool + 1);
}

}  // namespace axg
