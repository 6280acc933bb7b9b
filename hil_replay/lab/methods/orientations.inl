// SPDX-License-Identifier: Apache-2.0
// A tree of orientation signs. Source: Guigue and Devillers, "Fast and Robust Triangle-Triangle
// Overlap Test Using Orientation Predicates", Journal of Graphics Tools 8(1), 2003: the first
// vertex of each triangle is the one that is alone on its side of the other's plane; two signs then
// compare the intervals. Each sign is of degree three. A wrong sign leads into a wrong leaf.

/// Positive where d is on the side of the normal of a, b, c.
template <class T>
AXG_LAB_FUNCTION T orientation(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c,
                               const Vec3<T>& d) {
    return dot(d - a, cross(b - a, c - a));
}

/// Which vertex is alone on its side, and whether that side is the negative one; -1: all are in the
/// plane. Precondition: not all strictly on one side.
struct Alone {
    int vertex;
    bool negative;
};

AXG_LAB_FUNCTION Alone alone(const int* sign) {
    int positive = 0, negative = 0;
    for (int i = 0; i < 3; ++i) {
        positive += sign[i] > 0 ? 1 : 0;
        negative += sign[i] < 0 ? 1 : 0;
    }
    const bool below = positive == 2 || (positive == 0 && negative == 1);
    const int other = positive == 2 ? 1 : -1;  // of the pair that is together
    for (int i = 0; i < 3; ++i) {
        const bool found = positive == 2 || negative == 2 ? sign[i] != other
                           : positive == 1                ? sign[i] > 0
                                                          : sign[i] < 0;
        if (found) {
            return {i, below};
        }
    }
    return {-1, false};
}

/// Case of p1 beyond a corner of the second triangle, both counter-clockwise: the decision tree of
/// the paper's figure for that region.
template <class T>
AXG_LAB_FUNCTION bool meets_at_corner(const Point2<T>& p1, const Point2<T>& q1, const Point2<T>& r1,
                                      const Point2<T>& p2, const Point2<T>& q2,
                                      const Point2<T>& r2) {
    const T zero = T(0);
    if (turn(r2, p2, q1) >= zero) {
        if (turn(r2, q2, q1) <= zero) {
            if (turn(p1, p2, q1) > zero) {
                return turn(p1, q2, q1) <= zero;
            }
            return turn(p1, p2, r1) >= zero && turn(q1, r1, p2) >= zero;
        }
        return turn(p1, q2, q1) <= zero && turn(r2, q2, r1) <= zero && turn(q1, r1, q2) >= zero;
    }
    if (turn(r2, p2, r1) < zero) {
        return false;
    }
    if (turn(q1, r1, r2) >= zero) {
        return turn(p1, p2, r1) >= zero;
    }
    return turn(q1, r1, q2) >= zero && turn(r2, r1, q2) >= zero;
}

/// Case of p1 beyond the side from r2 to p2.
template <class T>
AXG_LAB_FUNCTION bool meets_at_side(const Point2<T>& p1, const Point2<T>& q1, const Point2<T>& r1,
                                    const Point2<T>& p2, const Point2<T>& r2) {
    const T zero = T(0);
    if (turn(r2, p2, q1) >= zero) {
        if (turn(p1, p2, q1) >= zero) {
            return turn(p1, q1, r2) >= zero;
        }
        return turn(q1, r1, p2) >= zero && turn(r1, p1, p2) >= zero;
    }
    return turn(r2, p2, r1) >= zero && turn(p1, p2, r1) >= zero &&
           (turn(p1, r1, r2) >= zero || turn(q1, r1, r2) >= zero);
}

/// Finds the side or corner of b beyond which the first vertex of a is, then runs the tree of that
/// region. Precondition: both are counter-clockwise.
template <class T>
AXG_LAB_FUNCTION bool meet_in_plane(const Point2<T>* a, const Point2<T>* b) {
    bool inner[3];
    int count = 0, outer = 0, only = 0;
    for (int i = 0; i < 3; ++i) {
        inner[i] = turn(b[i], b[(i + 1) % 3], a[0]) >= T(0);
        count += inner[i] ? 1 : 0;
        outer = inner[i] ? outer : i;
        only = inner[i] ? i : only;
    }
    if (count == 3) {
        return true;
    }
    if (count == 2) {  // beyond the side `outer`, from its first corner to the next
        return meets_at_side(a[0], a[1], a[2], b[(outer + 1) % 3], b[outer]);
    }
    // Beyond the corner that the one inner side does not touch.
    return meets_at_corner(a[0], a[1], a[2], b[only], b[(only + 1) % 3], b[(only + 2) % 3]);
}

