// SPDX-License-Identifier: Apache-2.0
// Tests every edge of each triangle against the other one. Source: Moller and Trumbore, "Fast,
// Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997, with its
// threshold on the determinant.

template <class T>
AXG_LAB_FUNCTION bool segment_pierces(const Vec3<T>& from, const Vec3<T>& to, const Vec3<T>* t) {
    const Vec3<T> along = to - from, e = t[1] - t[0], f = t[2] - t[0];
    const Vec3<T> h = cross(along, f);
    const T determinant = dot(e, h);
    if (size_of(determinant) <= tolerance<T>(1e-6, 1e-6)) {
        return false;  // as published: a segment parallel to the plane, or in it, never hits
    }
    const Vec3<T> w = from - t[0];
    const T u = dot(w, h) / determinant;
    if (u < T(0) || u > T(1)) {
        return false;
    }
    const Vec3<T> g = cross(w, e);
    const T v = dot(along, g) / determinant;
    if (v < T(0) || u + v > T(1)) {
        return false;
    }
    const T at = dot(f, g) / determinant;
    return at >= T(0) && at <= T(1);
}

/// Correct in exact arithmetic for triangles with area that are not in one plane; always calls
/// coplanar ones separated.
template <class T>
AXG_LAB_FUNCTION Verdict six_segment(const Pair<T>& p) {
    for (int i = 0; i < 3; ++i) {
        if (segment_pierces(p.a[i], p.a[(i + 1) % 3], p.b) ||
            segment_pierces(p.b[i], p.b[(i + 1) % 3], p.a)) {
            return Verdict::intersecting;
        }
    }
    return Verdict::separated;
}
