// SPDX-License-Identifier: Apache-2.0
// The seed paper's 6-or-11 test of two triangles as it is usually programmed: the normals; then six
// axes in the plane if the normals are parallel within a threshold, else nine products of edges. In
// float without a bound of the rounding. For comparison only: it proves nothing. The formula is the
// laboratory's paper-6-11 (tests/property/cuda/paper/paper_formula_test.cpp compares them), with
// loops over axes rolled or unrolled, and with the separating axis. Compiled by g++ and nvcc. mm.
// Source: Siao, Lin, Chien, Chang, "Paralleling Collision Detection on Five-Axis Machining", 2021;
// the threshold is that of Eberly, Geometric Tools.
#pragma once

#include "core/base/host_device.hpp"
#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"
#include "core/mesh/mesh.hpp"

// How often the device code repeats the body of a loop over axes; g++ decides by itself.
#if defined(__CUDA_ARCH__)
#define AXG_PAPER_LOOP _Pragma("unroll (kUnroll ? 9 : 1)")
#else
#define AXG_PAPER_LOOP
#endif

namespace axg::paper {

/// Numbers of the axes: 0 and 1 the normals, 2 + 3 i + j the products of edges, 11 + i and 14 + i
/// the normals of the edges in either plane.
inline constexpr unsigned kAxes = 17, kNoAxis = 255;

/// A pose in float: R row by row, t.
struct FloatPose {
    float r[3][3], t[3];
};

AXG_HD FloatPose rounded(const Pose& p) noexcept {
    FloatPose f;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            f.r[i][j] = static_cast<float>(p.r[i][j]);
        }
        f.t[i] = static_cast<float>(p.t[i]);
    }
    return f;
}

AXG_HD Vec3f moved(const FloatPose& p, const Vec3f& v) noexcept {
    return {((p.r[0][0] * v.x + p.r[0][1] * v.y) + p.r[0][2] * v.z) + p.t[0],
            ((p.r[1][0] * v.x + p.r[1][1] * v.y) + p.r[1][2] * v.z) + p.t[1],
            ((p.r[2][0] * v.x + p.r[2][1] * v.y) + p.r[2][2] * v.z) + p.t[2]};
}

AXG_HD Triangle moved(const FloatPose& p, const Triangle& t) noexcept {
    return {moved(p, t.a), moved(p, t.b), moved(p, t.c)};
}

AXG_HD float least(float a, float b) noexcept {
    return a < b ? a : b;
}
AXG_HD float most(float a, float b) noexcept {
    return a > b ? a : b;
}

/// A pair less a's first vertex, with its edges.
struct EdgedPair {
    Vec3f a[3], b[3], ea[3], eb[3];
};

AXG_HD EdgedPair edged(const Triangle& a, const Triangle& b) noexcept {
    EdgedPair s;
    s.a[0] = a.a - a.a, s.a[1] = a.b - a.a, s.a[2] = a.c - a.a;
    s.b[0] = b.a - a.a, s.b[1] = b.b - a.a, s.b[2] = b.c - a.a;
    s.ea[0] = s.a[1] - s.a[0], s.ea[1] = s.a[2] - s.a[1], s.ea[2] = s.a[0] - s.a[2];
    s.eb[0] = s.b[1] - s.b[0], s.eb[1] = s.b[2] - s.b[1], s.eb[2] = s.b[0] - s.b[2];
    return s;
}

AXG_HD bool apart_along(const EdgedPair& s, const Vec3f& l) noexcept {
    const float a0 = dot(l, s.a[0]), a1 = dot(l, s.a[1]), a2 = dot(l, s.a[2]);
    const float b0 = dot(l, s.b[0]), b1 = dot(l, s.b[1]), b2 = dot(l, s.b[2]);
    const float above = least(least(b0, b1), b2) - most(most(a0, a1), a2);
    const float below = least(least(a0, a1), a2) - most(most(b0, b1), b2);
    return most(above, below) > 0.0F;
}

/// Selects one of three by comparisons: an array indexed at run time would be in local memory.
AXG_HD float picked(float a, float b, float c, unsigned i) noexcept {
    return i == 0 ? a : i == 1 ? b : c;
}
AXG_HD Vec3f picked(const Vec3f (&of)[3], unsigned i) noexcept {
    return {picked(of[0].x, of[1].x, of[2].x, i), picked(of[0].y, of[1].y, of[2].y, i),
            picked(of[0].z, of[1].z, of[2].z, i)};
}

/// Whether a pair is apart along the axis of this number. Any vector may be tried, so the one that
/// separated the pair at an earlier pose is worth trying first.
AXG_HD bool apart_along_axis(const EdgedPair& s, unsigned axis) noexcept {
    const bool is_product = axis >= 2 && axis < 11, of_b = axis == 1 || axis >= 14;
    const Vec3f n = of_b ? cross(s.eb[0], s.eb[1]) : cross(s.ea[0], s.ea[1]);
    if (axis < 2) {
        return apart_along(s, n);
    }
    const unsigned place = is_product ? (axis - 2) / 3 : (axis - 11) % 3;
    const Vec3f edge = of_b ? picked(s.eb, place) : picked(s.ea, place);
    return apart_along(s, cross(edge, is_product ? picked(s.eb, (axis - 2) % 3) : n));
}

/// Tests the axes of one kind in turn. Returns the first that separates; kNoAxis: none does.
template <bool kUnroll>
AXG_HD unsigned separating_product(const EdgedPair& s) noexcept {
    AXG_PAPER_LOOP
    for (int k = 0; k < 9; ++k) {
        if (apart_along(s, cross(s.ea[k / 3], s.eb[k % 3]))) {
            return static_cast<unsigned>(2 + k);
        }
    }
    return kNoAxis;
}

template <bool kUnroll>
AXG_HD unsigned separating_in_plane(const EdgedPair& s, const Vec3f& n, const Vec3f& m) noexcept {
    AXG_PAPER_LOOP
    for (int k = 0; k < 6; ++k) {
        if (apart_along(s, k < 3 ? cross(s.ea[k % 3], n) : cross(s.eb[k % 3], m))) {
            return static_cast<unsigned>(11 + k);
        }
    }
    return kNoAxis;
}

/// The number of an axis that separates; kNoAxis: the pair counts as touching.
template <bool kUnroll>
AXG_HD unsigned separating_axis(const EdgedPair& s) noexcept {
    const Vec3f n = cross(s.ea[0], s.ea[1]), m = cross(s.eb[0], s.eb[1]);
    if (apart_along(s, n)) {
        return 0;
    }
    if (apart_along(s, m)) {
        return 1;
    }
    const Vec3f nm = cross(n, m);
    const bool parallel = dot(nm, nm) <= 1e-6F * (dot(n, n) * dot(m, m));
    return parallel ? separating_in_plane<kUnroll>(s, n, m) : separating_product<kUnroll>(s);
}

}  // namespace axg::paper
