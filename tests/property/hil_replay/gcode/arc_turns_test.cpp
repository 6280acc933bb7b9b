// SPDX-License-Identifier: Apache-2.0
// Full and nearly full arcs whose start is reached in six ways: the swept angle is the one that
// whole numbers give, from the words alone. A difference of 1e-5 of the unit is no rounding.
// AXG_COUNT: programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::Dice;

constexpr long double kTurn = 2 * 3.14159265358979323846264338327950288L;
constexpr double kMicrosPerUnit = 1e6;  // words have six decimals
constexpr int kWays = 6;
constexpr const char* kWayNames[kWays] = {"absolute", "G91 steps", "G53",
                                          "G92",      "G10",       "G43 again"};

using Micros = std::array<std::int64_t, 3>;  // X Y Z in 1e-6 of the unit

int programs() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? 4000 : std::max(1, std::atoi(text));
}

std::string word(char letter, std::int64_t micros) {
    char text[40];
    const std::int64_t size = micros < 0 ? -micros : micros;
    std::snprintf(text, sizeof text, " %c%s%lld.%06lld", letter, micros < 0 ? "-" : "",
                  static_cast<long long>(size / 1'000'000),
                  static_cast<long long>(size % 1'000'000));
    return text;
}

std::string words(const Micros& at) {
    return word('X', at[0]) + word('Y', at[1]) + word('Z', at[2]);
}

std::int64_t micros(double value, double step) {
    return std::llround(value / step) * std::llround(step * kMicrosPerUnit);
}

Micros random_place(Dice& dice, double reach) {
    const double step = dice.chance(0.5) ? 1e-3 : 1e-6;
    return {micros(dice.in(-reach, reach), step), micros(dice.in(-reach, reach), step),
            micros(dice.in(-reach, reach), step)};
}

struct ArcCase {
    std::string text;
    int way = 0;
    bool is_inch = false;
    long double sweep_rad = 0;
    double radius = 0;     // in the unit
    double tolerance = 0;  // along the circle, in the unit
};

