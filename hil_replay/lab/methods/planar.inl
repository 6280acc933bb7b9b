// SPDX-License-Identifier: Apache-2.0
// Triangles of one plane, projected by dropping the coordinate in which the plane is steepest.

template <class T>
struct Point2 {
    T x, y;
};

/// Index of the largest component by size: the coordinate to drop.
template <class T>
AXG_LAB_FUNCTION int steepest(const Vec3<T>& n) {
    const T x = size_of(n.x), y = size_of(n.y), z = size_of(n.z);
    return x >= y && x >= z ? 0 : (y >= z ? 1 : 2);
}

template <class T>
AXG_LAB_FUNCTION Point2<T> without(int k, const Vec3<T>& v) {
    return k == 0 ? Point2<T>{v.y, v.z} : (k == 1 ? Point2<T>{v.z, v.x} : Point2<T>{v.x, v.y});
}

template <class T>
AXG_LAB_FUNCTION T component(int k, const Vec3<T>& v) {
    return k == 0 ? v.x : (k == 1 ? v.y : v.z);
}

/// Twice the area of a, b, c; positive counter-clockwise.
template <class T>
AXG_LAB_FUNCTION T turn(const Point2<T>& a, const Point2<T>& b, const Point2<T>& c) {
    return (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
}

/// Whether two segments that are not parallel share a point. Source: Antonio, Graphics Gems III, as
/// in Moller 1997.
template <class T>
AXG_LAB_FUNCTION bool edges_cross(const Point2<T>& a, const Point2<T>& b, const Point2<T>& c,
                                  const Point2<T>& d) {
    const T ux = b.x - a.x, uy = b.y - a.y, vx = c.x - d.x, vy = c.y - d.y;
    const T wx = a.x - c.x, wy = a.y - c.y;
    const T f = uy * vx - ux * vy;
    const T s = vy * wx - vx * wy, t = ux * wy - uy * wx;
    return (f > T(0) && s >= T(0) && s <= f && t >= T(0) && t <= f) ||
           (f < T(0) && s <= T(0) && s >= f && t <= T(0) && t >= f);
}

/// Whether p is strictly inside t: the caller has tested the edges before.
template <class T>
AXG_LAB_FUNCTION bool is_inside(const Point2<T>& p, const Point2<T>* t) {
    const T a = turn(t[0], t[1], p), b = turn(t[1], t[2], p), c = turn(t[2], t[0], p);
    return (a > T(0) && b > T(0) && c > T(0)) || (a < T(0) && b < T(0) && c < T(0));
}

/// Tests every edge against every edge, then a vertex of each against the other triangle.
template <class T>
AXG_LAB_FUNCTION bool overlap_in_plane(const Vec3<T>* a, const Vec3<T>* b, const Vec3<T>& n) {
    const int k = steepest(n);
    const Point2<T> p[3] = {without(k, a[0]), without(k, a[1]), without(k, a[2])};
    const Point2<T> q[3] = {without(k, b[0]), without(k, b[1]), without(k, b[2])};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (edges_cross(p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3])) {
                return true;
            }
        }
    }
    return is_inside(p[0], q) || is_inside(q[0], p);
}
