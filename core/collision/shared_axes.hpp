// SPDX-License-Identifier: Apache-2.0
// All seventeen separating axes of two triangles from shared triple products: the first, cheap
// stage of the certified test. "Separated" is a theorem here too; what it leaves undecided goes to
// core/collision/tri_sat.hpp. Source: docs/theory/accuracy.md, "Shared axes" (identities, bounds,
// proof against this code). Read by g++, clang++ and nvcc; one lane or many.
//
// With the triangles a0 + {0, E, E'} and a0 + D + {0, F, F'}, every projection on every axis is a
// sum of a few numbers: the four (X x Y).D, n.F, n.F', n.D (n = E x E'), m.E, m.E', m.D (m = F x
// F'), and the dot products of the five vectors. Seventeen axes cost some three hundred operations
// instead of eight hundred. The price: one bound for all axes of a kind, as large as the longest
// edges make it, so thin triangles and near-parallel edges are left undecided more often.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::sat {

/// Two triangles: a0 + {0, e[0], e[1]} and a0 + d + {0, f[0], f[1]}.
template <class V>
struct EdgePair {
    V3<V> e[2], f[2], d;
};

template <class V>
AXG_HD EdgePair<V> edges_of(const V3<V>* a, const V3<V>* b) noexcept {
    return {
        {sub(a[1], a[0]), sub(a[2], a[0])}, {sub(b[1], b[0]), sub(b[2], b[0])}, sub(b[0], a[0])};
}

/// Axis data of one triangle, which do not depend on the triangle it is tested against.
template <class V>
struct TriangleAxes {
    V3<V> edge[2], normal;
    V squares[3];  // e0.e0, e0.e1, e1.e1
    V area;        // square of the normal
    V reach;       // largest |coordinate| of the edges
};

