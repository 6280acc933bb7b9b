// SPDX-License-Identifier: Apache-2.0
// Intersects the edges of one triangle with the other's plane by linear equations that share their
// determinants, then tests that segment against the other's edges. Source: Tropp, Tal, Shimshoni,
// "A Fast Triangle to Triangle Intersection Test for Collision Detection", Computer Animation and
// Virtual Worlds 17(5), 2006, after its abstract; the equations are our own.

/// The segment start + s along, s in [0, 1], crosses an edge of a triangle of the same plane.
/// Skips parallel edges: the other two decide.
template <class T>
AXG_LAB_FUNCTION bool segment_crosses(const Point2<T>& start, const Point2<T>& along,
                                      const Point2<T>* t) {
    for (int i = 0; i < 3; ++i) {
        const Point2<T>&from = t[i], &to = t[(i + 1) % 3];
        const T ex = to.x - from.x, ey = to.y - from.y;
        const T wx = from.x - start.x, wy = from.y - start.y;
        const T determinant = along.x * ey - along.y * ex;
        if (determinant == T(0)) {
            continue;
        }
        const T on_edge = (along.y * wx - along.x * wy) / determinant;
        const T on_segment = (wx * ey - wy * ex) / determinant;
        if (on_edge >= T(0) && on_edge <= T(1) && on_segment >= T(0) && on_segment <= T(1)) {
            return true;
        }
    }
    return false;
}

/// Whether p is inside t or on an edge.
template <class T>
AXG_LAB_FUNCTION bool holds(const Point2<T>* t, const Point2<T>& p) {
    const T a = turn(t[0], t[1], p), b = turn(t[1], t[2], p), c = turn(t[2], t[0], p);
    return (a >= T(0) && b >= T(0) && c >= T(0)) || (a <= T(0) && b <= T(0) && c <= T(0));
}

/// Correct in exact arithmetic for triangles with area.
template <class T>
AXG_LAB_FUNCTION Verdict tropp(const Pair<T>& p) {
    const Vec3<T> n = cross(p.a[1] - p.a[0], p.a[2] - p.a[0]);
    // One determinant for each of three right sides: those of the other edges are differences.
    const T first = dot(n, p.b[0] - p.a[0]);
    const T along_q1 = dot(n, p.b[1] - p.b[0]), along_q2 = dot(n, p.b[2] - p.b[0]);
    Heights<T> h;
    h.d[0] = first;
    h.d[1] = first + along_q1;
    h.d[2] = first + along_q2;
    for (int i = 0; i < 3; ++i) {
        h.sign[i] = sign_of(h.d[i]);
    }
    if (h.on_one_side()) {
        return Verdict::separated;
    }
    if (h.in_plane()) {
        return verdict_of(!overlap_in_plane(p.a, p.b, n));
    }
    const int i = cut_off(h);
    Vec3<T> end[2];
    for (int e = 0; e < 2; ++e) {
        const int j = (i + 1 + e) % 3;
        const T share = h.d[i] / (h.d[i] - h.d[j]);
        end[e] = p.b[i] + share * (p.b[j] - p.b[i]);
    }
    const int k = steepest(n);
    const Point2<T> t[3] = {without(k, p.a[0]), without(k, p.a[1]), without(k, p.a[2])};
    const Point2<T> start = without(k, end[0]), last = without(k, end[1]);
    const Point2<T> along = {T(last.x - start.x), T(last.y - start.y)};
    // At a corner, rounding may miss both of its edges: test the ends of the segment as well.
    return verdict_of(!segment_crosses(start, along, t) && !holds(t, start) && !holds(t, last));
}