/// Goes to `start` and leaves the coordinates such that its words name that place.
std::string reach(int way, const Micros& start, Dice& dice) {
    const Micros offset = random_place(dice, 900), other = random_place(dice, 900);
    const auto sum = [](const Micros& a, const Micros& b, std::int64_t factor) {
        return Micros{a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
    };
    std::string text = "G10 L2 P1" + words(offset) + "\nG54\n";
    if (way == 0) {
        return text + "G0" + words(start) + "\n";
    }
    if (way == 1) {
        const Micros step = random_place(dice, 0.3);
        const auto count = static_cast<std::int64_t>(dice.magnitude(2, 500));
        return text + "G0" + words(sum(start, step, -count)) + "\nG91\no1 repeat [" +
               std::to_string(count) + "]\nG1" + words(step) + "\no1 endrepeat\nG90\n";
    }
    if (way == 2) {
        return text + "G53 G0" + words(sum(start, offset, 1)) + "\n";
    }
    if (way == 3) {
        return text + "G0" + words(other) + "\nG92" + words(start) + "\n";
    }
    if (way == 4) {
        text += "G0" + words(other) + "\n";
        return text + (dice.chance(0.5)
                           ? "G10 L20 P1" + words(start) + "\n"
                           : "G10 L2 P1" + words(sum(sum(other, offset, 1), start, -1)) + "\n");
    }
    constexpr const char* kAgain[] = {"G43 H1\n", "M429\nM428\n", "G49\nG43 H1\n", "M429 G49\n"};
    text += "G0 A" + std::to_string(dice.in(-60, 20)) + " C" + std::to_string(dice.in(-400, 400)) +
            "\nM428 G43 H1\nG0" + words(start) + "\n";
    const auto again = static_cast<std::size_t>(dice.in(0, 4));
    // Without the control the axes' words name another place: go there again.
    return text + kAgain[again] + (again == 3 ? "G0" + words(start) + "\n" : "");
}

/// The angle from one vector to the other, above 0 and up to a turn.
long double angle_between(std::int64_t a1, std::int64_t a2, std::int64_t b1, std::int64_t b2,
                          bool is_clockwise) {
    const auto wide = [](std::int64_t value) { return static_cast<long double>(value); };
    const long double cross = wide(a1) * wide(b2) - wide(a2) * wide(b1);
    const long double angle =
        std::atan2(is_clockwise ? -cross : cross, wide(a1) * wide(b1) + wide(a2) * wide(b2));
    return angle > 0 ? angle : angle + kTurn;
}

ArcCase random_case(Dice& dice) {
    constexpr const char* kPlanes[] = {"XYIJ", "ZXKI", "YZJK"};
    constexpr std::array<std::array<std::size_t, 3>, 3> kAxes{{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
    ArcCase out;
    const auto plane = static_cast<std::size_t>(dice.in(0, 3));
    const auto [first, second, along] = kAxes[plane];
    const char* const letters = kPlanes[plane];
    out.way = static_cast<int>(dice.in(0, kWays));
    out.is_inch = dice.chance(0.3);
    const bool is_clockwise = dice.chance(0.5), is_full = dice.chance(0.5);
    const bool has_radius = !is_full && dice.chance(0.3);
    const double radius = dice.magnitude(0.05, 100), from = dice.in(0, 6.3);
    const Micros start = random_place(dice, 300);
    const std::int64_t to_first = micros(-radius * std::cos(from), 1e-6);
    const std::int64_t to_second = micros(-radius * std::sin(from), 1e-6);
    out.radius = std::hypot(to_first, to_second) / kMicrosPerUnit;
    Micros end = start;
    if (!is_full) {
        const double way =
            dice.magnitude(has_radius ? 1e-3 : 1e-5, 0.5) / radius * (dice.chance(0.5) ? 1 : -1);
        const double c = std::cos(way), s = std::sin(way);
        const auto a = static_cast<double>(-to_first), b = static_cast<double>(-to_second);
        end[first] = start[first] + to_first + std::llround(c * a - s * b);
        end[second] = start[second] + to_second + std::llround(s * a + c * b);
    }
    out.text = std::string(out.is_inch ? "G20" : "G21") + " G90 G1 F100\n" +
               (plane == 0   ? "G17"
                : plane == 1 ? "G18"
                             : "G19") +
               "\n" + reach(out.way, start, dice);
    out.text += is_clockwise ? "G2" : "G3";
    if (!is_full || dice.chance(0.7)) {
        out.text += word(letters[0], end[first]) + word(letters[1], end[second]);
    }
    if (dice.chance(0.3)) {
        out.text += word("XYZ"[along], start[along] + micros(dice.in(-5, 5), 1e-3));
    }
    const std::int64_t turns = dice.chance(0.3) ? 2 : 1;
    out.text += turns == 1 ? "" : " P2";
    out.tolerance = 1e-7;
    if (has_radius) {
        const bool is_long = dice.chance(0.5);
        const std::int64_t r = std::llround(out.radius * kMicrosPerUnit);
        out.text += word('R', is_long ? -r : r);
        const long double half = std::hypot(static_cast<long double>(end[first] - start[first]),
                                            static_cast<long double>(end[second] - start[second])) /
                                 2;
        const long double around = 2 * std::asin(half / static_cast<long double>(r));
        out.sweep_rad = is_long ? kTurn - around : around;
        out.tolerance = 1e-5;  // the chord is short: its direction has the error of its ends
    } else {
        out.text += word(letters[2], to_first) + word(letters[3], to_second);
        out.sweep_rad = angle_between(-to_first, -to_second, end[first] - start[first] - to_first,
                                      end[second] - start[second] - to_second, is_clockwise);
    }
    out.sweep_rad += kTurn * static_cast<long double>(turns - 1);
    out.sweep_rad *= is_clockwise ? -1 : 1;
    out.text += "\nM2\n";
    return out;
}

TEST(GcodeArcs, TurnsFollowTheWordsHoweverTheStartWasReached) {
    Dice dice(test::printed_seed(20261130));
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.min = -1e6;
        axis.max = 1e6;
    }
    const int count = programs();
    std::array<int, kWays> differences{}, refused{};
    for (int i = 0; i < count; ++i) {
        const ArcCase one = random_case(dice);
        const GcodeResult result = read_gcode(one.text, machine, {});
        const auto way = static_cast<std::size_t>(one.way);
        if (!result.faults.empty()) {
            EXPECT_EQ(refused[way]++, 0) << result.faults[0].message << "\n" << one.text;
            continue;
        }
        const Move& last = result.program.moves.back();
        const double off = std::abs(last.arc.sweep_rad - static_cast<double>(one.sweep_rad));
        if (last.kind != MoveKind::arc || !(off * one.radius <= one.tolerance)) {
            EXPECT_EQ(differences[way]++, 0) << "sweep " << last.arc.sweep_rad << ", expected "
                                             << static_cast<double>(one.sweep_rad) << "\n"
                                             << one.text;
        }
    }
    int sum = 0;
    for (std::size_t way = 0; way < kWays; ++way) {
        std::printf("%s: %d differ, %d refused\n", kWayNames[way], differences[way], refused[way]);
        sum += differences[way] + refused[way];
    }
    EXPECT_EQ(sum, 0) << "of " << count;
}

}  // namespace
}  // namespace axg
