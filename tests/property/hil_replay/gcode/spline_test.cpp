// SPDX-License-Identifier: Apache-2.0
// Random G5, G5.1 and G5.2 to G5.3, in both units, with steps, offsets and rotation: the arcs pass
// the samples of the exact curve, which the recursion of Cox and de Boor gives from the words in
// long double; they are tangent to each other and to it, and near it between the samples.
// AXG_COUNT: curves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::Dice;

constexpr double kAngleMax = 0.4;  // rad: a curve that bends more may be anywhere near
constexpr double kOffMax = 0.5;    // both are in a triangle of this height; found: 0.43

struct ControlPoint {
    long double x = 0, y = 0, weight = 1;
};

struct SplineCase {
    std::string text;
    std::vector<ControlPoint> points;  // machine coordinates, mm
    int order = 0;
};

struct Spot {
    double x = 0, y = 0;
};

double between(Spot a, Spot b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

/// The function `index` of this order; knots are 0 and the last one `order` times, and whole
/// numbers in between.
long double basis(int index, int order, int degree_plus, long double u, int count) {
    const auto knot = [&](int i) {
        return static_cast<long double>(std::clamp(i - order + 1, 0, count - order + 1));
    };
    if (degree_plus == 1) {
        const bool is_last = u == knot(count) && knot(index + 1) == u;
        return (knot(index) <= u && u < knot(index + 1)) || (is_last && knot(index) < u) ? 1 : 0;
    }
    const long double low = knot(index + degree_plus - 1) - knot(index);
    const long double high = knot(index + degree_plus) - knot(index + 1);
    const long double rising =
        low == 0 ? 0 : (u - knot(index)) / low * basis(index, order, degree_plus - 1, u, count);
    const long double falling = high == 0 ? 0
                                          : (knot(index + degree_plus) - u) / high *
                                                basis(index + 1, order, degree_plus - 1, u, count);
    return rising + falling;
}

Spot exact(const SplineCase& one, long double u) {
    const int count = static_cast<int>(one.points.size());
    long double x = 0, y = 0, sum = 0;
    for (int i = 0; i < count; ++i) {
        const ControlPoint& point = one.points[static_cast<std::size_t>(i)];
        const long double share = basis(i, one.order, one.order, u, count) * point.weight;
        x += share * point.x;
        y += share * point.y;
        sum += share;
    }
    return {static_cast<double>(x / sum), static_cast<double>(y / sum)};
}

std::string spline_word(char letter, long double value) {
    char text[60];
    std::snprintf(text, sizeof text, " %c%.5Lf", letter, value);
    return text;
}

/// A number with the digits that these words have.
long double rounded(double value) {
    return std::round(static_cast<long double>(value) * 1e5L) / 1e5L;
}

SplineCase random_spline(Dice& dice) {
    SplineCase one;
    const bool is_inch = dice.chance(0.3), is_turned = dice.chance(0.4);
    const long double unit = is_inch ? 25.4L : 1.0L;
    const double reach = dice.magnitude(0.5, 120) / static_cast<double>(unit);
    const long double turn_deg = is_turned ? rounded(dice.in(-180, 180)) : 0;
    const ControlPoint offset{rounded(dice.in(-50, 50)), rounded(dice.in(-50, 50))};
    const int kind = static_cast<int>(dice.in(0, 3));  // G5, G5.1, NURBS
    const int count = kind == 0 ? 4 : kind == 1 ? 3 : static_cast<int>(dice.in(3, 9));
    one.order = kind == 2 ? std::min(count, static_cast<int>(dice.in(3, 6))) : count;
    for (int i = 0; i < count; ++i) {
        one.points.push_back({rounded(dice.in(-reach, reach)), rounded(dice.in(-reach, reach)),
                              kind == 2 ? rounded(dice.magnitude(0.2, 5)) : 1});
    }
    const std::vector<ControlPoint>& p = one.points;
    one.text = std::string(is_inch ? "G20" : "G21") + " G90 F100\nG10 L2 P1" +
               spline_word('X', offset.x) + spline_word('Y', offset.y) +
               spline_word('R', turn_deg) + "\nG0" + spline_word('X', p[0].x) +
               spline_word('Y', p[0].y) + "\n";
    const ControlPoint& end = p.back();
    const bool is_step = kind != 2 && dice.chance(0.3);
    const std::string to = spline_word('X', is_step ? end.x - p[0].x : end.x) +
                           spline_word('Y', is_step ? end.y - p[0].y : end.y);
    if (kind == 2) {
        one.text +=
            "G5.2" + spline_word('P', p[0].weight) + " L" + std::to_string(one.order) + "\n";
        for (int i = 1; i < count; ++i) {
            const ControlPoint& point = p[static_cast<std::size_t>(i)];
            one.text += spline_word('X', point.x) + spline_word('Y', point.y) +
                        spline_word('P', point.weight) + "\n";
        }
        one.text += "G5.3\n";
    } else {
        one.text += std::string(is_step ? "G91 " : "") + (kind == 0 ? "G5" : "G5.1") + to +
                    spline_word('I', p[1].x - p[0].x) + spline_word('J', p[1].y - p[0].y);
        one.text += kind == 0
                        ? spline_word('P', p[2].x - end.x) + spline_word('Q', p[2].y - end.y) + "\n"
                        : "\n";
    }
    one.text += "M2\n";
    const long double angle = turn_deg * 3.14159265358979323846264338327950288L / 180;
    for (ControlPoint& point : one.points) {
        const long double x = point.x * unit, y = point.y * unit;
        point.x = x * std::cos(angle) - y * std::sin(angle) + offset.x * unit;
        point.y = x * std::sin(angle) + y * std::cos(angle) + offset.y * unit;
    }
    return one;
}

Spot spot_of(const AxisPositions& at) {
    return {at[0], at[1]};
}

Spot on_arc(const Arc& arc, double share) {
    const double angle = arc.start_rad + arc.sweep_rad * share;
    return {arc.center_first_mm + arc.radius_start_mm * std::cos(angle),
            arc.center_second_mm + arc.radius_start_mm * std::sin(angle)};
}

/// The direction of a move at its start or end, rad.
double direction(const Move& move, Spot from, bool is_end) {
    if (move.kind == MoveKind::line) {
        return std::atan2(move.target[1] - from.y, move.target[0] - from.x);
    }
    const Arc& arc = move.arc;
    return arc.start_rad + (is_end ? arc.sweep_rad : 0) + (arc.sweep_rad > 0 ? kPi : -kPi) / 2;
}

double angle_apart(double a_rad, double b_rad) {
    return std::abs(std::remainder(a_rad - b_rad, 2 * kPi));
}

double distance_to(Spot at, Spot a, Spot b) {
    const double x = b.x - a.x, y = b.y - a.y, square = x * x + y * y;
    const double share =
        square > 0 ? std::clamp(((at.x - a.x) * x + (at.y - a.y) * y) / square, 0.0, 1.0) : 0.0;
    return between(at, {a.x + share * x, a.y + share * y});
}

/// What the test found. `off`: between samples, in distances of the samples times the angle at
/// which the curve leaves the line between them or meets it.
struct Worst {
    double sample_mm = 0, joint_rad = 0, off = 0;
    int bent = 0, pairs = 0;
};

/// How far the arcs are off the curve, given as the corners of many short lines.
double distance_off(const Move& move, std::span<const Spot> curve) {
    constexpr int kSpots = 12;
    double off = 0;
    for (int k = 0; k <= kSpots && move.kind == MoveKind::arc; ++k) {
        const Spot spot = on_arc(move.arc, static_cast<double>(k) / kSpots);
        double nearest = HUGE_VAL;
        for (std::size_t j = 0; j + 1 < curve.size(); ++j) {
            nearest = std::min(nearest, distance_to(spot, curve[j], curve[j + 1]));
        }
        off = std::max(off, nearest);
    }
    return off;
}

/// The pair of arcs number `pair` beside its part of the curve. moves[0] goes to its start.
void judge_pair(const SplineCase& one, const std::vector<Move>& moves, std::size_t pair,
                Worst& worst) {
    constexpr int kParts = 64;
    const std::size_t pairs = one.points.size() * 4;
    const auto last = static_cast<long double>(one.points.size() + 1) - one.order;
    std::array<Spot, kParts + 1> curve;
    for (int i = 0; i <= kParts; ++i) {
        const long double share = static_cast<long double>(i) / kParts;
        curve[static_cast<std::size_t>(i)] = exact(
            one, last * (static_cast<long double>(pair) + share) / static_cast<long double>(pairs));
    }
    const Move &before = moves[2 * pair], &first = moves[2 * pair + 1],
               &second = moves[2 * pair + 2];
    const Spot start = spot_of(before.target), middle = spot_of(first.target);
    worst.sample_mm = std::max({worst.sample_mm, between(start, curve.front()),
                                between(spot_of(second.target), curve.back())});
    const auto join = [&worst](const Move& in, const Move& out) {
        if (in.kind == MoveKind::arc && out.kind == MoveKind::arc) {  // else nearly straight
            worst.joint_rad = std::max(
                worst.joint_rad, angle_apart(direction(in, {}, true), direction(out, {}, false)));
        }
    };
    join(first, second);
    if (pair > 0) {
        join(before, first);
    }
    const double line =
        std::atan2(curve.back().y - curve.front().y, curve.back().x - curve.front().x);
    const double angle = std::max(angle_apart(direction(first, start, false), line),
                                  angle_apart(direction(second, middle, true), line));
    ++worst.pairs;
    if (angle > kAngleMax) {
        ++worst.bent;
        return;
    }
    const double off = std::max(distance_off(first, curve), distance_off(second, curve));
    worst.off = std::max(worst.off, off / (between(curve.front(), curve.back()) * angle));
}

TEST(GcodeSplines, ArcsPassTheSamplesOfTheExactCurveAndStayNearIt) {
    Dice dice(test::printed_seed(20261201));
    const char* const text = std::getenv("AXG_COUNT");
    const int count = text == nullptr ? 600 : std::max(1, std::atoi(text));
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.min = -1e7;
        axis.max = 1e7;
    }
    int refused = 0, flat = 0;
    Worst worst;
    for (int i = 0; i < count; ++i) {
        const SplineCase one = random_spline(dice);
        const GcodeResult result = read_gcode(one.text, machine, {});
        if (!result.faults.empty()) {
            EXPECT_EQ(result.faults[0].message.find("a part of the curve is straight"), 0U)
                << result.faults[0].message << "\n"
                << one.text;
            ++refused;
            continue;
        }
        const std::vector<Move>& moves = result.program.moves;
        const ControlPoint& end = one.points.back();
        EXPECT_LT(between(spot_of(moves.back().target),
                          {static_cast<double>(end.x), static_cast<double>(end.y)}),
                  1e-9)
            << one.text;
        if (moves.size() != 1 + 8 * one.points.size()) {  // a circle beyond 1 km became lines
            EXPECT_GT(moves.size(), 1 + 8 * one.points.size()) << one.text;
            ++flat;
            continue;
        }
        for (std::size_t pair = 0; pair < one.points.size() * 4; ++pair) {
            judge_pair(one, moves, pair, worst);
        }
    }
    std::printf(
        "%d curves, %d refused; samples %.2g mm off, joints %.2g rad; between samples "
        "%.3g of distance times angle off; %d of %d pairs bend more\n",
        count, refused, worst.sample_mm, worst.joint_rad, worst.off, worst.bent, worst.pairs);
    EXPECT_LT(worst.sample_mm, 1e-9);
    EXPECT_LT(worst.joint_rad, 1e-6);
    EXPECT_LT(worst.off, kOffMax);
    EXPECT_LT(worst.bent, worst.pairs / 4);
    EXPECT_LE(refused, count / 1000);
    EXPECT_LE(flat, count / 200);
}

