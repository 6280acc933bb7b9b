// SPDX-License-Identifier: Apache-2.0
// The certified separating-axis test of two triangles. "Separated" is a theorem; other results mean
// nothing. Source: docs/theory/accuracy.md (theorem, proof against this code). Read by g++, clang++
// and nvcc; one lane or many.
//
// A vector L separates when the computed gap of the projections exceeds the bound of its own
// rounding,
//     gap > fl(bound(L) + fl(r' |L|)),   bound(L) = 9u (|Lx| M'x + |Ly| M'y + |Lz| M'z) + 2^-100.
// Any L is legitimate: a badly computed cross product is a bad candidate, never a wrong result. No
// epsilon, no branch.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/lanes.hpp"

namespace axg::sat {

template <class V>
struct V3 {
    V x, y, z;
};

template <class V>
AXG_HD V3<V> sub(const V3<V>& a, const V3<V>& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class V>
AXG_HD V dot3(const V3<V>& a, const V3<V>& b) noexcept {
    return lanes::fma(a.x, b.x, lanes::fma(a.y, b.y, a.z * b.z));
}

/// a*b - c*d with relative error 2u (Kahan; Jeannerod, Louvet, Muller 2013): an axis that is good
/// to the last bits whatever the angle between its edges, so that the undecided band stays at its
/// formula (docs/theory/accuracy.md).
template <class V>
AXG_HD V difference_of_products(V a, V b, V c, V d) noexcept {
    const V w = c * d;
    const V error = lanes::fma(-c, d, w);
    return lanes::fma(a, b, -w) + error;
}

template <class V>
AXG_HD V3<V> cross3(const V3<V>& a, const V3<V>& b) noexcept {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}

/// One pair of triangles (or one a lane) in a common local frame.
/// scale = 9u * M', per coordinate: M' = largest |coordinate| of the six vertices + d, see
/// scale_of.
template <class V>
struct TrianglePair {
    V3<V> a[3], b[3];
    V3<V> scale;
};

/// @param m  largest |coordinate| of the six local vertices
/// @param d  at least (delta_A + delta_B) / (8u) + 2^-90, the vertices' own errors
template <class V>
AXG_HD V scale_of(V m, V d) noexcept {
    return lanes::Traits<V>::of(9.0 * double(lanes::Traits<V>::kUnit)) * (m + d);
}

/// The gap between the projections on L, and the bound that it must exceed to prove "separated".
template <class V>
struct AxisGap {
    V gap, bound;
};

template <class V>
AXG_HD AxisGap<V> axis_gap(const TrianglePair<V>& p, const V3<V>& l) noexcept {
    using lanes::abs, lanes::fma, lanes::max, lanes::min;
    const V a0 = dot3(l, p.a[0]), a1 = dot3(l, p.a[1]), a2 = dot3(l, p.a[2]);
    const V b0 = dot3(l, p.b[0]), b1 = dot3(l, p.b[1]), b2 = dot3(l, p.b[2]);
    const V gap = max(min(min(b0, b1), b2) - max(max(a0, a1), a2),
                      min(min(a0, a1), a2) - max(max(b0, b1), b2));
    const V weight = fma(abs(l.z), p.scale.z, fma(abs(l.y), p.scale.y, abs(l.x) * p.scale.x));
    return {gap, weight + lanes::Traits<V>::of(double(lanes::Traits<V>::kTiny))};
}

/// True only where every point of a is more than r' from every point of b. kMargin false: r' = 0.
/// With r' the caller gives the float at or above r (1 + 8u), r >= 2^-40.
template <bool kMargin, class V>
AXG_HD typename lanes::Traits<V>::Mask separates(const TrianglePair<V>& p, const V3<V>& l,
                                                 V r) noexcept {
    const AxisGap<V> g = axis_gap(p, l);
    if constexpr (kMargin) {
        const V square = dot3(l, l);
        const V needed = g.bound + r * lanes::sqrt(square);
        const auto long_enough = lanes::greater(square, lanes::Traits<V>::of(0x1p-100));
        return lanes::both(long_enough, lanes::greater(g.gap, needed));
    } else {
        return lanes::greater(g.gap, g.bound);
    }
}

/// Edges and normals of a pair, computed once for its seventeen axes.
template <class V>
struct PairAxes {
    V3<V> ea[3], eb[3], na, nb;
};

template <class V>
AXG_HD PairAxes<V> axes_of(const TrianglePair<V>& p) noexcept {
    PairAxes<V> x;
    for (int i = 0; i < 3; ++i) {
        x.ea[i] = sub(p.a[(i + 1) % 3], p.a[i]);
        x.eb[i] = sub(p.b[(i + 1) % 3], p.b[i]);
    }
    x.na = cross3(x.ea[0], x.ea[1]);
    x.nb = cross3(x.eb[0], x.eb[1]);
    return x;
}

/// The seventeen axes of one pair side by side, in loops a compiler turns into lanes. The same
/// tests as separated_17.
template <bool kMargin, class T>
AXG_HD bool separated_17_wide(const TrianglePair<T>& p, const PairAxes<T>& x, T r) noexcept {
    constexpr int kWide = 24;  // seventeen, filled up with copies of the last
    T u[3][kWide], v[3][kWide], l[3][kWide];
    const auto put = [&u, &v](int i, const V3<T>& e, const V3<T>& f) {
        u[0][i] = e.x, u[1][i] = e.y, u[2][i] = e.z;
        v[0][i] = f.x, v[1][i] = f.y, v[2][i] = f.z;
    };
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            put(3 * i + j, x.ea[i], x.eb[j]);
        }
        put(9 + i, x.ea[i], x.na);
        put(12 + i, x.eb[i], x.nb);
    }
    put(15, x.ea[0], x.ea[1]);
    for (int i = 16; i < kWide; ++i) {
        put(i, x.eb[0], x.eb[1]);
    }
    for (int i = 0; i < kWide; ++i) {
        l[0][i] = difference_of_products(u[1][i], v[2][i], u[2][i], v[1][i]);
        l[1][i] = difference_of_products(u[2][i], v[0][i], u[0][i], v[2][i]);
        l[2][i] = difference_of_products(u[0][i], v[1][i], u[1][i], v[0][i]);
    }
    int apart = 0;
    for (int i = 0; i < kWide; ++i) {
        apart |= separates<kMargin>(p, V3<T>{l[0][i], l[1][i], l[2][i]}, r) ? 1 : 0;
    }
    return apart != 0;
}

