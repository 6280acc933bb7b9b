// SPDX-License-Identifier: Apache-2.0
// Machines with random limits and programs of every kind of move for them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/machine/machine.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {

inline Machine random_motion_machine(Dice& dice) {
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        const double unit = axis.kind == AxisKind::rotary ? kTestRadPerDegree : 1.0;
        axis.speed_max = dice.magnitude(20, 1000) * unit;
        axis.acceleration_max = dice.magnitude(100, 20000) * unit;
        axis.jerk_max = dice.magnitude(2000, 1e6) * unit;
    }
    machine.program_speed_mm_s = dice.magnitude(20, 1000);
    return machine;
}

inline void append(std::string& text, const char* format, double a, double b = 0, double c = 0,
                   double d = 0, double e = 0) {
    char line[256];
    std::snprintf(line, sizeof line, format, a, b, c, d, e);
    text += line;
}

/// Long moves, short ones, dense curves of short lines, arcs, helices, dwells, all feed and path
/// modes.
inline std::string random_program(Dice& dice) {
    std::string text;
    double x = 0, y = 0;
    const auto go = [&](double to_x, double to_y) {
        x = std::clamp(to_x, -250.0, 250.0);
        y = std::clamp(to_y, -250.0, 250.0);
        append(text, "X%.9f Y%.9f\n", x, y);
    };
    append(text, "G1 F%.6f\n", dice.magnitude(1500, 30000));
    for (int block = 0; block < 12; ++block) {
        const double kind = dice.in(0, 7);
        if (kind < 1) {
            append(text, "G%.0f X%.9f Y%.9f Z%.9f A%.9f C%.9f\n", dice.chance(0.5) ? 0 : 1,
                   x = dice.in(-250, 250), y = dice.in(-250, 250), dice.in(-300, 90),
                   dice.in(-100, 20));
        } else if (kind < 2) {
            const double step = dice.magnitude(1e-4, 1.0), bend = dice.in(-0.1, 0.1);
            double heading = dice.in(0, 6.3);
            text += "G1\n";
            for (int i = 0; i < 80; ++i) {
                heading += bend + dice.in(-0.01, 0.01);
                go(x + step * std::cos(heading), y + step * std::sin(heading));
            }
        } else if (kind < 3) {
            const double radius = dice.magnitude(0.01, 40), from = dice.in(-3, 3);
            const double sweep = dice.in(0.1, 6), side = dice.chance(0.5) ? 1 : -1;
            append(text, "G0 X%.9f Y%.9f\n", x = dice.in(-150, 150), y = dice.in(-150, 150));
            const double i = -radius * std::cos(from), j = -radius * std::sin(from);
            const double end_x = x + i + radius * std::cos(from + side * sweep);
            const double end_y = y + j + radius * std::sin(from + side * sweep);
            append(text,
                   side > 0 ? "G3 X%.12f Y%.12f I%.12f J%.12f Z%.9f"
                            : "G2 X%.12f Y%.12f I%.12f J%.12f Z%.9f",
                   end_x, end_y, i, j, dice.in(-300, 90));
            append(text, dice.chance(0.3) ? " P2 A%.6f\n" : " A%.6f\n", dice.in(-100, 20));
            x = end_x;
            y = end_y;
        } else if (kind < 4) {
            append(text, dice.chance(0.3) ? "G61\n" : "G64 P%.6f\n", dice.magnitude(1e-4, 0.5));
        } else if (kind < 5) {
            append(text, "G93 G1 X%.9f C%.6f F%.6f\nG94 F%.6f\n", x = dice.in(-250, 250),
                   dice.in(-720, 720), dice.magnitude(15, 1000), dice.magnitude(1500, 30000));
        } else if (kind < 6) {
            append(text, "G1 A%.6f C%.6f\nG4 P%.4f\n", dice.in(-100, 20), dice.in(-720, 720),
                   dice.in(0, 0.01));
        } else {
            text += "G1\n";
            for (int i = 0; i < 6; ++i) {
                go(x + dice.in(-5, 5), y + dice.in(-5, 5));
            }
        }
    }
    return text + "M2\n";
}

}  // namespace axg::test