template <class V>
AXG_HD V largest(const V3<V>& a) noexcept {
    using lanes::abs, lanes::max;
    return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

template <class V>
AXG_HD V3<V> plain_cross(const V3<V>& a, const V3<V>& b) noexcept {
    using lanes::fma;
    return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

/// a c - b b of the products a = x.x, b = x.y, c = y.y: the square of x cross y.
template <class V>
AXG_HD V area_square(V a, V b, V c) noexcept {
    return lanes::fma(a, c, -(b * b));
}

template <class V>
AXG_HD V reach_of_edges(const V3<V> (&e)[2]) noexcept {
    return lanes::max(largest(e[0]), largest(e[1]));
}

/// By how much a computed gap may exceed the true one, for each kind of axis.
template <class V>
struct SharedBounds {
    V alpha, beta;  // largest |coordinate| of e, of f
    V normal_a, normal_b, twice_cross, in_plane_a, in_plane_b;
};

/// @param alpha  largest |coordinate| of a's edges; beta of b's
/// @param start  a's first vertex: with the edges it bounds every coordinate
/// @param d      errors of the vertices: d of scale_of
template <class V>
AXG_HD SharedBounds<V> shared_bounds(const EdgePair<V>& p, V alpha, V beta, const V3<V>& start,
                                     V d) noexcept {
    using lanes::fma, lanes::max, lanes::Traits;
    const V tiny = Traits<V>::of(16.0 * double(Traits<V>::kTiny)), eight = Traits<V>::of(8.0);
    SharedBounds<V> s;
    s.alpha = alpha;
    s.beta = beta;
    constexpr double kUnit = double(Traits<V>::kUnit);
    const V sum = s.alpha + s.beta + largest(p.d);
    const V tau = fma(Traits<V>::of(12.5 * kUnit), largest(start) + sum,
                      fma(Traits<V>::of(64.0 * kUnit), sum, Traits<V>::of(49.0 * kUnit) * d));
    const V a = s.alpha * tau, b = s.beta * tau;
    s.normal_a = fma(s.alpha, a, tiny), s.normal_b = fma(s.beta, b, tiny);
    s.twice_cross = fma(eight * s.alpha, b, tiny);
    s.in_plane_a = fma(eight * s.alpha, s.normal_a, tiny);
    s.in_plane_b = fma(eight * s.beta, s.normal_b, tiny);
    return s;
}

template <class V>
AXG_HD SharedBounds<V> shared_bounds(const EdgePair<V>& p, const V3<V>& start, V d) noexcept {
    return shared_bounds(p, reach_of_edges(p.e), reach_of_edges(p.f), start, d);
}

template <class V>
AXG_HD V least_with_zero(V a, V b) noexcept {
    return lanes::min(lanes::min(a, b), lanes::Traits<V>::of(0.0));
}
template <class V>
AXG_HD V most_with_zero(V a, V b) noexcept {
    return lanes::max(lanes::max(a, b), lanes::Traits<V>::of(0.0));
}

/// Gap along a normal: one triangle projects to 0, the other to d, d + f0 and d + f1.
template <class V>
AXG_HD V normal_gap(V d, V f0, V f1) noexcept {
    return lanes::max(d + least_with_zero(f0, f1), -(d + most_with_zero(f0, f1)));
}

/// Twice the gaps along the nine edge crosses; third edges are e[1] - e[0] and f[1] - f[0].
/// @param g  2 (e[i] x f[j]).d;  nf: n.f[j];  me: m.e[i]
template <class V>
AXG_HD void twice_cross_gaps(const V (&g)[2][2], const V (&nf)[2], const V (&me)[2],
                             V (&gaps)[3][3]) noexcept {
    using lanes::abs;
    const V n[3] = {nf[0], nf[1], nf[1] - nf[0]}, m[3] = {me[0], me[1], me[1] - me[0]};
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        const V d0 = i < 2 ? g[i % 2][0] : g[1][0] - g[0][0];
        const V d1 = i < 2 ? g[i % 2][1] : g[1][1] - g[0][1];
        const V d[3] = {d0, d1, d1 - d0};
        AXG_UNROLL(V)
        for (int j = 0; j < 3; ++j) {
            // a projects to 0 and -+n[j], b to d and d +- m[i]: distance of the middles less half
            // the lengths, doubled.
            const V b = j == 0 ? d[j] + m[i] : d[j] - m[i];
            const V middles = i == 0 ? b + n[j] : b - n[j];
            gaps[i][j] = abs(middles) - (abs(n[j]) + abs(m[i]));
        }
    }
}

/// Gaps along the outward in-plane normals of the triangle {0, e[0], e[1]}, in the order of the
/// edges e[0], e[1], e[1] - e[0].
/// @param ee  e0.e0, e0.e1, e1.e1;  square: of n
/// @param d, f0, f1  products of e[0] and e[1] with the vector to the other triangle and its edges
template <class V>
AXG_HD void in_plane_gaps(const V (&ee)[3], V square, const V (&d)[2], const V (&f0)[2],
                          const V (&f1)[2], V (&gaps)[3]) noexcept {
    using lanes::fma;
    // (e[i] x n).w = (e[i].e[1]) (e[0].w) - (e[i].e[0]) (e[1].w)
    const V d0 = fma(ee[1], d[0], -(ee[0] * d[1])), d1 = fma(ee[2], d[0], -(ee[1] * d[1]));
    const V p0 = fma(ee[1], f0[0], -(ee[0] * f0[1])), p1 = fma(ee[2], f0[0], -(ee[1] * f0[1]));
    const V q0 = fma(ee[1], f1[0], -(ee[0] * f1[1])), q1 = fma(ee[2], f1[0], -(ee[1] * f1[1]));
    gaps[0] = d0 + least_with_zero(p0, q0);
    gaps[1] = -(d1 + most_with_zero(p1, q1));
    gaps[2] = ((d1 - d0) + least_with_zero(p1 - p0, q1 - q0)) - square;
}

/// Gaps along all axes, not normalised.
template <class V>
struct SharedGaps {
    V normal_a, normal_b, twice_cross[3][3], in_plane_a[3], in_plane_b[3];
};

/// Dot products of the edges.
template <class V>
struct EdgeProducts {
    V ee[3], ff[3];  // e0.e0, e0.e1, e1.e1
    V ef[2][2];
    V area_a, area_b;  // squares of the normals
};

/// Computes e0.e0, e0.e1, e1.e1 of two edges.
template <class V>
AXG_HD void edge_products(const V3<V> (&e)[2], V (&out)[3]) noexcept {
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        out[i] = dot3(e[i / 2], e[(i + 1) / 2]);
    }
}