template <bool kMargin, class V>
AXG_HD typename lanes::Traits<V>::Mask separated_by_normals(const TrianglePair<V>& p,
                                                            const PairAxes<V>& x, V r) noexcept {
    return lanes::either(separates<kMargin>(p, x.nb, r), separates<kMargin>(p, x.na, r));
}

/// The seventeen axes, cheapest and likeliest first: normals, edge crosses, in-plane edge normals.
/// Leaves early only when every lane is separated; the result does not depend on it.
template <bool kMargin, class V>
AXG_HD typename lanes::Traits<V>::Mask separated_17(const TrianglePair<V>& p, V r) noexcept {
    using lanes::all, lanes::either;
    const PairAxes<V> x = axes_of(p);
    auto apart = separated_by_normals<kMargin>(p, x, r);
    if (all(apart)) {
        return apart;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            apart = either(apart, separates<kMargin>(p, cross3(x.ea[i], x.eb[j]), r));
        }
        if (all(apart)) {
            return apart;
        }
    }
    for (int i = 0; i < 3; ++i) {
        apart = either(apart, separates<kMargin>(p, cross3(x.ea[i], x.na), r));
        apart = either(apart, separates<kMargin>(p, cross3(x.eb[i], x.nb), r));
    }
    return apart;
}

}  // namespace axg::sat
