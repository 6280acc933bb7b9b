// SPDX-License-Identifier: Apache-2.0
// Why nothing that is swept sticks out. Along an edge the distance from the axis is a convex
// function of the height, so between two heights the edge stays below the straight line between
// its radii there. At one height a triangle is a line whose ends are on edges, and the distance
// from the axis is largest at an end; a level triangle has its largest at a corner. So the edges
// suffice. Two levels, a few floats apart, enclose the height of each corner: a step of the outline
// stays a step, as steep. All later steps lift lines, and never lower one.
#include "core/mesh/swept_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::size_t kHeightsMax = 8192;                         // of the outline as it is found
constexpr std::size_t kStretchesMax = kProfilePointsMax / 2 - 1;  // of the one that is returned
constexpr double kTipMm = 1.0e-3;  // radius of a tip: its facets have some size
constexpr double kUp = 1.0e-6;     // relative; more than the rounding of a radius to float32

struct Point {
    double radius, height;
};

/// Between heights[k] and heights[k + 1] nothing is beyond the line from low[k] to high[k].
struct Envelope {
    std::vector<double> heights, low, high;

    [[nodiscard]] std::size_t stretches() const noexcept { return low.size(); }
};

std::array<Point, 3> corners_of(const Triangle& triangle) noexcept {
    std::array<Point, 3> out;
    std::size_t i = 0;
    for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
        const Vec3d p = widen(corner);
        out[i++] = {std::sqrt(p.x * p.x + p.y * p.y), p.z};
    }
    return out;
}

/// Ascending, around each corner's height; thinned out evenly where there are too many.
std::vector<double> heights_of(std::span<const Triangle> triangles) {
    std::vector<double> all;
    all.reserve(6 * triangles.size());
    for (const Triangle& triangle : triangles) {
        for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
            const double height = widen(corner).z;
            const double step = std::max(std::fabs(height) * 0x1p-22, 0x1p-30);
            all.push_back(static_cast<double>(static_cast<float>(height - step)));
            all.push_back(static_cast<double>(static_cast<float>(height + step)));
        }
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (all.size() <= kHeightsMax) {
        return all;
    }
    std::vector<double> some;
    for (std::size_t i = 0; i < kHeightsMax; ++i) {
        some.push_back(all[i * (all.size() - 1) / (kHeightsMax - 1)]);
    }
    return some;
}

void add_edge(Point a, Point b, Envelope& out) noexcept {
    if (a.height > b.height) {
        std::swap(a, b);
    }
    const auto radius_at = [&](double height) {
        const double all = b.height - a.height;
        return all > 0 ? a.radius + (b.radius - a.radius) * ((height - a.height) / all)
                       : std::max(a.radius, b.radius);
    };
    const std::vector<double>& heights = out.heights;
    const auto after = std::upper_bound(heights.begin(), heights.end(), a.height);
    for (auto k = static_cast<std::size_t>(after - heights.begin()) - 1;
         k < out.stretches() && heights[k] <= b.height; ++k) {
        const bool spans = a.height <= heights[k] && heights[k + 1] <= b.height;
        double low = radius_at(std::max(heights[k], a.height));
        double high = radius_at(std::min(heights[k + 1], b.height));
        if (!spans) {
            low = high = std::max(low, high);
        }
        out.low[k] = std::max(out.low[k], low);
        out.high[k] = std::max(out.high[k], high);
    }
}

Envelope envelope_of(std::span<const Triangle> triangles) {
    Envelope out{.heights = heights_of(triangles), .low = {}, .high = {}};
    out.low.resize(out.heights.size() - 1);
    out.high.resize(out.heights.size() - 1);
    for (const Triangle& triangle : triangles) {
        const std::array<Point, 3> corner = corners_of(triangle);
        for (std::size_t i = 0; i < 3; ++i) {
            add_edge(corner[i], corner[(i + 1) % 3], out);
        }
    }
    return out;
}