// Cusps become arcs of less than a micrometre: the axes come through them, and no position jumps.
TEST(GcodeSplines, AxesMoveAlongThemWithinTheirSpeeds) {
    Dice dice(test::printed_seed(20261202));
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.min = -1e7;
        axis.max = 1e7;
    }
    const MotionLimits limits = make_motion_limits(machine);
    double smallest = HUGE_VAL;
    for (int i = 0; i < 40; ++i) {
        const GcodeResult result = read_gcode(random_spline(dice).text, machine, {});
        ASSERT_TRUE(result.faults.empty());
        for (const Move& move : result.program.moves) {
            smallest = move.kind == MoveKind::arc ? std::min(smallest, move.arc.radius_start_mm)
                                                  : smallest;
        }
        const MotionOptions motion;
        MotionSampler sampler(result.program, limits, motion);
        MotionSample sample;
        AxisPositions before = result.program.start;
        double fastest = 0;
        while (sampler.next(sample)) {
            for (std::uint32_t axis = 0; axis < limits.axis_count; ++axis) {
                fastest = std::max(fastest, std::abs(sample.position[axis] - before[axis]) /
                                                (limits.speed[axis] * kMotionStepS));
            }
            before = sample.position;
        }
        EXPECT_LT(fastest, 1.001);
        EXPECT_GT(fastest, 0);
        EXPECT_EQ(sample.position, result.program.moves.back().target);
    }
    std::printf("smallest radius %.2g mm\n", smallest);
    EXPECT_LT(smallest, 0.5);
}

}  // namespace
}  // namespace axg
