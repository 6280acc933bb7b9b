// SPDX-License-Identifier: Apache-2.0
// Separating axes as they are usually programmed: compared without a bound of their rounding.
// Sources: Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996, and its program RAPID (function
// TriContact: the seventeen axes in this order, relative to one vertex, not normalised).

/// A pair less a's first vertex, with the edges and normals that the axes are made of.
template <class T>
struct SatPair {
    Vec3<T> a[3], b[3], ea[3], eb[3], n, m;
};

template <class T>
AXG_LAB_FUNCTION SatPair<T> sat_pair(const Pair<T>& p) {
    SatPair<T> s;
    for (int i = 0; i < 3; ++i) {
        s.a[i] = p.a[i] - p.a[0];
        s.b[i] = p.b[i] - p.a[0];
    }
    for (int i = 0; i < 3; ++i) {
        s.ea[i] = s.a[(i + 1) % 3] - s.a[i];
        s.eb[i] = s.b[(i + 1) % 3] - s.b[i];
    }
    s.n = cross(s.ea[0], s.ea[1]);
    s.m = cross(s.eb[0], s.eb[1]);
    return s;
}

/// Gap between the projections onto l: negative where they overlap.
template <class T>
AXG_LAB_FUNCTION T gap_along(const SatPair<T>& s, const Vec3<T>& l) {
    const T a0 = dot(l, s.a[0]), a1 = dot(l, s.a[1]), a2 = dot(l, s.a[2]);
    const T b0 = dot(l, s.b[0]), b1 = dot(l, s.b[1]), b2 = dot(l, s.b[2]);
    const T above = least(least(b0, b1), b2) - most(most(a0, a1), a2);
    const T below = least(least(a0, a1), a2) - most(most(b0, b1), b2);
    return most(above, below);
}

template <class T>
AXG_LAB_FUNCTION bool apart_along(const SatPair<T>& s, const Vec3<T>& l) {
    return gap_along(s, l) > T(0);
}

template <class T>
AXG_LAB_FUNCTION bool apart_by_normals(const SatPair<T>& s) {
    return apart_along(s, s.n) || apart_along(s, s.m);
}

template <class T>
AXG_LAB_FUNCTION bool apart_by_edges(const SatPair<T>& s) {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (apart_along(s, cross(s.ea[i], s.eb[j]))) {
                return true;
            }
        }
    }
    return false;
}

template <class T>
AXG_LAB_FUNCTION bool apart_in_plane(const SatPair<T>& s) {
    for (int i = 0; i < 3; ++i) {
        if (apart_along(s, cross(s.ea[i], s.n)) || apart_along(s, cross(s.eb[i], s.m))) {
            return true;
        }
    }
    return false;
}

/// Tests all seventeen axes. Correct in exact arithmetic for triangles with area; two triangles
/// without area may wrongly be called intersecting, never separated.
template <class T>
AXG_LAB_FUNCTION Verdict sat17(const Pair<T>& p) {
    const SatPair<T> s = sat_pair(p);
    return verdict_of(apart_by_normals(s) || apart_by_edges(s) || apart_in_plane(s));
}

/// Omits the six in-plane axes: coplanar triangles are separated only if a normal or a product of
/// edges happens to separate them, so most are called intersecting. Correct in exact arithmetic if
/// planes are not parallel. Source: the seed paper's eleven without its six.
template <class T>
AXG_LAB_FUNCTION Verdict sat11(const Pair<T>& p) {
    const SatPair<T> s = sat_pair(p);
    return verdict_of(apart_by_normals(s) || apart_by_edges(s));
}

/// Tests six axes if the normals are parallel within a threshold, else eleven. Sources: the seed
/// paper, and Eberly's Geometric Tools for the threshold on the squared sine.
template <class T>
AXG_LAB_FUNCTION Verdict paper_6_11(const Pair<T>& p) {
    const SatPair<T> s = sat_pair(p);
    if (apart_by_normals(s)) {
        return Verdict::separated;
    }
    const Vec3<T> nm = cross(s.n, s.m);
    const T square = dot(nm, nm), sizes = dot(s.n, s.n) * dot(s.m, s.m);
    const bool parallel = square <= tolerance<T>(1e-6, 1e-8) * sizes;
    return verdict_of(parallel ? apart_in_plane(s) : apart_by_edges(s));
}

/// One of the seventeen axes as a unit vector; skips an axis too short to be normalised. Apart only
/// if the gap exceeds 0.1 um: a tolerance that fits one size of triangles and no other.
template <class T>
AXG_LAB_FUNCTION bool apart_along_unit(const SatPair<T>& s, const Vec3<T>& l) {
    const T square = dot(l, l);
    if (!(square > tolerance<T>(1e-12, 1e-12))) {
        return false;
    }
    return gap_along(s, (T(1) / root(square)) * l) > tolerance<T>(1e-4, 1e-4);
}

template <class T>
AXG_LAB_FUNCTION Verdict sat17_normalised_eps(const Pair<T>& p) {
    const SatPair<T> s = sat_pair(p);
    bool apart = apart_along_unit(s, s.n) || apart_along_unit(s, s.m);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            apart = apart || apart_along_unit(s, cross(s.ea[i], s.eb[j]));
        }
    }
    for (int i = 0; i < 3; ++i) {
        apart = apart || apart_along_unit(s, cross(s.ea[i], s.n)) ||
                apart_along_unit(s, cross(s.eb[i], s.m));
    }
    return verdict_of(apart);
}