/// The axis data of a triangle, to be used for every triangle that it is tested against.
/// @param v  [3] its vertices
template <class V>
AXG_HD TriangleAxes<V> axes_of_triangle(const V3<V>* v) noexcept {
    TriangleAxes<V> t;
    t.edge[0] = sub(v[1], v[0]), t.edge[1] = sub(v[2], v[0]);
    t.normal = plain_cross(t.edge[0], t.edge[1]);
    edge_products(t.edge, t.squares);
    t.area = area_square(t.squares[0], t.squares[1], t.squares[2]);
    t.reach = reach_of_edges(t.edge);
    return t;
}

/// Dot products of the normals n of a and m of b with the other triangle's edges, and with d.
template <class V>
struct NormalProducts {
    V nf[2], me[2], nd, md;
};

template <class V>
AXG_HD NormalProducts<V> normal_products(const EdgePair<V>& p, const V3<V>& n,
                                         const V3<V>& m) noexcept {
    return {{dot3(n, p.f[0]), dot3(n, p.f[1])},
            {dot3(m, p.e[0]), dot3(m, p.e[1])},
            dot3(n, p.d),
            dot3(m, p.d)};
}

template <class V>
AXG_HD NormalProducts<V> normal_products(const EdgePair<V>& p) noexcept {
    return normal_products(p, plain_cross(p.e[0], p.e[1]), plain_cross(p.f[0], p.f[1]));
}

template <class V>
AXG_HD void mixed_products(const EdgePair<V>& p, EdgeProducts<V>& x) noexcept {
    AXG_UNROLL(V)
    for (int i = 0; i < 2; ++i) {
        x.ef[i][0] = dot3(p.e[i], p.f[0]), x.ef[i][1] = dot3(p.e[i], p.f[1]);
    }
}

template <class V>
AXG_HD EdgeProducts<V> products_of(const EdgePair<V>& p) noexcept {
    EdgeProducts<V> x;
    edge_products(p.e, x.ee);
    edge_products(p.f, x.ff);
    mixed_products(p, x);
    x.area_a = area_square(x.ee[0], x.ee[1], x.ee[2]);
    x.area_b = area_square(x.ff[0], x.ff[1], x.ff[2]);
    return x;
}

/// Axis data worked out for the pair at hand, each where it is first needed.
struct ComputedAxes {
    template <class V>
    AXG_HD SharedBounds<V> bounds(const EdgePair<V>& p, const V3<V>& start, V d) const noexcept {
        return shared_bounds(p, start, d);
    }
    template <class V>
    AXG_HD NormalProducts<V> normals(const EdgePair<V>& p) const noexcept {
        return normal_products(p);
    }
    template <class V>
    AXG_HD EdgeProducts<V> products(const EdgePair<V>& p) const noexcept {
        return products_of(p);
    }
};

/// Axis data of both triangles, worked out before. The same numbers.
template <class V>
struct StoredAxes {
    TriangleAxes<V> a, b;

    AXG_HD SharedBounds<V> bounds(const EdgePair<V>& p, const V3<V>& start, V d) const noexcept {
        return shared_bounds(p, a.reach, b.reach, start, d);
    }
    AXG_HD NormalProducts<V> normals(const EdgePair<V>& p) const noexcept {
        return normal_products(p, a.normal, b.normal);
    }
    AXG_HD EdgeProducts<V> products(const EdgePair<V>& p) const noexcept {
        EdgeProducts<V> x;
        AXG_UNROLL(V)
        for (int i = 0; i < 3; ++i) {
            x.ee[i] = a.squares[i], x.ff[i] = b.squares[i];
        }
        mixed_products(p, x);
        x.area_a = a.area, x.area_b = b.area;
        return x;
    }
};

