// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/near_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/collision/certified_within.hpp"

namespace axg {
namespace {

constexpr std::size_t kLinearAxesMax = 6;

using Point = sat::V3<double>;
using Corners = std::array<Point, 3>;

Corners corners_of(const Triangle& t, const Pose& pose) noexcept {
    Corners out;
    const std::array<Vec3f, 3> corners{t.a, t.b, t.c};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d p = apply(pose, widen(corners[i]));
        out[i] = {p.x, p.y, p.z};
    }
    return out;
}

/// The point of the line from p to q that is on the plane of the face, kept between them.
Point crossing(const Corners& face, const Point& p, const Point& q) noexcept {
    const Point n = sat::cross3(sat::sub(face[1], face[0]), sat::sub(face[2], face[0]));
    const double from = sat::dot3(n, sat::sub(p, face[0]));
    const double to = sat::dot3(n, sat::sub(q, face[0]));
    const double s = from == to ? 0 : std::clamp(from / (from - to), 0.0, 1.0);
    return {p.x + s * (q.x - p.x), p.y + s * (q.y - p.y), p.z + s * (q.z - p.z)};
}

/// Squared distance from some point of the face to corners of the other triangle, and to where its
/// edges cross the plane: 0 where they pierce the face.
double from_face_square(const Corners& face, const Corners& other) noexcept {
    const Point e1 = sat::sub(face[1], face[0]), e2 = sat::sub(face[2], face[0]);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        for (const Point& q : {other[i], crossing(face, other[i], other[(i + 1) % 3])}) {
            const Point d = sat::from_face(face[0], e1, e2, q);
            least = std::min(least, sat::dot3(d, d));
        }
    }
    return least;
}

BodyExtent extent_of(const Triangle& t) noexcept {
    const Vec3d a = widen(t.a), b = widen(t.b), c = widen(t.c);
    BodyExtent out;
    out.low_mm = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    out.high_mm = {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
    out.middle_mm = 0.5 * (out.low_mm + out.high_mm);
    for (const Vec3d& p : {a, b, c}) {
        const Vec3d d = p - out.middle_mm;
        out.radius_mm = std::max(out.radius_mm, std::sqrt(dot(d, d)) * (1 + 0x1p-40));
    }
    return out;
}

}  // namespace

double near_points_mm(const Triangle& a, const Triangle& b, const Pose& pose) noexcept {
    const Corners p = corners_of(a, pose), q = corners_of(b, Pose{});
    double least = std::min(from_face_square(p, q), from_face_square(q, p));
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Point d = sat::between_segments(p[i], sat::sub(p[(i + 1) % 3], p[i]), q[k],
                                                  sat::sub(q[(k + 1) % 3], q[k]));
            least = std::min(least, sat::dot3(d, d));
        }
    }
    // Every witness is the difference of a point of each triangle, but for a few roundings of their
    // coordinates: much less than the error of a placement.
    return std::sqrt(least) + 2 * kPlacementErrorMm;
}

NearBox::NearBox(const Machine& machine, const JointBoxTask& task, const JointBox& box)
    : machine_(machine), task_(task), box_(box) {
    std::vector<std::uint32_t> linear;
    for (std::uint32_t k = 0; k < task.path.count; ++k) {
        const std::uint32_t axis = machine.bodies[task.path.body[k]].joint.axis;
        if (machine.axes[axis].kind == AxisKind::rotary) {
            turns_[axis] = box.half[axis];
        } else if (box.half[axis] > 0 &&
                   std::find(linear.begin(), linear.end(), axis) == linear.end()) {
            linear.push_back(axis);
            longest_axis_ = longest_axis_ == kNoIndex || box.half[axis] > box.half[longest_axis_]
                                ? axis
                                : longest_axis_;
        }
    }
    move_bodies(machine, box.centre, moved_);
    if (linear.size() > kLinearAxesMax) {
        return;
    }
    std::array<Pose, kBodiesMax> moved;
    for (std::uint32_t corner = 0; corner < 1U << linear.size(); ++corner) {
        std::array<double, kAxesMax> at = box.centre;
        for (std::size_t i = 0; i < linear.size(); ++i) {
            const double half = box.half[linear[i]];
            at[linear[i]] += (corner >> i & 1U) != 0 ? half : -half;
        }
        move_bodies(machine, at, moved);
        const PlacedPair pair = placed_pair(task, moved);
        corners_.push_back(relative_pose(pair.a.placed, pair.b.placed));
    }
}

NearBound NearBox::bound(const Triangle& a, const Triangle& b) const {
    if (corners_.empty()) {
        return {std::numeric_limits<double>::infinity(), longest_axis_};
    }
    const BodyExtent extent_a = extent_of(a), extent_b = extent_of(b);
    PlacedPair pair = placed_pair(task_, moved_);
    pair.a.extent = &extent_a;
    pair.b.extent = &extent_b;
    const PathLevers levers = levers_over(machine_, task_.path, moved_, pair.a, pair.b, box_);
    const PathMotion turn = motion_by(machine_, task_.path, levers, turns_);
    double most = 0;
    for (const Pose& pose : corners_) {
        most = std::max(most, near_points_mm(a, b, pose));
    }
    // The poses at the corners are rounded: their error is in near_points_mm.
    return {most + turn.total_mm, most > turn.total_mm ? longest_axis_ : turn.widest_axis};
}

}  // namespace axg
