// SPDX-License-Identifier: Apache-2.0
// Only bounding volumes, one around each triangle: separated if the volumes are, else intersecting,
// as in a check without a triangle test.

/// Whether the projections of the triangles onto l are disjoint.
template <class T>
AXG_LAB_FUNCTION bool apart_by_slab(const Pair<T>& p, const Vec3<T>& l) {
    const T a0 = dot(l, p.a[0]), a1 = dot(l, p.a[1]), a2 = dot(l, p.a[2]);
    const T b0 = dot(l, p.b[0]), b1 = dot(l, p.b[1]), b2 = dot(l, p.b[2]);
    return least(least(a0, a1), a2) > most(most(b0, b1), b2) ||
           least(least(b0, b1), b2) > most(most(a0, a1), a2);
}

template <class T>
AXG_LAB_FUNCTION bool apart_by_boxes(const Pair<T>& p) {
    const T zero = T(0), one = T(1);
    return apart_by_slab(p, Vec3<T>{one, zero, zero}) ||
           apart_by_slab(p, Vec3<T>{zero, one, zero}) || apart_by_slab(p, Vec3<T>{zero, zero, one});
}

template <class T>
AXG_LAB_FUNCTION Verdict aabb(const Pair<T>& p) {
    return verdict_of(apart_by_boxes(p));
}

/// Nine slabs: three along the axes, six across the edges of a cube. Source: Klosowski, Held,
/// Mitchell, Sowizral, Zikan, "Efficient Collision Detection Using Bounding Volume Hierarchies of
/// k-DOPs", IEEE TVCG 4(1), 1998.
template <class T>
AXG_LAB_FUNCTION Verdict dop18(const Pair<T>& p) {
    const T zero = T(0), one = T(1), minus = T(-1);
    return verdict_of(
        apart_by_boxes(p) || apart_by_slab(p, Vec3<T>{one, one, zero}) ||
        apart_by_slab(p, Vec3<T>{one, zero, one}) || apart_by_slab(p, Vec3<T>{zero, one, one}) ||
        apart_by_slab(p, Vec3<T>{one, minus, zero}) ||
        apart_by_slab(p, Vec3<T>{one, zero, minus}) || apart_by_slab(p, Vec3<T>{zero, one, minus}));
}

/// Smallest spheres: about the longest edge where the angle across is not acute, else through the
/// three corners. Source: Ericson, Real-Time Collision Detection, 2005, 4.3.
template <class T>
struct Sphere {
    Vec3<T> centre;
    T square;
};

template <class T>
AXG_LAB_FUNCTION Sphere<T> sphere_of(const Vec3<T>* t) {
    for (int i = 0; i < 3; ++i) {
        const Vec3<T> e = t[(i + 1) % 3] - t[i], f = t[(i + 2) % 3] - t[i];
        if (!(dot(e, f) > T(0))) {  // not acute at i: the edge across is the longest
            const Vec3<T> half = T(0.5) * (t[(i + 2) % 3] - t[(i + 1) % 3]);
            return {t[(i + 1) % 3] + half, dot(half, half)};
        }
    }
    const Vec3<T> e = t[1] - t[0], f = t[2] - t[0];
    const T ee = dot(e, e), ff = dot(f, f), ef = dot(e, f);
    const T twice = T(2) * (ee * ff - ef * ef);
    const T s = ff * (ee - ef) / twice, u = ee * (ff - ef) / twice;
    const Vec3<T> from = s * e + u * f;
    return {t[0] + from, dot(from, from)};
}

template <class T>
AXG_LAB_FUNCTION Verdict sphere(const Pair<T>& p) {
    const Sphere<T> a = sphere_of(p.a), b = sphere_of(p.b);
    const Vec3<T> between = b.centre - a.centre;
    const T reach = root(a.square) + root(b.square);
    return verdict_of(dot(between, between) > reach * reach);
}

/// The flat box around a triangle along its longest edge: centre, two half edges, and its normal.
/// Source of the test of two: Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996; the axes are not
/// normalised, because the test compares only lengths along one axis.
template <class T>
struct FlatBox {
    Vec3<T> centre, half[2], normal;
};

template <class T>
AXG_LAB_FUNCTION FlatBox<T> box_of(const Vec3<T>* t) {
    int longest = 0;
    T square = T(-1);
    for (int i = 0; i < 3; ++i) {
        const Vec3<T> e = t[(i + 1) % 3] - t[i];
        const T ee = dot(e, e);
        if (ee > square) {
            square = ee;
            longest = i;
        }
    }
    const Vec3<T>& from = t[longest];
    const Vec3<T> e = t[(longest + 1) % 3] - from, f = t[(longest + 2) % 3] - from;
    const T foot = square > T(0) ? T(dot(e, f) / square) : T(0);
    const T low = least(T(0), foot), high = most(T(1), foot);
    FlatBox<T> box;
    const Vec3<T> across = f - foot * e;
    box.half[0] = T(T(0.5) * (high - low)) * e;
    box.half[1] = T(0.5) * across;
    box.centre = from + T(T(0.5) * (high + low)) * e + box.half[1];
    box.normal = cross(e, across);
    return box;
}

template <class T>
AXG_LAB_FUNCTION bool boxes_apart_along(const FlatBox<T>& a, const FlatBox<T>& b,
                                        const Vec3<T>& l) {
    const T reach = size_of(dot(l, a.half[0])) + size_of(dot(l, a.half[1])) +
                    size_of(dot(l, b.half[0])) + size_of(dot(l, b.half[1]));
    return size_of(dot(l, b.centre - a.centre)) > reach;
}

template <class T>
AXG_LAB_FUNCTION Verdict obb(const Pair<T>& p) {
    const FlatBox<T> a = box_of(p.a), b = box_of(p.b);
    const Vec3<T> of_a[3] = {a.half[0], a.half[1], a.normal};
    const Vec3<T> of_b[3] = {b.half[0], b.half[1], b.normal};
    bool apart = false;
    for (int i = 0; i < 3; ++i) {
        apart = apart || boxes_apart_along(a, b, of_a[i]) || boxes_apart_along(a, b, of_b[i]);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            apart = apart || boxes_apart_along(a, b, cross(of_a[i], of_b[j]));
        }
    }
    return verdict_of(apart);
}
