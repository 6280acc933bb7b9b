// SPDX-License-Identifier: Apache-2.0
// Why the polyhedron contains the round body. Let c = cos(pi/n), and h(p) the distance of a point p
// of the plane from the axis as the regular n-gon measures it: the largest p.u over the n unit
// normals u of its sides. Then c |p| <= h(p) <= |p|. Turning an outline P' with rings of corners at
// radius rho / c gives {(p,z): (h(p),z) in P'}: h is linear in each sector, so the faces are flat.
// It contains {(p,z): (|p|,z) in P} if P' contains every (rho', z) with c rho <= rho' <= rho for
// some (rho, z) in P: P swept towards the axis. At one height, P is a row of intervals [a_i, b_i],
// a_i on walls that face the axis, b_i on walls that face away; swept, it is the union of the [c
// a_i, b_i]. P' is P with its inner walls drawn in by c. Its winding number at rho' is the number
// of b_i beyond rho' less the number of c a_i beyond: the number of the [c a_i, b_i] around rho',
// at least 1 on all of the sweep. If P' is a simple polygon, that means inside. If it is not (a
// groove in an end face, narrower than the error), refuse.
#include "core/mesh/solid_of_revolution.hpp"

#include <array>
#include <cmath>

#include "core/base/limits.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

// Exceeds the rounding of corners to float32 (2^-24 each) and of sine and cosine: walls are offset
// by this much more.
constexpr double kGuard = 1.0e-6;

struct Outline {
    std::array<Vec3d, 2 * kProfilePointsMax> point;  // x = radius, z = height
    std::array<double, 2 * kProfilePointsMax> ring;  // radius of its corners in the polyhedron
    std::uint32_t count = 0;

    void add(double radius, double height, double ring_radius) noexcept {
        point[count] = {radius, 0, height};
        ring[count] = ring_radius;
        ++count;
    }
};

double turn(Vec3d a, Vec3d b, Vec3d c) noexcept {
    return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
}

bool is_between(Vec3d a, Vec3d b, Vec3d p) noexcept {  // p on the line ab
    return std::fmin(a.x, b.x) <= p.x && p.x <= std::fmax(a.x, b.x) && std::fmin(a.z, b.z) <= p.z &&
           p.z <= std::fmax(a.z, b.z);
}

/// Do the closed segments ab and cd share a point?
bool meet(Vec3d a, Vec3d b, Vec3d c, Vec3d d) noexcept {
    const double c_side = turn(a, b, c), d_side = turn(a, b, d);
    const double a_side = turn(c, d, a), b_side = turn(c, d, b);
    if (((c_side > 0 && d_side < 0) || (c_side < 0 && d_side > 0)) &&
        ((a_side > 0 && b_side < 0) || (a_side < 0 && b_side > 0))) {
        return true;
    }
    return (c_side == 0 && is_between(a, b, c)) || (d_side == 0 && is_between(a, b, d)) ||
           (a_side == 0 && is_between(c, d, a)) || (b_side == 0 && is_between(c, d, b));
}

/// Index of the first edge that meets another one where it should not; count when the outline is
/// simple. Only the ends are on the axis, so the closing edge along it meets nothing.
std::uint32_t first_crossing(std::span<const Vec3d> p) noexcept {
    const auto edges = static_cast<std::uint32_t>(p.size() - 1);
    for (std::uint32_t i = 0; i < edges; ++i) {
        if (i + 1 < edges) {  // the next edge may not fold back
            const bool folds = turn(p[i], p[i + 1], p[i + 2]) == 0 &&
                               dot(p[i + 1] - p[i], p[i + 2] - p[i + 1]) < 0;
            if (folds) {
                return i;
            }
        }
        for (std::uint32_t k = i + 2; k < edges; ++k) {
            if (meet(p[i], p[i + 1], p[k], p[k + 1])) {
                return i;
            }
        }
    }
    return edges + 1;
}

