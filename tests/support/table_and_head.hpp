// SPDX-License-Identifier: Apache-2.0
// A small machine for tests of certificates: few bodies, and levers that are known by heart.
#pragma once

#include <cstdint>
#include <vector>

#include "core/certificate/stop_certificate.hpp"
#include "core/machine/cycle_plan.hpp"
#include "core/machine/machine.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {

enum : std::uint32_t { kTable, kHead, kCutter, kBodies };

/// A table on X, a head on Z, a cutter in the head; the two tools of motion_test_machine. Margins
/// 0.5 mm and 2 mm; positions are off by 1 um and 1e-5 rad.
inline Machine table_and_head_machine() {
    Machine m = motion_test_machine();
    m.bodies.assign(kBodies, Body{});
    m.bodies[kTable].joint = {0, {1, 0, 0}, {}};
    m.bodies[kHead].joint = {2, {0, 0, 1}, {}};
    m.bodies[kCutter].parent = kHead;
    m.bodies[kCutter].is_tool = true;
    m.pairs = {{kCutter, kTable, 0.5}, {kHead, kTable, 2}};
    m.guard.free_jerk_limited = true;
    for (Axis& axis : m.axes) {
        axis.position_error = axis.kind == AxisKind::linear ? 0.001 : 1e-5;
    }
    return m;
}

/// What that machine is made of where it has one tool: the mill ends 60 mm above the table.
inline ContainmentScene table_and_head_scene() {
    return ContainmentScene{{{"table", box({-50, -50, -10}, {50, 50, 0})},
                             {"head", box({-20, -20, 120}, {20, 20, 200})},
                             {"", {}},
                             {"mill", box({-2, -2, 60}, {2, 2, 120})},
                             known_answer_mesh()}};
}

/// A certificate over all of a scene but its last mesh, the known-answer test.
inline StopCertificate certificate_over(const ContainmentScene& scene, const Machine& machine,
                                        StopOptions options = {}) {
    options.plan = cycle_plan(machine, stop_tasks(machine));
    std::vector<const Mesh*> surfaces;
    for (std::size_t i = 0; i + 1 < scene.meshes().size(); ++i) {
        surfaces.push_back(&scene.meshes()[i]);
    }
    return *StopCertificate::create(machine, surfaces, options);
}

}  // namespace axg::test
