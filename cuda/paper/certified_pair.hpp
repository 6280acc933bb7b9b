// SPDX-License-Identifier: Apache-2.0
// The certified test for every pair of triangles of two bodies without exception: its constants and
// its stages. The brute force on the CPU and on the GPU uses the same lines. Source:
// docs/theory/accuracy.md, sections 4 and 10; the origin is within 1.74 rho_A of t, as section 4
// requires. mm.
#pragma once

#include "core/base/host_device.hpp"
#include "core/base/pose.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/pair_test.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::paper {

/// A query about two bodies, r = 0.
struct CertifiedPose {
    Pose pose;   // a's frame to b's
    float d32;   // d of the theorem, float
    double d64;  // and for the recheck
};

/// @param reach_a, reach_b  largest |coordinate| of either body, mm
[[nodiscard]] inline CertifiedPose certified_pose(const Pose& pose, float reach_a,
                                                  float reach_b) noexcept {
    double t = 0;
    for (const double x : pose.t) {
        t = lanes::max(t, lanes::abs(x));
    }
    const double coordinate_mm = t + 3.0 * double(reach_a) + 2.0 * double(reach_b) + 0x1p-40;
    const double error_mm = 0x1p-50 * coordinate_mm;
    const auto d32 = static_cast<float>(0x1p21 * error_mm * (1.0 + 0x1p-22));
    return {pose, d32 + 0x1p-90F, 0x1p50 * error_mm * (1.0 + 0x1p-50)};
}

/// One coordinate of a point of a in b's frame less an origin, double.
AXG_HD double moved_less(const Pose& p, int k, const Vec3f& v, double origin) noexcept {
    return lanes::fma(
        p.r[k][0], double(v.x),
        lanes::fma(p.r[k][1], double(v.y), lanes::fma(p.r[k][2], double(v.z), p.t[k] - origin)));
}

/// The origin of a tile: its first vertex in b's frame, rounded to float.
AXG_HD Vec3f origin_of(const Pose& p, const Triangle& first) noexcept {
    return {static_cast<float>(moved_less(p, 0, first.a, 0)),
            static_cast<float>(moved_less(p, 1, first.a, 0)),
            static_cast<float>(moved_less(p, 2, first.a, 0))};
}

AXG_HD sat::V3<float> moved_vertex(const Pose& p, const Vec3f& v, const Vec3f& o) noexcept {
    return {static_cast<float>(moved_less(p, 0, v, double(o.x))),
            static_cast<float>(moved_less(p, 1, v, double(o.y))),
            static_cast<float>(moved_less(p, 2, v, double(o.z)))};
}

AXG_HD sat::V3<float> less_origin(const Vec3f& v, const Vec3f& o) noexcept {
    return {v.x - o.x, v.y - o.y, v.z - o.z};
}

/// Tests a pair that the shared axes left undecided: each axis by itself, in float.
AXG_HD bool left_is_apart_in_float(const CertifiedPose& q, const Triangle& a, const Triangle& b,
                                   const Vec3f& origin) noexcept {
    const Vec3f va[3] = {a.a, a.b, a.c}, vb[3] = {b.a, b.b, b.c};
    sat::V3<float> fa[3], fb[3];
    for (int i = 0; i < 3; ++i) {
        fa[i] = moved_vertex(q.pose, va[i], origin);
        fb[i] = less_origin(vb[i], origin);
    }
    return sat::separated_17<false>(sat::scaled_pair(fa, fb, q.d32), 0.0F);
}

/// The same pair of un-rounded vertices, for the test in double.
AXG_HD sat::TrianglePair<double> left_in_double(const CertifiedPose& q, const Triangle& a,
                                                const Triangle& b, const Vec3f& origin) noexcept {
    const Vec3f va[3] = {a.a, a.b, a.c}, vb[3] = {b.a, b.b, b.c};
    sat::V3<double> da[3], db[3];
    const double o[3] = {double(origin.x), double(origin.y), double(origin.z)};
    for (int i = 0; i < 3; ++i) {
        da[i] = {moved_less(q.pose, 0, va[i], o[0]), moved_less(q.pose, 1, va[i], o[1]),
                 moved_less(q.pose, 2, va[i], o[2])};
        db[i] = {double(vb[i].x) - o[0], double(vb[i].y) - o[1], double(vb[i].z) - o[2]};
    }
    return sat::scaled_pair(da, db, q.d64);
}

/// The same test in float, then the test in double of un-rounded vertices.
AXG_HD bool left_is_apart(const CertifiedPose& q, const Triangle& a, const Triangle& b,
                          const Vec3f& origin) noexcept {
    return left_is_apart_in_float(q, a, b, origin) ||
           sat::apart_in_double<false>(left_in_double(q, a, b, origin), 0.0);
}

}  // namespace axg::paper
