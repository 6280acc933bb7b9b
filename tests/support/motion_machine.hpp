// SPDX-License-Identifier: Apache-2.0
// A five-axis table machine in code, for tests of programs and motion: no file, no surface.
#pragma once

#include "core/base/sincos.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr double kTestRadPerDegree = kPi / 180.0;

/// X Y Z +-300 mm (Z -400..100), A -110..30 degrees, C endless, both in the table, 200 mm below the
/// spindle's nose; tool 1 is 50 mm long, tool 2 has 80.
inline Machine motion_test_machine() {
    Machine machine;
    machine.name = "motion-test";
    const auto linear = [](const char* name, double low, double high) {
        Axis axis;
        axis.name = name;
        axis.min = low;
        axis.max = high;
        axis.speed_max = 10000.0 / 60.0;
        axis.acceleration_max = 2000;
        axis.jerk_max = 50000;
        axis.stopping_min = 1500;
        return axis;
    };
    machine.axes = {linear("X", -300, 300), linear("Y", -300, 300), linear("Z", -400, 100)};
    Axis tilt;
    tilt.name = "A";
    tilt.kind = AxisKind::rotary;
    tilt.min = -110 * kTestRadPerDegree;
    tilt.max = 30 * kTestRadPerDegree;
    tilt.speed_max = 90 * kTestRadPerDegree;
    tilt.acceleration_max = 500 * kTestRadPerDegree;
    tilt.jerk_max = 10000 * kTestRadPerDegree;
    tilt.stopping_min = 400 * kTestRadPerDegree;
    Axis turn = tilt;
    turn.name = "C";
    turn.unlimited = true;
    turn.min = turn.max = 0;
    turn.speed_max = 180 * kTestRadPerDegree;
    turn.acceleration_max = 900 * kTestRadPerDegree;
    turn.jerk_max = 20000 * kTestRadPerDegree;
    machine.axes.push_back(tilt);
    machine.axes.push_back(turn);
    const auto carried = [&machine](const char* name, std::uint32_t parent, std::uint32_t axis,
                                    Vec3d direction) {
        Body body;
        body.name = name;
        body.parent = parent;
        body.joint = {.axis = axis, .direction = direction, .pivot_mm = {0, 0, -200}};
        machine.bodies.push_back(body);
    };
    carried("saddle", kNoIndex, 1, {0, -1, 0});
    carried("table", 0, 0, {-1, 0, 0});
    carried("cradle", 1, 3, {-1, 0, 0});
    carried("plate", 2, 4, {0, 0, -1});
    carried("head", kNoIndex, 2, {0, 0, 1});
    carried("cutter", 4, kNoIndex, {0, 0, 1});
    machine.bodies.back().is_tool = true;
    Tool tool;
    tool.number = 1;
    tool.name = "mill";
    tool.length_mm = 50;
    machine.tools.push_back(tool);
    tool.number = 2;
    tool.length_mm = 80;
    machine.tools.push_back(tool);
    machine.first_tool = 1;
    return machine;
}

}  // namespace axg
