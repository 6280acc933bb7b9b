// SPDX-License-Identifier: Apache-2.0
// The distance of two triangles by their edges, with an early end. Source: Larsen, Gottschalk, Lin,
// Manocha, "Fast Proximity Queries with Swept Sphere Volumes", UNC TR99-018, 1999, and its program
// PQP (function TriDist): same order of steps, same threshold on normals.

/// The closest points of two segments.
template <class T>
struct EdgePair {
    Vec3<T> on_a, on_b;
};

template <class T>
AXG_LAB_FUNCTION T clamped(const T& t) {
    return t < T(0) ? T(0) : (t > T(1) ? T(1) : t);
}

template <class T>
AXG_LAB_FUNCTION EdgePair<T> closest_on_edges(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& q,
                                              const Vec3<T>& b) {
    const Vec3<T> w = q - p;
    const T aa = dot(a, a), bb = dot(b, b), ab = dot(a, b), aw = dot(a, w), bw = dot(b, w);
    const T determinant = aa * bb - ab * ab;
    T s = determinant > T(0) ? clamped(T((aw * bb - bw * ab) / determinant)) : T(0);
    T t = bb > T(0) ? T((s * ab - bw) / bb) : T(0);
    if (t < T(0) || t > T(1)) {
        t = clamped(t);
        s = aa > T(0) ? clamped(T((aw + t * ab) / aa)) : T(0);
    }
    return {p + s * a, q + t * b};
}

/// Squared distance by the edges. `told`: it is that of the triangles. `apart`: a slab between two
/// edges separates the triangles.
template <class T>
struct ByEdges {
    T square;
    bool told, apart;
};

template <class T>
AXG_LAB_FUNCTION ByEdges<T> square_by_edges(const Pair<T>& p) {
    ByEdges<T> best{T(0), false, false};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const EdgePair<T> edges = closest_on_edges(p.a[i], p.a[(i + 1) % 3] - p.a[i], p.b[j],
                                                       p.b[(j + 1) % 3] - p.b[j]);
            const Vec3<T> v = edges.on_b - edges.on_a;
            const T square = dot(v, v);
            if ((i != 0 || j != 0) && square > best.square) {
                continue;
            }
            best.square = square;
            T a = dot(p.a[(i + 2) % 3] - edges.on_a, v);
            T b = dot(p.b[(j + 2) % 3] - edges.on_b, v);
            if (a <= T(0) && b >= T(0)) {
                best.told = true;
                return best;
            }
            a = a < T(0) ? T(0) : a;
            b = b > T(0) ? T(0) : b;
            best.apart = best.apart || square - a + b > T(0);
        }
    }
    return best;
}

/// Squared distance from the vertex of q nearest to t's plane if its foot is inside t and all of q
/// is on that side, else negative. Sets `apart` if q is on one side of the plane.
template <class T>
AXG_LAB_FUNCTION T square_by_face(const Vec3<T>* t, const Vec3<T>* q, bool& apart) {
    const Vec3<T> n = cross(t[1] - t[0], t[2] - t[1]);
    const T nn = dot(n, n);
    if (!(nn > tolerance<T>(1e-15, 1e-15))) {
        return T(-1);
    }
    const T h[3] = {dot(t[0] - q[0], n), dot(t[0] - q[1], n), dot(t[0] - q[2], n)};
    const bool below = h[0] > T(0) && h[1] > T(0) && h[2] > T(0);
    const bool above = h[0] < T(0) && h[1] < T(0) && h[2] < T(0);
    if (!below && !above) {
        return T(-1);
    }
    int nearest = 0;
    for (int i = 1; i < 3; ++i) {
        nearest = size_of(h[i]) < size_of(h[nearest]) ? i : nearest;
    }
    apart = true;
    for (int i = 0; i < 3; ++i) {
        if (!(dot(q[nearest] - t[i], cross(n, t[(i + 1) % 3] - t[i])) > T(0))) {
            return T(-1);
        }
    }
    return h[nearest] * h[nearest] / nn;
}

/// Squared distance; 0 if no step shows that the triangles are disjoint. Correct in exact
/// arithmetic for triangles with area.
template <class T>
AXG_LAB_FUNCTION T pqp_square(const Pair<T>& p) {
    const ByEdges<T> edges = square_by_edges(p);
    if (edges.told) {
        return edges.square;
    }
    bool apart = edges.apart;
    const T from_a = square_by_face(p.a, p.b, apart);
    if (from_a >= T(0)) {
        return from_a;
    }
    const T from_b = square_by_face(p.b, p.a, apart);
    if (from_b >= T(0)) {
        return from_b;
    }
    return apart ? edges.square : T(0);
}
