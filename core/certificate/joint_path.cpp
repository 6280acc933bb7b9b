// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/joint_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/sincos.hpp"

namespace axg {

namespace {

constexpr double kSquareMin = 0x1p-900;  // smaller squares may have lost terms to underflow
constexpr double kUp = 1.0 + 0x1p-40;    // exceeds the roundings of any formula below

struct Line {
    Vec3d point, direction;
};

double distance_from(const Line& line, Vec3d p) noexcept {
    const Vec3d c = cross(p - line.point, line.direction);
    return std::sqrt(dot(c, c));
}

/// The joint's axis in the mesh frame of a body placed there.
Line axis_seen_from(const Pose& placed, const Pose& moved, const Joint& joint) noexcept {
    const Pose to_mesh = inverse(placed);
    return {apply(to_mesh, apply(moved, joint.pivot_mm)),
            rotate(to_mesh, rotate(moved, joint.direction))};
}

/// Largest distance of any point of the body from the line: the smaller bound of box and ball.
double reach_mm(const BodyExtent& extent, const Line& line) noexcept {
    double corner = 0;
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3d p{(i & 1U) != 0 ? extent.high_mm.x : extent.low_mm.x,
                      (i & 2U) != 0 ? extent.high_mm.y : extent.low_mm.y,
                      (i & 4U) != 0 ? extent.high_mm.z : extent.low_mm.z};
        corner = std::max(corner, distance_from(line, p));
    }
    return std::min(corner, distance_from(line, extent.middle_mm) + extent.radius_mm) * kUp +
           kPlacementErrorMm;
}

/// Largest motion of a point `lever` away from an axis that turns by up to `half`.
double chord_mm(double lever, double half_rad) noexcept {
    return half_rad >= kPi ? 2.0 * lever : 2.0 * lever * sin_cos(0.5 * half_rad).sin * kUp;
}

/// Linear joints of a path with no rotary one between them move the body by the sum of their
/// vectors. Its length is at most the root of sum w_i w_j |d_i . d_j|, whatever the signs.
/// @param half  [axes] mm
/// @param out   [count] each joint's share of that length, mm; the shares add up to it
void shift_mm(const Machine& machine, const std::uint32_t* bodies, std::uint32_t count,
              std::span<const double> half, double* out) noexcept {
    double square = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Joint& joint = machine.bodies[bodies[i]].joint;
        double row = 0;
        for (std::uint32_t j = 0; j < count; ++j) {
            const Joint& other = machine.bodies[bodies[j]].joint;
            const double along = i == j ? 1 : std::fabs(dot(joint.direction, other.direction));
            row += half[joint.axis] * half[other.axis] * along;
        }
        out[i] = row;
        square += row;
    }
    const double length = std::sqrt(square) * kUp;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double alone = half[machine.bodies[bodies[i]].joint.axis];
        out[i] = square > kSquareMin ? out[i] / square * length : alone;
    }
}

bool is_linear(const Machine& machine, const JointPath& path, std::uint32_t k) noexcept {
    return machine.axes[machine.bodies[path.body[k]].joint.axis].kind == AxisKind::linear;
}

/// Computes shift_mm for every group of adjacent linear joints.
/// @param out  [path] mm; 0 for a rotary joint
void shifts_along(const Machine& machine, const JointPath& path, std::span<const double> half,
                  double* out) noexcept {
    for (std::uint32_t k = 0; k < path.count;) {
        std::uint32_t end = k;
        while (end < path.count && is_linear(machine, path, end)) {
            ++end;
        }
        shift_mm(machine, &path.body[k], end - k, half, &out[k]);
        k = end + 1;  // past the rotary joint, too
    }
}

/// The levers of one body: at the box's centre, plus the motion of the joints between.
/// @param from_a  the body is at the path's first end: visit joints in the path's order
/// @param shifts  [path] of the linear joints (shifts_along)
/// @param out     [path] mm, lowered to these levers if larger; only rotary joints
void levers_of(const Machine& machine, const JointPath& path, std::span<const Pose> moved,
               const PlacedBody& body, bool from_a, const JointBox& box, const double* shifts,
               double* out) noexcept {
    double between_mm = 0;
    for (std::uint32_t k = 0; k < path.count; ++k) {
        const std::uint32_t at = from_a ? k : path.count - 1 - k;
        if (is_linear(machine, path, at)) {
            between_mm += shifts[at];
            continue;
        }
        const Joint& joint = machine.bodies[path.body[at]].joint;
        const Line axis = axis_seen_from(body.placed, moved[path.body[at]], joint);
        const double lever_mm = reach_mm(*body.extent, axis) + between_mm * kUp;
        between_mm += chord_mm(lever_mm, box.half[joint.axis]);
        // Turning a about an axis equals turning b the other way: the shorter lever counts.
        out[at] = std::min(out[at], lever_mm);
    }
}

}  // namespace