template <class V>
AXG_HD SharedGaps<V> gaps_of(const EdgePair<V>& p, const NormalProducts<V>& y,
                             const EdgeProducts<V>& x) noexcept {
    SharedGaps<V> s;
    s.normal_a = normal_gap(y.nd, y.nf[0], y.nf[1]);
    s.normal_b = normal_gap(-y.md, y.me[0], y.me[1]);
    const V3<V> twice = {p.d.x + p.d.x, p.d.y + p.d.y, p.d.z + p.d.z};
    V g[2][2];
    AXG_UNROLL(V)
    for (int i = 0; i < 2; ++i) {
        const V3<V> c = plain_cross(twice, p.e[i]);  // (d x e).f = (e x f).d
        g[i][0] = dot3(c, p.f[0]), g[i][1] = dot3(c, p.f[1]);
    }
    twice_cross_gaps(g, y.nf, y.me, s.twice_cross);
    const V ed[2] = {dot3(p.e[0], p.d), dot3(p.e[1], p.d)};
    const V fd[2] = {-dot3(p.f[0], p.d), -dot3(p.f[1], p.d)};  // seen from b, a is at -d
    const V ef0[2] = {x.ef[0][0], x.ef[1][0]}, ef1[2] = {x.ef[0][1], x.ef[1][1]};
    in_plane_gaps(x.ee, x.area_a, ed, ef0, ef1, s.in_plane_a);
    in_plane_gaps(x.ff, x.area_b, fd, x.ef[0], x.ef[1], s.in_plane_b);
    return s;
}

template <class V>
AXG_HD typename lanes::Traits<V>::Mask touching_excluded(const SharedGaps<V>& g,
                                                         const SharedBounds<V>& s) noexcept {
    using lanes::either, lanes::greater, lanes::max;
    V cross = g.twice_cross[0][0];
    AXG_UNROLL(V)
    for (int i = 1; i < 9; ++i) {
        cross = max(cross, g.twice_cross[i / 3][i % 3]);
    }
    const V in_plane_a = max(max(g.in_plane_a[0], g.in_plane_a[1]), g.in_plane_a[2]);
    const V in_plane_b = max(max(g.in_plane_b[0], g.in_plane_b[1]), g.in_plane_b[2]);
    const auto normal = either(greater(g.normal_a, s.normal_a), greater(g.normal_b, s.normal_b));
    return either(either(normal, greater(cross, s.twice_cross)),
                  either(greater(in_plane_a, s.in_plane_a), greater(in_plane_b, s.in_plane_b)));
}

/// gap - bound > 0 and (gap - bound)^2 > r^2 |L|^2.
template <class V>
AXG_HD typename lanes::Traits<V>::Mask exceeds(V gap, V bound, V r_square, V square) noexcept {
    const V left = gap - bound;
    return lanes::greater(left * lanes::abs(left), r_square * square);
}

/// Upper bounds of the squared lengths of the three edges {0, e0, e1} has.
template <class V>
AXG_HD void edge_squares(const V (&ee)[3], V slack, V (&out)[3]) noexcept {
    out[0] = ee[0] + slack, out[1] = ee[2] + slack;
    out[2] = ((ee[0] - ee[1]) + (ee[2] - ee[1])) + slack;
}

