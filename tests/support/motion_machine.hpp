// SPDX-License-Identifier: Apache-2.0
// A five-axis table machine in code, for tests of programs and motion: no file, no surface.
#pragma once

#include "core/machine.hpp"
#include "core/sincos.hpp"

namespace axg {

inline constexpr double kTestRadPerDegree = kPi / 180.0;

/// X Y Z +-300 mm (Z -400..100), A -110..30 degrees, C endless; tool 1 is 50 mm long, tool 2
/// has 80.
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