BodyExtent extent_of(const Mesh& mesh) noexcept {
    BodyExtent e;
    bool is_first = true;
    const auto each = [&mesh](auto&& use) {
        for (const Triangle& t : mesh.triangles) {
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                use(widen(v));
            }
        }
    };
    each([&](Vec3d p) {
        if (is_first) {
            e.low_mm = e.high_mm = p;
            is_first = false;
        }
        e.low_mm = {std::min(e.low_mm.x, p.x), std::min(e.low_mm.y, p.y),
                    std::min(e.low_mm.z, p.z)};
        e.high_mm = {std::max(e.high_mm.x, p.x), std::max(e.high_mm.y, p.y),
                     std::max(e.high_mm.z, p.z)};
    });
    e.middle_mm = 0.5 * (e.low_mm + e.high_mm);
    double square = 0;
    each([&](Vec3d p) {
        const Vec3d d = p - e.middle_mm;
        square = std::max(square, dot(d, d));
    });
    e.radius_mm = std::sqrt(square) * kUp;
    return e;
}

JointPath path_between(const Machine& machine, std::uint32_t a, std::uint32_t b) noexcept {
    JointPath path;
    // Parents have smaller indices: the body with the larger index is no ancestor of the other.
    std::array<std::uint32_t, kPathMax> from_b{};
    std::uint32_t count_b = 0;
    const auto moves = [&machine](std::uint32_t body) {
        return machine.bodies[body].joint.axis != kNoIndex;
    };
    while (a != b) {
        const bool climbs_a = b == kNoIndex || (a != kNoIndex && a > b);
        std::uint32_t& end = climbs_a ? a : b;
        if (moves(end)) {
            if (climbs_a) {
                path.body[path.count_a++] = end;
            } else {
                from_b[count_b++] = end;
            }
        }
        end = machine.bodies[end].parent;
    }
    path.count = path.count_a;
    while (count_b > 0) {
        path.body[path.count++] = from_b[--count_b];
    }
    return path;
}

PathLevers levers_over(const Machine& machine, const JointPath& path, std::span<const Pose> moved,
                       const PlacedBody& a, const PlacedBody& b, const JointBox& box) noexcept {
    std::array<double, kPathMax> shifts{};
    shifts_along(machine, path, box.half, shifts.data());
    PathLevers out;
    for (std::uint32_t k = 0; k < path.count; ++k) {
        out.mm[k] = is_linear(machine, path, k) ? 0 : std::numeric_limits<double>::infinity();
    }
    levers_of(machine, path, moved, a, true, box, shifts.data(), out.mm.data());
    levers_of(machine, path, moved, b, false, box, shifts.data(), out.mm.data());
    return out;
}

PathMotion motion_by(const Machine& machine, const JointPath& path, const PathLevers& levers,
                     std::span<const double> half) noexcept {
    std::array<double, kPathMax> motions{};
    shifts_along(machine, path, half, motions.data());
    PathMotion out;
    std::array<double, kAxesMax> by_axis{};
    for (std::uint32_t k = 0; k < path.count; ++k) {
        const std::uint32_t axis = machine.bodies[path.body[k]].joint.axis;
        if (!is_linear(machine, path, k)) {
            motions[k] = chord_mm(levers.mm[k], half[axis]);
        }
        by_axis[axis] += motions[k];
        out.total_mm += motions[k];
    }
    double most = 0;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (by_axis[i] > most) {
            most = by_axis[i];
            out.widest_axis = i;
        }
    }
    out.total_mm *= kUp;
    return out;
}

PathMotion motion_along(const Machine& machine, const JointPath& path, std::span<const Pose> moved,
                        const PlacedBody& a, const PlacedBody& b, const JointBox& box) noexcept {
    return motion_by(machine, path, levers_over(machine, path, moved, a, b, box), box.half);
}

bool is_in_box_any_turn(const Machine& machine, const JointPath& path, const JointBox& box,
                        std::span<const double> position) noexcept {
    bool inside = true;
    for (std::uint32_t k = 0; inside && k < path.count; ++k) {
        const std::uint32_t axis = machine.bodies[path.body[k]].joint.axis;
        double off = position[axis] - box.centre[axis];
        if (machine.axes[axis].unlimited) {
            off -= 2 * kPi * std::round(off / (2 * kPi));
        }
        inside = std::fabs(off) <= box.half[axis];
    }
    return inside;
}

}  // namespace axg