/// One line in place of several.
struct Stretch {
    double low_height, low_radius, high_height, high_radius;
    double off_mm;            // largest distance beyond the lines it replaces
    std::size_t split_after;  // where it should be cut if that is too far
};

Stretch line_over(const Envelope& envelope, std::size_t first, std::size_t last) noexcept {
    const std::vector<double>& heights = envelope.heights;
    Stretch out{.low_height = heights[first],
                .low_radius = envelope.low[first],
                .high_height = heights[last + 1],
                .high_radius = envelope.high[last],
                .off_mm = 0,
                .split_after = first};
    const double slope = (out.high_radius - out.low_radius) / (out.high_height - out.low_height);
    double above = 0, below = 0, worst = -1;
    for (std::size_t k = first; k <= last; ++k) {
        const std::array<Point, 2> ends{
            {{envelope.low[k], heights[k]}, {envelope.high[k], heights[k + 1]}}};
        for (std::size_t end = 0; end < 2; ++end) {
            const double line = out.low_radius + slope * (ends[end].height - out.low_height);
            const double over = ends[end].radius - line;
            above = std::max(above, over);
            below = std::max(below, -over);
            if (std::fabs(over) > worst) {
                worst = std::fabs(over);
                out.split_after = end == 1 ? k : std::max(k, first + 1) - 1;
            }
        }
    }
    out.split_after = std::min(out.split_after, last - (last > first ? 1 : 0));
    out.low_radius += above;
    out.high_radius += above;
    out.off_mm = above + below;
    return out;
}

/// As few lines as are within `off_mm`, by halving; empty if more than kStretchesMax.
std::vector<Stretch> lines_within(const Envelope& envelope, double off_mm) {
    std::vector<Stretch> out;
    std::vector<std::array<std::size_t, 2>> open{{0, envelope.stretches() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const Stretch line = line_over(envelope, first, last);
        if (line.off_mm > off_mm && first < last) {
            open.push_back({line.split_after + 1, last});
            open.push_back({first, line.split_after});
            continue;
        }
        out.push_back(line);
        if (out.size() > kStretchesMax) {
            return {};
        }
    }
    return out;
}

}  // namespace

std::vector<Vec3d> swept_profile(std::span<const Triangle> triangles) {
    const Envelope envelope = envelope_of(triangles);
    double off_mm = kSweptOutlineMm;
    std::vector<Stretch> lines = lines_within(envelope, off_mm);
    while (lines.empty()) {
        off_mm *= 2;
        lines = lines_within(envelope, off_mm);
    }
    std::vector<Vec3d> out{{0, 0, lines.front().low_height}};
    const auto add = [&out](double radius, double height) {
        const auto up =
            static_cast<double>(static_cast<float>(std::max(radius * (1 + kUp), kTipMm)));
        if (out.back() != Vec3d{up, 0, height}) {
            out.push_back({up, 0, height});
        }
    };
    for (const Stretch& line : lines) {
        add(line.low_radius, line.low_height);
        add(line.high_radius, line.high_height);
    }
    out.push_back({0, 0, lines.back().high_height});
    return out;
}

std::uint32_t swept_segments(double radius_mm) noexcept {
    for (std::uint32_t segments = 24; segments < 256; segments += 4) {
        if (radius_mm * (1 / sin_cos(kPi / segments).cos - 1) <= kSweptCircleMm) {
            return segments;
        }
    }
    return 256;
}

RevolutionResult swept_solid(std::span<const Triangle> triangles) {
    if (triangles.empty()) {
        return {.status = RevolutionStatus::bad_point_count, .point = 0, .triangles = {}};
    }
    const std::vector<Vec3d> profile = swept_profile(triangles);
    double radius_mm = 0;
    for (const Vec3d& point : profile) {
        radius_mm = std::max(radius_mm, point.x);
    }
    return solid_of_revolution(profile, swept_segments(radius_mm));
}

}  // namespace axg