template <class T>
AXG_LAB_FUNCTION Verdict coplanar_orientations(const Pair<T>& p, const Vec3<T>& n) {
    const int k = steepest(n);
    Point2<T> a[3], b[3];
    for (int i = 0; i < 3; ++i) {
        a[i] = without(k, p.a[i]);
        b[i] = without(k, p.b[i]);
    }
    for (Point2<T>* t : {a, b}) {
        if (turn(t[0], t[1], t[2]) < T(0)) {
            const Point2<T> second = t[1];
            t[1] = t[2];
            t[2] = second;
        }
    }
    return verdict_of(!meet_in_plane(a, b));
}

/// Both triangles turned so that the lone vertex is first, and each so ordered that the other's
/// lone vertex is on its positive side; or coplanar.
template <class T>
struct Turned {
    Vec3<T> p1, q1, r1, p2, q2, r2;
    bool coplanar;
};

template <class T>
AXG_LAB_FUNCTION Turned<T> turned(const Pair<T>& p, const int* side_a, const int* side_b) {
    const Alone a = alone(side_a), b = alone(side_b);
    if (a.vertex < 0 || b.vertex < 0) {
        return {p.a[0], p.a[1], p.a[2], p.b[0], p.b[1], p.b[2], true};
    }
    return {p.a[a.vertex],
            p.a[(a.vertex + (b.negative ? 2 : 1)) % 3],
            p.a[(a.vertex + (b.negative ? 1 : 2)) % 3],
            p.b[b.vertex],
            p.b[(b.vertex + (a.negative ? 2 : 1)) % 3],
            p.b[(b.vertex + (a.negative ? 1 : 2)) % 3],
            false};
}

AXG_LAB_FUNCTION bool on_one_side(const int* sign) {
    return sign[0] != 0 && sign[0] == sign[1] && sign[0] == sign[2];
}

/// Correct in exact arithmetic for triangles with area.
template <class T>
AXG_LAB_FUNCTION Verdict guigue_devillers(const Pair<T>& p) {
    int side_a[3], side_b[3];
    for (int i = 0; i < 3; ++i) {
        side_a[i] = sign_of(orientation(p.b[0], p.b[1], p.b[2], p.a[i]));
    }
    if (on_one_side(side_a)) {
        return Verdict::separated;
    }
    for (int i = 0; i < 3; ++i) {
        side_b[i] = sign_of(orientation(p.a[0], p.a[1], p.a[2], p.b[i]));
    }
    if (on_one_side(side_b)) {
        return Verdict::separated;
    }
    const Turned<T> t = turned(p, side_a, side_b);
    if (t.coplanar) {
        return coplanar_orientations(p, cross(p.a[1] - p.a[0], p.a[2] - p.a[0]));
    }
    return verdict_of(orientation(t.p1, t.q1, t.p2, t.q2) > T(0) ||
                      orientation(t.p1, t.r1, t.r2, t.p2) > T(0));
}

/// Which way two lines pass one another: their signed distance times the sine of their angle and
/// the lengths of the edges.
template <class T>
AXG_LAB_FUNCTION T passing(const Vec3<T>& p, const Vec3<T>& q, const Vec3<T>& r, const Vec3<T>& s) {
    return dot(r - p, cross(q - p, s - r));
}

/// Signed distances of vertices from planes, then of two pairs of lines. Source: Shen, Heng, Tang,
/// "A Fast Triangle-Triangle Overlap Test Using Signed Distances", Journal of Graphics Tools 8(1),
/// 2003, after its abstract: vertices are ordered as by Guigue and Devillers. Correct in exact
/// arithmetic for triangles with area.
template <class T>
AXG_LAB_FUNCTION Verdict shen(const Pair<T>& p) {
    const Vec3<T> n = cross(p.a[1] - p.a[0], p.a[2] - p.a[0]);
    const Vec3<T> m = cross(p.b[1] - p.b[0], p.b[2] - p.b[0]);
    const T of_n = dot(n, p.a[0]), of_m = dot(m, p.b[0]);
    int side_a[3], side_b[3];
    for (int i = 0; i < 3; ++i) {
        side_b[i] = sign_of(T(dot(n, p.b[i]) - of_n));
    }
    if (on_one_side(side_b)) {
        return Verdict::separated;
    }
    for (int i = 0; i < 3; ++i) {
        side_a[i] = sign_of(T(dot(m, p.a[i]) - of_m));
    }
    if (on_one_side(side_a)) {
        return Verdict::separated;
    }
    const Turned<T> t = turned(p, side_a, side_b);
    if (t.coplanar) {
        return verdict_of(!overlap_in_plane(p.a, p.b, n));
    }
    return verdict_of(passing(t.p1, t.q1, t.p2, t.q2) < T(0) ||
                      passing(t.p1, t.r1, t.p2, t.r2) > T(0));
}
