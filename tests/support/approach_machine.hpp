// SPDX-License-Identifier: Apache-2.0
// A machine of three linear axes with a tool like a box over a plate with a wall, small enough for
// very many approaches, and the distance of the two by a formula of its own. mm.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "core/base/limits.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {

using Positions = std::array<double, kAxesMax>;

enum : std::uint32_t { kSaddleBody, kTableBody, kHeadBody, kToolBody, kApproachBodies };

struct SolidBox {
    std::array<double, 3> low{}, high{};
};
// At the zero pose: corners are whole numbers, which meshes hold exactly.
inline constexpr SolidBox kPlate{{-60, -60, -10}, {60, 60, 0}};
inline constexpr SolidBox kWall{{20, -60, 0}, {60, 60, 40}};
inline constexpr SolidBox kLongTool{{-5, -5, 0}, {5, 5, 80}};
inline constexpr SolidBox kShortTool{{-5, -5, 8}, {5, 5, 80}};  // ends 8 mm higher

inline Triangles mesh_of(const SolidBox& of) {
    const auto narrow = [](const std::array<double, 3>& p) {
        return Vec3f{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    };
    return box(narrow(of.low), narrow(of.high));
}

/// Distance of two boxes along the axes, the second one moved; 0 where they share a point.
inline double boxes_mm(const SolidBox& a, const SolidBox& b, const std::array<double, 3>& by) {
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double gap =
            std::max({0.0, b.low[i] + by[i] - a.high[i], a.low[i] - (b.high[i] + by[i])});
        square += gap * gap;
    }
    return std::sqrt(square);
}

/// How far the tool is from plate and wall; 0: it touches them. X and Y move the table, Z the head.
inline double gap_mm(const SolidBox& tool, std::span<const double> axes) {
    const std::array<double, 3> by{-axes[0], -axes[1], axes[2]};
    return std::min(boxes_mm(kPlate, tool, by), boxes_mm(kWall, tool, by));
}

/// Tool 1 is the long one, tool 2 the short one. Limits of the axes and margins are 0.
inline CompiledMachine approach_machine() {
    CompiledMachine out;
    Machine& machine = out.machine;
    machine.name = "approach";
    for (const char* name : {"X", "Y", "Z"}) {
        Axis axis;
        axis.name = name;
        axis.min = -300;
        axis.max = 300;
        axis.position_error = 1e-3;
        machine.axes.push_back(axis);
    }
    machine.bodies.resize(kApproachBodies);
    const auto body = [&machine](std::uint32_t at, const char* name, std::uint32_t parent,
                                 std::uint32_t axis, Vec3d direction) {
        machine.bodies[at].name = name;
        machine.bodies[at].parent = parent;
        machine.bodies[at].joint = {axis, direction, {}};
    };
    body(kSaddleBody, "saddle", kNoIndex, 1, {0, 1, 0});
    body(kTableBody, "table", kSaddleBody, 0, {1, 0, 0});
    body(kHeadBody, "head", kNoIndex, 2, {0, 0, 1});
    body(kToolBody, "tool", kHeadBody, kNoIndex, {0, 0, 1});
    machine.bodies[kTableBody].has_mesh = true;
    machine.bodies[kToolBody].is_tool = true;
    machine.pairs = {{kToolBody, kTableBody, 0}};
    for (const auto& [number, solid] : {std::pair{1, kLongTool}, std::pair{2, kShortTool}}) {
        Tool tool;
        tool.number = static_cast<std::uint16_t>(number);
        tool.name = number == 1 ? "long" : "short";
        machine.tools.push_back(tool);
        out.meshes.tools.push_back({tool.name, mesh_of(solid)});
    }
    machine.first_tool = 1;
    for (const Body& one : machine.bodies) {
        out.meshes.bodies.push_back({one.name, {}});
    }
    out.meshes.bodies[kTableBody].triangles = together(mesh_of(kPlate), mesh_of(kWall));
    machine.can.axis_ids = {0x181, 0x281};
    machine.can.data_ids = {0x0181, 0x0281};
    return out;
}

}  // namespace axg::test