/// @param r_square  at least r^2 (1 + 2^-18)
template <class V>
AXG_HD typename lanes::Traits<V>::Mask margin_excluded(const SharedGaps<V>& g,
                                                       const SharedBounds<V>& s,
                                                       const EdgeProducts<V>& x,
                                                       V r_square) noexcept {
    using lanes::either, lanes::fma, lanes::Traits;
    constexpr double kUnit = double(Traits<V>::kUnit);
    const V tiny = Traits<V>::of(16.0 * double(Traits<V>::kTiny));
    const V aa = s.alpha * s.alpha, bb = s.beta * s.beta, four = Traits<V>::of(4.0);
    V xx[3], yy[3];
    edge_squares(x.ee, fma(Traits<V>::of(64.0 * kUnit), aa, tiny), xx);
    edge_squares(x.ff, fma(Traits<V>::of(64.0 * kUnit), bb, tiny), yy);
    const V area_a = x.area_a + fma(Traits<V>::of(128.0 * kUnit) * aa, aa, tiny);
    const V area_b = x.area_b + fma(Traits<V>::of(128.0 * kUnit) * bb, bb, tiny);
    auto apart = either(exceeds(g.normal_a, s.normal_a, r_square, area_a),
                        exceeds(g.normal_b, s.normal_b, r_square, area_b));
    const V slack = fma(Traits<V>::of(2048.0 * kUnit) * aa, bb, tiny), four_r = four * r_square;
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        const V xy0 = i < 2 ? x.ef[i % 2][0] : x.ef[1][0] - x.ef[0][0];
        const V xy1 = i < 2 ? x.ef[i % 2][1] : x.ef[1][1] - x.ef[0][1];
        const V xy[3] = {xy0, xy1, xy1 - xy0};
        AXG_UNROLL(V)
        for (int j = 0; j < 3; ++j) {
            const V square = fma(xx[i], yy[j], fma(-xy[j], xy[j], slack));
            apart = either(apart, exceeds(g.twice_cross[i][j], s.twice_cross, four_r, square));
        }
        apart = either(apart,
                       exceeds(g.in_plane_a[i], s.in_plane_a, r_square, fma(xx[i], area_a, tiny)));
        apart = either(apart,
                       exceeds(g.in_plane_b[i], s.in_plane_b, r_square, fma(yy[i], area_b, tiny)));
    }
    return apart;
}

/// True only where the triangles share no point (kMargin: are more than r apart). Tests all
/// seventeen axes; kLeavesEarly without a margin: only the normals if they separate every lane,
/// which does not change the result.
/// @param start     a's first vertex; |coordinate| of all vertices <= 2^20 mm
/// @param data      ComputedAxes or StoredAxes: one result
/// @param d         errors of the vertices: d of scale_of
/// @param r_square  kMargin: at least r^2 (1 + 2^-18)
template <bool kMargin, bool kLeavesEarly, class V, class Data>
AXG_HD typename lanes::Traits<V>::Mask separated_edges(const EdgePair<V>& p, const V3<V>& start,
                                                       const Data& data, V d, V r_square) noexcept {
    const SharedBounds<V> bounds = data.bounds(p, start, d);
    const NormalProducts<V> normals = data.normals(p);
    if constexpr (kLeavesEarly && !kMargin) {
        using lanes::either, lanes::greater;
        const auto told =
            either(greater(normal_gap(normals.nd, normals.nf[0], normals.nf[1]), bounds.normal_a),
                   greater(normal_gap(-normals.md, normals.me[0], normals.me[1]), bounds.normal_b));
        if (lanes::all(told)) {
            return told;
        }
    }
    const EdgeProducts<V> products = data.products(p);
    const SharedGaps<V> gaps = gaps_of(p, normals, products);
    if constexpr (kMargin) {
        return margin_excluded(gaps, bounds, products, r_square);
    } else {
        return touching_excluded(gaps, bounds);
    }
}

/// The same of two triangles.
/// @param a, b  [3] local vertices
template <bool kMargin, bool kLeavesEarly, class V>
AXG_HD typename lanes::Traits<V>::Mask separated_shared(const V3<V>* a, const V3<V>* b, V d,
                                                        V r_square) noexcept {
    return separated_edges<kMargin, kLeavesEarly>(edges_of(a, b), a[0], ComputedAxes{}, d,
                                                  r_square);
}

}  // namespace axg::sat
