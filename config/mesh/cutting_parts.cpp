// SPDX-License-Identifier: Apache-2.0
// Why queries of a tool and stock need only the sections that do not cut. A cutting section may
// touch or enter stock, so no query of the whole tool could be proven. Only the union of the other
// sections needs the margin. Each is a solid with a closed surface: the face between shank and
// flutes, which is no surface of the whole tool, is one of the shank. So distance and containment
// queries treat the rest of the tool as a whole body (PairSurface::is_whole): flutes inside the
// stock are no contact, a shank inside is one.
#include "config/mesh/cutting_parts.hpp"

#include <algorithm>
#include <utility>

#include "core/mesh/shape.hpp"

namespace axg {
namespace {

Mesh rest_of(const Tool& tool) {
    Mesh out;
    out.name = tool.name;
    for (const Shape& section : tool.mesh.shapes) {
        if (!section.is_cutting) {
            const std::vector<Triangle> shell = triangles_of(section).triangles;
            out.triangles.insert(out.triangles.end(), shell.begin(), shell.end());
        }
    }
    return out;
}

/// The stock bodies that `machine` checks against the tool.
std::vector<std::uint32_t> stock_of(const Machine& machine) {
    std::vector<std::uint32_t> out;
    for (const Pair& pair : machine.pairs) {
        const Body &a = machine.bodies[pair.a], &b = machine.bodies[pair.b];
        if (a.is_tool && b.is_stock) {
            out.push_back(pair.b);
        } else if (b.is_tool && a.is_stock) {
            out.push_back(pair.a);
        }
    }
    return out;
}

}  // namespace

void part_cutters(Machine& machine, MachineMeshes& meshes) {
    const std::vector<std::uint32_t> stock = stock_of(machine);
    if (stock.empty()) {
        return;
    }
    const auto carrier = std::find_if(machine.bodies.begin(), machine.bodies.end(),
                                      [](const Body& body) { return body.is_tool; });
    const auto body = static_cast<std::uint32_t>(carrier - machine.bodies.begin());
    for (std::uint32_t tool = 0; tool < machine.tools.size(); ++tool) {
        const std::vector<Shape>& sections = machine.tools[tool].mesh.shapes;
        if (std::none_of(sections.begin(), sections.end(),
                         [](const Shape& section) { return section.is_cutting; })) {
            continue;
        }
        const auto surface = static_cast<std::uint32_t>(meshes.of_pairs.size());
        meshes.of_pairs.push_back(rest_of(machine.tools[tool]));
        for (const std::uint32_t against : stock) {
            machine.pair_surfaces.push_back({.body = body,
                                             .against = against,
                                             .tool = tool,
                                             .surface = surface,
                                             .is_whole = true});
        }
    }
}

}  // namespace axg
