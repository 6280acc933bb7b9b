// SPDX-License-Identifier: Apache-2.0
// The distance of two triangles as that of their difference from the origin. Sources: Gilbert,
// Johnson, Keerthi, "A Fast Procedure for Computing the Distance Between Complex Objects in
// Three-Dimensional Space", IEEE Journal of Robotics and Automation 4(2), 1988; the closest points
// of simplices as in Ericson, Real-Time Collision Detection, 2005, 5.1 and 9.5.

/// Up to four points of the difference, and the point of their hull nearest to the origin.
template <class T>
struct Simplex {
    Vec3<T> at[4];
    int count = 0;
    Vec3<T> nearest;
};

template <class T>
AXG_LAB_FUNCTION void keep_one(Simplex<T>& s, const Vec3<T>& a) {
    s.at[0] = a;
    s.count = 1;
    s.nearest = a;
}

/// Reduces to the segment a b, with the nearest point at a + share (b - a).
template <class T>
AXG_LAB_FUNCTION void keep_two(Simplex<T>& s, const Vec3<T>& a, const Vec3<T>& b, T share) {
    s.at[0] = a;
    s.at[1] = b;
    s.count = 2;
    s.nearest = a + share * (b - a);
}

template <class T>
AXG_LAB_FUNCTION void reduce_segment(Simplex<T>& s, Vec3<T> a, Vec3<T> b) {
    const Vec3<T> ab = b - a;
    const T length = dot(ab, ab), t = -dot(a, ab);
    if (!(t > T(0))) {
        return keep_one(s, a);
    }
    if (!(t < length)) {
        return keep_one(s, b);
    }
    keep_two(s, a, b, t / length);
}

template <class T>
AXG_LAB_FUNCTION void reduce_triangle(Simplex<T>& s, Vec3<T> a, Vec3<T> b, Vec3<T> c) {
    const Vec3<T> ab = b - a, ac = c - a;
    const T d1 = -dot(ab, a), d2 = -dot(ac, a);
    if (d1 <= T(0) && d2 <= T(0)) {
        return keep_one(s, a);
    }
    const T d3 = -dot(ab, b), d4 = -dot(ac, b);
    if (d3 >= T(0) && d4 <= d3) {
        return keep_one(s, b);
    }
    const T vc = d1 * d4 - d3 * d2;
    if (vc <= T(0) && d1 >= T(0) && d3 <= T(0)) {
        return keep_two(s, a, b, d1 / (d1 - d3));
    }
    const T d5 = -dot(ab, c), d6 = -dot(ac, c);
    if (d6 >= T(0) && d5 <= d6) {
        return keep_one(s, c);
    }
    const T vb = d5 * d2 - d1 * d6;
    if (vb <= T(0) && d2 >= T(0) && d6 <= T(0)) {
        return keep_two(s, a, c, d2 / (d2 - d6));
    }
    const T va = d3 * d6 - d5 * d4;
    if (va <= T(0) && d4 - d3 >= T(0) && d5 - d6 >= T(0)) {
        return keep_two(s, b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    const T one = T(1) / (va + vb + vc);
    s.at[0] = a;
    s.at[1] = b;
    s.at[2] = c;
    s.count = 3;
    s.nearest = a + vb * one * ab + vc * one * ac;
}

/// Reduces to the nearest of the faces that have the origin outside; without such a face the origin
/// is inside, and is the nearest point.
template <class T>
AXG_LAB_FUNCTION void reduce_tetrahedron(Simplex<T>& s) {
    constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    const Simplex<T> whole = s;
    s.count = 4;
    s.nearest = {};
    T least_square = T(-1);
    for (const auto& f : kFaces) {
        const Vec3<T>&a = whole.at[f[0]], &b = whole.at[f[1]], &c = whole.at[f[2]];
        const Vec3<T> n = cross(b - a, c - a);
        if (dot(n, whole.at[f[3]] - a) * -dot(n, a) > T(0)) {
            continue;  // the origin is on the inner side
        }
        Simplex<T> face;
        reduce_triangle(face, a, b, c);
        const T square = dot(face.nearest, face.nearest);
        if (least_square < T(0) || square < least_square) {
            least_square = square;
            s = face;
        }
    }
}

template <class T>
AXG_LAB_FUNCTION void reduce(Simplex<T>& s) {
    if (s.count == 1) {
        s.nearest = s.at[0];
    } else if (s.count == 2) {
        reduce_segment(s, s.at[0], s.at[1]);
    } else if (s.count == 3) {
        reduce_triangle(s, s.at[0], s.at[1], s.at[2]);
    } else {
        reduce_tetrahedron(s);
    }
}

/// The vertex farthest along d.
template <class T>
AXG_LAB_FUNCTION Vec3<T> farthest(const Vec3<T>* t, const Vec3<T>& d) {
    const T h[3] = {dot(t[0], d), dot(t[1], d), dot(t[2], d)};
    return h[0] >= h[1] && h[0] >= h[2] ? t[0] : (h[1] >= h[2] ? t[1] : t[2]);
}

template <class T>
struct Measured {
    T mm;
    bool converged;
};

/// Runs at most 64 steps; a pair that has not converged by then is undecided.
template <class T>
AXG_LAB_FUNCTION Measured<T> gjk_distance(const Pair<T>& p) {
    constexpr int kSteps = 64;
    Simplex<T> s;
    keep_one(s, p.b[0] - p.a[0]);
    T last = dot(s.nearest, s.nearest);
    for (int step = 0; step < kSteps; ++step) {
        if (s.count == 4 || !(last > T(0))) {
            return {T(0), true};
        }
        const Vec3<T> back = T(-1) * s.nearest;
        const Vec3<T> w = farthest(p.b, back) - farthest(p.a, s.nearest);
        bool settled = !(last - dot(s.nearest, w) > tolerance<T>(1e-6, 1e-14) * last);
        for (int i = 0; i < s.count; ++i) {
            settled = settled || s.at[i] == w;
        }
        if (settled) {
            return {root(last), true};
        }
        s.at[s.count++] = w;
        reduce(s);
        const T square = dot(s.nearest, s.nearest);
        if (s.count != 4 && !(square < last)) {
            return {root(last), true};  // no nearer: only rounding is left
        }
        last = square;
    }
    return {root(last), false};
}