/// Rounds the points to float32, orders them from the bottom of the axis up the outside, and drops
/// flat middle points.
RevolutionStatus read_profile(std::span<const Vec3d> profile, Outline& out, std::uint32_t& at) {
    const auto count = static_cast<std::uint32_t>(profile.size());
    at = 0;
    if (profile.size() < 3 || profile.size() > kProfilePointsMax) {
        return RevolutionStatus::bad_point_count;
    }
    std::array<Vec3d, kProfilePointsMax> p;
    for (at = 0; at < count; ++at) {
        const Vec3d q = profile[at];
        if (!(q.x >= 0 && q.x <= kCoordinateMmMax && std::fabs(q.z) <= kCoordinateMmMax)) {
            return RevolutionStatus::bad_point;
        }
        p[at] = {static_cast<double>(static_cast<float>(q.x)), 0,
                 static_cast<double>(static_cast<float>(q.z))};
        const bool is_end = at == 0 || at + 1 == count;
        if (is_end != (p[at].x == 0)) {
            return is_end ? RevolutionStatus::ends_off_axis : RevolutionStatus::touches_axis;
        }
        if (at > 0 && p[at] == p[at - 1]) {
            return RevolutionStatus::repeated_point;
        }
    }
    at = count - 1;
    if (p[0] == p[count - 1]) {
        return RevolutionStatus::repeated_point;
    }
    const std::uint32_t crossing = first_crossing(std::span(p.data(), count));
    if (crossing <= count - 1) {
        at = crossing;
        return RevolutionStatus::crosses_itself;
    }
    double twice_area = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3d a = p[i], b = p[(i + 1) % count];
        twice_area += a.x * b.z - a.z * b.x;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3d q = p[twice_area > 0 ? i : count - 1 - i];
        const bool is_middle = out.count >= 2 && out.point[out.count - 1].z == q.z &&
                               out.point[out.count - 2].z == q.z;
        if (is_middle) {
            --out.count;
        }
        out.add(q.x, q.z, q.x);
    }
    return RevolutionStatus::ok;
}

/// P' of the proof, with the radius of the corners: outer walls r / c, inner walls (c r) / c = r,
/// less and more the guard.
Outline sweep_inwards(const Outline& p, double c) noexcept {
    Outline out;
    out.add(0, p.point[0].z, 0);
    for (std::uint32_t i = 1; i + 1 < p.count; ++i) {
        const Vec3d q = p.point[i];
        const double before = q.z - p.point[i - 1].z, after = p.point[i + 1].z - q.z;
        const bool is_inner_before = before < 0 || (before == 0 && after < 0);
        const bool is_inner_after = after < 0 || (after == 0 && before < 0);
        for (const bool is_inner : {is_inner_before, is_inner_after}) {
            if (is_inner) {
                out.add(q.x * c * (1 - kGuard), q.z, q.x * (1 - kGuard));
            } else {
                out.add(q.x * (1 + kGuard), q.z, q.x / c * (1 + kGuard));
            }
            if (is_inner_before == is_inner_after) {
                break;  // one corner is enough
            }
        }
    }
    out.add(0, p.point[p.count - 1].z, 0);
    return out;
}

Vec3f corner(const Outline& outline, std::uint32_t point, std::span<const SinCos> circle,
             std::uint32_t k) noexcept {
    const double radius = outline.ring[point];
    return {static_cast<float>(radius * circle[k].cos), static_cast<float>(radius * circle[k].sin),
            static_cast<float>(outline.point[point].z)};
}

}  // namespace

RevolutionResult solid_of_revolution(std::span<const Vec3d> profile, std::uint32_t segments) {
    RevolutionResult result;
    if (segments < kProfileSegmentsMin || segments > kProfileSegmentsMax) {
        result.status = RevolutionStatus::bad_segments;
        return result;
    }
    Outline given;
    result.status = read_profile(profile, given, result.point);
    if (result.status != RevolutionStatus::ok) {
        return result;
    }
    const double n = static_cast<double>(segments);
    const Outline outline = sweep_inwards(given, sin_cos(kPi / n).cos);
    const std::uint32_t crossing = first_crossing(std::span(outline.point.data(), outline.count));
    if (crossing <= outline.count - 1) {
        result.status = RevolutionStatus::groove_too_narrow;
        result.point = 0;  // points were dropped and doubled: no index applies
        return result;
    }
    result.point = 0;
    std::array<SinCos, kProfileSegmentsMax> circle;
    for (std::uint32_t k = 0; k < segments; ++k) {
        circle[k] = sin_cos(2.0 * kPi * static_cast<double>(k) / n);
    }
    for (std::uint32_t i = 0; i + 1 < outline.count; ++i) {
        for (std::uint32_t k = 0; k < segments; ++k) {
            const std::uint32_t next = (k + 1) % segments;
            const Vec3f a = corner(outline, i, circle, k), b = corner(outline, i, circle, next);
            const Vec3f c = corner(outline, i + 1, circle, next);
            const Vec3f d = corner(outline, i + 1, circle, k);
            if (i > 0) {  // the lower ring is one point at the start
                result.triangles.push_back({a, b, c});
            }
            if (i + 2 < outline.count) {  // and the upper one at the end
                result.triangles.push_back({a, c, d});
            }
        }
    }
    return result;
}

}  // namespace axg
