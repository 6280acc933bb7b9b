// SPDX-License-Identifier: Apache-2.0
// Cuts triangles with the other's plane, then compares both cuts on the common line (Moller), or
// one cut with the other triangle in its plane (Held).
// Sources: Moller, "A Fast Triangle-Triangle Intersection Test", Journal of Graphics Tools 2(2),
// 1997; Held, "ERIT: A Collection of Efficient and Reliable Intersection Tests", Journal of
// Graphics Tools 2(4), 1997.

/// Plane values of three vertices, and their signs. As published, small values count as zero: the
/// threshold on the unnormalised value is absolute, so the distance depends on the triangle.
template <class T>
struct Heights {
    T d[3];
    int sign[3];

    [[nodiscard]] AXG_LAB_FUNCTION bool on_one_side() const {
        return sign[0] != 0 && sign[0] == sign[1] && sign[0] == sign[2];
    }
    [[nodiscard]] AXG_LAB_FUNCTION bool in_plane() const {
        return sign[0] == 0 && sign[1] == 0 && sign[2] == 0;
    }
};

template <class T>
AXG_LAB_FUNCTION Heights<T> heights_over(const Vec3<T>& n, const T& offset, const Vec3<T>* v) {
    Heights<T> h;
    for (int i = 0; i < 3; ++i) {
        h.d[i] = dot(n, v[i]) + offset;
        if (size_of(h.d[i]) < tolerance<T>(1e-6, 1e-6)) {
            h.d[i] = T(0);
        }
        h.sign[i] = sign_of(h.d[i]);
    }
    return h;
}

/// The vertex that the plane cuts off from the other two, where the triangle is not in the plane.
template <class T>
AXG_LAB_FUNCTION int cut_off(const Heights<T>& h) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (h.sign[j] * h.sign[k] > 0) {
            return i;
        }
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (h.sign[i] != 0 && h.sign[j] * h.sign[k] <= 0 && h.sign[i] != h.sign[j] &&
            h.sign[i] != h.sign[k]) {
            return i;
        }
    }
    return 0;
}

/// Coordinate k of the two points at which the triangle crosses the other's plane, least first.
template <class T>
AXG_LAB_FUNCTION void interval_of(const Heights<T>& h, const Vec3<T>* v, int k, T* out) {
    const int i = cut_off(h);
    const T at = component(k, v[i]);
    for (int e = 0; e < 2; ++e) {
        const int j = (i + 1 + e) % 3;
        out[e] = at + (component(k, v[j]) - at) * h.d[i] / (h.d[i] - h.d[j]);
    }
    if (out[0] > out[1]) {
        const T first = out[0];
        out[0] = out[1];
        out[1] = first;
    }
}

/// Correct in exact arithmetic for triangles with area; without area the normal is zero, and the
/// verdict arbitrary.
template <class T>
AXG_LAB_FUNCTION Verdict moller(const Pair<T>& p) {
    const Vec3<T> n = cross(p.a[1] - p.a[0], p.a[2] - p.a[0]);
    const Heights<T> hb = heights_over(n, T(-dot(n, p.a[0])), p.b);
    if (hb.on_one_side()) {
        return Verdict::separated;
    }
    const Vec3<T> m = cross(p.b[1] - p.b[0], p.b[2] - p.b[0]);
    const Heights<T> ha = heights_over(m, T(-dot(m, p.b[0])), p.a);
    if (ha.on_one_side()) {
        return Verdict::separated;
    }
    if (ha.in_plane() || hb.in_plane()) {
        return verdict_of(!overlap_in_plane(p.a, p.b, n));
    }
    const int k = steepest(cross(n, m));
    T of_a[2], of_b[2];
    interval_of(ha, p.a, k, of_a);
    interval_of(hb, p.b, k, of_b);
    return verdict_of(of_a[1] < of_b[0] || of_b[1] < of_a[0]);
}

/// Whether a segment and a triangle of one plane share a point: clips the segment at each side of
/// the triangle.
template <class T>
AXG_LAB_FUNCTION bool segment_meets(const Point2<T>& from, const Point2<T>& to,
                                    const Point2<T>* t) {
    const int way = sign_of(turn(t[0], t[1], t[2]));
    T first = T(0), last = T(1);
    for (int i = 0; i < 3; ++i) {
        const T s0 = T(way) * turn(t[i], t[(i + 1) % 3], from);
        const T s1 = T(way) * turn(t[i], t[(i + 1) % 3], to);
        if (s0 < T(0) && s1 < T(0)) {
            return false;
        }
        if (s0 < T(0)) {
            first = most(first, T(s0 / (s0 - s1)));
        } else if (s1 < T(0)) {
            last = least(last, T(s0 / (s0 - s1)));
        }
    }
    return first <= last;
}

/// Tests the segment in which the plane of b cuts a against b in that plane. Correct in exact
/// arithmetic for triangles with area.
template <class T>
AXG_LAB_FUNCTION Verdict held(const Pair<T>& p) {
    const Vec3<T> m = cross(p.b[1] - p.b[0], p.b[2] - p.b[0]);
    const Heights<T> h = heights_over(m, T(-dot(m, p.b[0])), p.a);
    if (h.on_one_side()) {
        return Verdict::separated;
    }
    if (h.in_plane()) {
        return verdict_of(!overlap_in_plane(p.a, p.b, m));
    }
    const int i = cut_off(h);
    Vec3<T> end[2];
    for (int e = 0; e < 2; ++e) {
        const int j = (i + 1 + e) % 3;
        const T share = h.d[i] / (h.d[i] - h.d[j]);
        end[e] = p.a[i] + share * (p.a[j] - p.a[i]);
    }
    const int k = steepest(m);
    const Point2<T> t[3] = {without(k, p.b[0]), without(k, p.b[1]), without(k, p.b[2])};
    return verdict_of(!segment_meets(without(k, end[0]), without(k, end[1]), t));
}
