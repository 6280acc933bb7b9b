// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/enclosure.hpp"

#include <map>
#include <numeric>
#include <optional>

namespace axg::certcheck {
namespace {

// Along no axis and no diagonal: faces and edges of parts are along those.
constexpr std::array<std::array<double, 3>, 8> kRays{{{0.61, 0.37, 0.7},
                                                      {-0.53, 0.71, 0.46},
                                                      {0.29, -0.83, 0.48},
                                                      {0.41, 0.57, -0.71},
                                                      {-0.67, -0.31, 0.68},
                                                      {-0.23, 0.59, -0.77},
                                                      {0.73, -0.43, -0.53},
                                                      {-0.47, -0.61, -0.64}}};

/// 1 or -1 where the sign is sure, else 0.
int sign_of(Interval value) {
    return value.low > 0 ? 1 : (value.high < 0 ? -1 : 0);
}

Interval volume(const Vector& a, const Vector& b, const Vector& c) {
    return dot(a, cross(b, c));
}

Vector corner_of(const Triangle& triangle, std::size_t i) {
    return {{triangle[3 * i], triangle[3 * i + 1], triangle[3 * i + 2]}};
}

bool misses(const Vector& box, const Vector& point, const Vector& ray) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const Interval along = (box[i] - point[i]) / ray[i];
        from = std::max(from, along.low);
        to = std::min(to, along.high);
    }
    return from > to;
}

/// The share of one triangle in the winding number: 0, 1 or -1; nothing where a sign is not sure.
std::optional<int> crossing(const Triangle& triangle, const Vector& point, const Vector& ray) {
    const Vector a = corner_of(triangle, 0) - point, b = corner_of(triangle, 1) - point,
                 c = corner_of(triangle, 2) - point;
    const int ab = sign_of(volume(ray, a, b)), bc = sign_of(volume(ray, b, c)),
              ca = sign_of(volume(ray, c, a));
    const int most = std::max({ab, bc, ca}), least = std::min({ab, bc, ca});
    if (most == 1 && least == -1) {
        return 0;  // the line passes on different sides of two edges
    }
    const int side = sign_of(volume(a, b, c));
    if (most == least && most != 0) {
        // The line passes inside of all three: the ray, where the corners are on its side.
        return side == 0 ? std::nullopt : std::optional(side == most ? most : 0);
    }
    return std::nullopt;
}

std::optional<int> winding(const BoxTree& tree, const Vector& point,
                           const std::array<double, 3>& direction) {
    const Vector ray{{direction[0], direction[1], direction[2]}};
    int sum = 0;
    std::vector<TreeNode> open;
    if (!tree.triangles().empty()) {
        open.push_back(tree.top());
    }
    while (!open.empty()) {
        const TreeNode node = open.back();
        open.pop_back();
        if (misses(tree.box(node), point, ray)) {
            continue;
        }
        if (node.count > 1) {
            open.push_back(node.lower());
            open.push_back(node.upper());
            continue;
        }
        const std::optional<int> added = crossing(tree.triangle(node), point, ray);
        if (!added) {
            return std::nullopt;
        }
        sum += *added;
    }
    return sum;
}

}  // namespace

Parts parts_of(const std::vector<Triangle>& triangles) {
    // Equal corners, -0 and 0 among them, have one number.
    std::map<std::array<float, 3>, std::uint32_t> numbers;
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (const Triangle& t : triangles) {
        auto& of = corners.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::array<float, 3> at{t[3 * i] + 0.0F, t[3 * i + 1] + 0.0F,
                                          t[3 * i + 2] + 0.0F};
            of[i] = numbers.emplace(at, static_cast<std::uint32_t>(numbers.size())).first->second;
        }
    }
    std::vector<std::uint32_t> first(numbers.size());  // of the part, through others
    std::iota(first.begin(), first.end(), 0U);
    const auto part_of = [&](std::uint32_t corner) {
        while (first[corner] != corner) {
            corner = first[corner] = first[first[corner]];
        }
        return corner;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // runs one way less the other
    for (const auto& of : corners) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = of[i], to = of[(i + 1) % 3];
            first[part_of(from)] = part_of(to);
            edges[std::minmax(from, to)] += from == to ? 0 : (from < to ? 1 : -1);
        }
    }
    std::map<std::uint32_t, bool> is_closed;
    for (const auto& [edge, runs] : edges) {
        const auto [part, is_new] = is_closed.emplace(part_of(edge.first), true);
        part->second = part->second && runs == 0;
    }
    Parts parts;
    std::vector<Triangle> closed;
    std::map<std::uint32_t, bool> seen;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::uint32_t part = part_of(corners[i][0]);
        if (seen.emplace(part, true).second) {
            parts.corners.push_back(corner_of(triangles[i], 0));
            parts.open_count += is_closed[part] ? 0 : 1;
        }
        if (is_closed[part]) {
            closed.push_back(triangles[i]);
        }
    }
    parts.closed = BoxTree(std::move(closed));
    return parts;
}

bool is_outside(const Parts& one, const Pose& one_pose, const Parts& other,
                const Pose& other_pose) {
    for (const Vector& corner : one.corners) {
        // R^T is R's inverse up to 1e-9 in each entry of R^T R (read_model.cpp).
        Vector point = turned_back(other_pose, placed(one_pose, corner) - other_pose.shift);
        double off = 0;
        for (const Interval& each : point.at) {
            off += 2e-9 * std::max(-each.low, each.high);
        }
        for (Interval& each : point.at) {
            each = each + Interval(-off, off);
        }
        bool is_free = false;
        for (const auto& ray : kRays) {
            const std::optional<int> number = winding(other.closed, point, ray);
            if (number) {
                is_free = *number == 0;
                break;
            }
        }
        if (!is_free) {
            return false;
        }
    }
    return true;
}

}  // namespace axg::certcheck
