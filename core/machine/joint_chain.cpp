// SPDX-License-Identifier: Apache-2.0
#include "core/machine/joint_chain.hpp"

#include <algorithm>
#include <cstddef>

namespace axg {

MachineChains chains_of(const Machine& machine) {
    MachineChains out;
    out.axes = static_cast<std::uint32_t>(machine.axes.size());
    for (const Body& body : machine.bodies) {
        PlacedChain chain;
        chain.first = static_cast<std::uint32_t>(out.joints.size());
        chain.at = body.at;
        if (body.parent != kNoIndex) {
            const PlacedChain before = out.chains[body.parent];
            for (std::uint32_t i = 0; i < before.count; ++i) {
                out.joints.push_back(ChainJoint{out.joints[before.first + i]});
            }
        }
        if (body.joint.axis != kNoIndex) {
            out.joints.push_back({body.joint.direction, body.joint.pivot_mm, body.joint.axis,
                                  machine.axes[body.joint.axis].kind == AxisKind::linear});
        }
        chain.count = static_cast<std::uint32_t>(out.joints.size()) - chain.first;
        out.chains.push_back(chain);
    }
    const auto tool_body = std::find_if(machine.bodies.begin(), machine.bodies.end(),
                                        [](const Body& body) { return body.is_tool; });
    for (const Tool& tool : machine.tools) {
        PlacedChain chain =
            tool_body == machine.bodies.end()
                ? PlacedChain{}
                : out.chains[static_cast<std::size_t>(tool_body - machine.bodies.begin())];
        chain.has_tool = true;
        chain.tool_at = tool.at;
        out.chains.push_back(chain);
    }
    return out;
}

}  // namespace axg
