// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_biarc.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/assert.hpp"
#include "hil_replay/gcode/plane_point.hpp"

namespace axg {
namespace {

// LinuxCNC 2.9, emccanon.cc and nurbs_additional_functions.cc, in the program's unit.
constexpr std::size_t kSamplesPerPoint = 4;
constexpr double kDifference = 1e-5;  // of the parameter, on either side
constexpr double kStraight = 1e-6;    // twice the chord's part across the tangent: less is a line

// LinuxCNC divides by 1 - cos of the angle between two tangents. Nearer to nothing, the rounding
// of that cosine decides its answer; from here on its answer and this one differ by less than
// 1e-9 of the chord.
constexpr double kCosineRest = 1e-12;
constexpr double kChordRest = 1e-9;  // of the largest coordinate: samples at one place
constexpr double kReachMax = 1e6;    // far beyond any travel; its powers are numbers

/// A point and the direction in which the curve passes it; the direction is 0 0 where it has none.
struct Sample {
    PlanePoint at, along;
};

PlanePoint direction(PlanePoint a) {
    const double size = length(a);
    return size > 0 && std::isfinite(size) ? 1 / size * a : PlanePoint{};
}

PlanePoint place_at(std::span<const SplinePoint> points, std::uint32_t order, double parameter) {
    const SplinePoint point = spline_at(points, order, parameter);
    return {point.first, point.second};
}

Sample sample_at(std::span<const SplinePoint> points, std::uint32_t order, double parameter) {
    const double last = static_cast<double>(points.size() - order + 1);
    const double low = std::max(0.0, parameter - kDifference);
    const double high = std::min(last, parameter + kDifference);
    return {place_at(points, order, parameter),
            direction(place_at(points, order, high) - place_at(points, order, low))};
}

/// A circle through both ends that leaves the first along `tangent`, or the line between them.
SplinePiece bend(PlanePoint from, PlanePoint to, PlanePoint tangent) {
    SplinePiece piece{.end_first = to.first, .end_second = to.second};
    const PlanePoint chord = to - from;
    const double across = 2 * (chord.second * tangent.first - chord.first * tangent.second);
    if (std::abs(across) > kStraight) {
        const double radius = dot(chord, chord) / across;  // positive: the centre is to the left
        piece.is_arc = true;
        piece.is_clockwise = radius < 0;
        piece.center_first = from.first - radius * tangent.second;
        piece.center_second = from.second + radius * tangent.first;
    }
    return piece;
}

/// The length of both tangents of a pair: its positive root. The pair meets at half the way
/// between their ends, along the line that joins these.
double tangent_length(const Sample& from, const Sample& to) {
    const PlanePoint back = from.at - to.at, turn = from.along - to.along;
    const double square = -dot(turn, turn);  // below 0
    const double middle = 2 * dot(back, from.along + to.along), rest = dot(back, back);
    const double root = std::sqrt(middle * middle - 4 * square * rest);
    return middle <= 0 ? 2 * rest / (root - middle) : (-middle - root) / (2 * square);
}

std::string fault_between(const Sample& from, const Sample& to, double reach) {
    const PlanePoint turn = from.along - to.along, chord = to.at - from.at;
    if (!(dot(from.along, from.along) > 0) || !(dot(to.along, to.along) > 0) ||
        !(length(chord) > kChordRest * reach)) {
        return "the curve stands still or turns back at once, and LinuxCNC's arcs have no "
               "direction "
               "there; move its control points apart";
    }
    if (!(dot(turn, turn) / 2 >= kCosineRest)) {
        return "a part of the curve is straight, or ends in the direction in which it began: "
               "LinuxCNC divides by zero there; write G1 for it";
    }
    return {};
}

}  // namespace

SplinePoint spline_at(std::span<const SplinePoint> points, std::uint32_t order, double parameter) {
    AXG_ASSERT(order >= kSplineOrderMin && order <= kSplineOrderMax && points.size() >= order);
    const std::size_t spans = points.size() - order + 1;
    const std::size_t span =
        std::min(static_cast<std::size_t>(std::max(0.0, parameter)), spans - 1);
    const auto knot = [&](std::size_t index) {
        return static_cast<double>(std::min(index < order ? 0 : index - order + 1, spans));
    };
    std::array<SplinePoint, kSplineOrderMax> level;  // times the weight
    for (std::size_t i = 0; i < order; ++i) {
        const SplinePoint& point = points[span + i];
        level[i] = {point.first * point.weight, point.second * point.weight, point.weight};
    }
    for (std::size_t step = 1; step < order; ++step) {
        for (std::size_t i = order - 1; i >= step; --i) {
            const double low = knot(span + i), high = knot(span + i + order - step);
            const double share = (parameter - low) / (high - low);
            const SplinePoint& before = level[i - 1];
            level[i].first = (1 - share) * before.first + share * level[i].first;
            level[i].second = (1 - share) * before.second + share * level[i].second;
            level[i].weight = (1 - share) * before.weight + share * level[i].weight;
        }
    }
    const SplinePoint& top = level[order - 1];
    return {top.first / top.weight, top.second / top.weight, top.weight};
}

SplineShape solve_spline(std::span<const SplinePoint> points, std::uint32_t order) {
    SplineShape shape;
    const std::size_t samples = points.size() * kSamplesPerPoint;
    const auto last = static_cast<double>(points.size() - order + 1);
    double reach = 0;
    for (const SplinePoint& point : points) {
        reach = std::max({reach, std::abs(point.first), std::abs(point.second)});
    }
    if (!(reach <= kReachMax)) {
        shape.fault = "a control point is farther away than any travel; check its words";
        return shape;
    }
    Sample from = sample_at(points, order, 0);
    shape.pieces.reserve(2 * samples);
    for (std::size_t i = 1; i <= samples; ++i) {
        const double parameter = last * static_cast<double>(i) / static_cast<double>(samples);
        const Sample to = sample_at(points, order, parameter);
        shape.fault = fault_between(from, to, reach);
        if (!shape.fault.empty()) {
            return shape;
        }
        const double size = tangent_length(from, to);
        const PlanePoint first = from.at + size * from.along, second = to.at - size * to.along;
        const PlanePoint middle = 0.5 * (first + second);
        shape.pieces.push_back(bend(from.at, middle, from.along));
        shape.pieces.push_back(bend(middle, to.at, direction(second - middle)));
        from = to;
    }
    return shape;
}

}  // namespace axg
