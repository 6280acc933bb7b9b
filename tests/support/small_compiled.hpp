// SPDX-License-Identifier: Apache-2.0
// A small machine with all its surfaces, ready to be compiled, and ways to change what came of it.
#pragma once

#include <string>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/certificate/travel.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/round_solids.hpp"

namespace axg::test {

inline CompiledMachine small_compiled() {
    CompiledMachine out;
    out.source = {"small.yaml",
                  with(with(kSmallMachine, "travel_proofs: false", "travel_proofs: true"),
                       "slide.stl, unit: inch", "slide.stl, unit: inch, simplify_mm: 0.1"),
                  {}};
    if (!parse_machine(out.source, out.machine).empty()) {
        return {};  // what uses it finds nothing in it
    }
    MachineMeshes& meshes = out.meshes;
    const std::vector<Triangles> surfaces{
        box({0, 0, 0}, {1, 2, 3}),
        ball(3, 50),
        together(box({-1, -1, -1}, {1, 1, 1}), box({5, 5, 5}, {6, 6, 6})),
        ring(12, 6, 40, 8),
        {}};
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        meshes.bodies.push_back({out.machine.bodies[i].name, surfaces[i]});
        meshes.simple_bodies.push_back({out.machine.bodies[i].name, {}});
    }
    for (const Tool& tool : out.machine.tools) {
        meshes.tools.push_back({tool.name, box({-2, -2, 0}, {2, 2, 40})});
        meshes.simple_tools.push_back({tool.name, {}});
    }
    meshes.simple_bodies[1].triangles = ball(2, 50);
    out.machine.bodies[1].mesh.deviation_mm = 0.0625;
    // The base against the cutter alone, with the first tool, and what the travel leaves of it.
    meshes.of_pairs = {{"base", box({0, 0, 0}, {1, 1, 1})}};
    out.machine.pair_surfaces = {
        {.body = 0, .against = 4, .tool = 0, .surface = 0, .is_whole = false}};
    out.machine.travel = travel_of(out.machine);
    out.machine.travel.proofs.resize(stop_tasks(out.machine));
    out.machine.travel.proofs[0] = {
        .distance_mm = 0.5, .is_apart = false, .surface_a = kNoIndex, .surface_b = 0};
    out.machine.travel.proofs[1] = {.distance_mm = 0.5, .is_apart = true};
    meshes.notes = {"bodies.cradle.mesh: open, allowed"};
    return out;
}

/// Everything wrong with such bytes, one fault a line.
inline std::string compiled_faults(std::string_view bytes, Sums sums = Sums::checked) {
    CompiledMachine out;
    std::string words;
    for (const ConfigFault& fault : parse_compiled(bytes, "m.axg", out, sums)) {
        words += to_string(fault) + '\n';
    }
    return words;
}

}  // namespace axg::test
