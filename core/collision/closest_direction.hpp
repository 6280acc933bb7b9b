// SPDX-License-Identifier: Apache-2.0
// The direction between (approximate) closest points of two triangles: the eighteenth separating
// axis, and the one that proves a distance. Nothing here is certified and nothing needs to be: a
// poor direction is a poor candidate for the certified gap (core/collision/tri_sat.hpp). Source:
// closed forms as in Ericson, Real-Time Collision Detection, 5.1; all fifteen features (nine edge
// pairs, six vertex-face pairs) are tried, without a branch.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::sat {

template <class V>
struct Closest {
    V3<V> direction;  // from a towards b, not normalised
    V square;         // its squared length
};

template <class V>
AXG_HD V clamp01(V t) noexcept {
    using lanes::Traits;
    return lanes::max(lanes::min(t, Traits<V>::of(1.0)), Traits<V>::of(0.0));
}

/// Quotient that is 0 where the divisor is not positive.
template <class V>
AXG_HD V safe_quotient(V a, V b) noexcept {
    using lanes::Traits;
    const V zero = Traits<V>::of(0.0);
    const auto usable = lanes::greater(b, zero);
    return lanes::select(usable, a / lanes::select(usable, b, Traits<V>::of(1.0)), zero);
}

template <class V>
AXG_HD void keep_closer(Closest<V>& best, const V3<V>& d,
                        typename lanes::Traits<V>::Mask valid) noexcept {
    const V square = dot3(d, d);
    const auto closer = lanes::both(valid, lanes::greater(best.square, square));
    best.square = lanes::select(closer, square, best.square);
    best.direction.x = lanes::select(closer, d.x, best.direction.x);
    best.direction.y = lanes::select(closer, d.y, best.direction.y);
    best.direction.z = lanes::select(closer, d.z, best.direction.z);
}

/// Closest points of the segments p + s u and q + t v, s and t in [0, 1].
template <class V>
AXG_HD V3<V> between_segments(const V3<V>& p, const V3<V>& u, const V3<V>& q,
                              const V3<V>& v) noexcept {
    using lanes::fma;
    const V3<V> w = sub(p, q);
    const V uu = dot3(u, u), vv = dot3(v, v), uv = dot3(u, v);
    const V uw = dot3(u, w), vw = dot3(v, w);
    const V denominator = difference_of_products(uu, vv, uv, uv);
    V s = clamp01(safe_quotient(difference_of_products(uv, vw, uw, vv), denominator));
    const V t = clamp01(safe_quotient(fma(uv, s, vw), vv));
    s = clamp01(safe_quotient(fma(uv, t, -uw), uu));
    return {fma(t, v.x, fma(-s, u.x, -w.x)), fma(t, v.y, fma(-s, u.y, -w.y)),
            fma(t, v.z, fma(-s, u.z, -w.z))};
}

/// The foot of vertex q on the plane of triangle (p0, edges e), where it falls inside the triangle.
template <class V>
AXG_HD void try_face(Closest<V>& best, const V3<V>* p, const V3<V>* e, const V3<V>& n, V nn,
                     const V3<V>& q, bool from_face) noexcept {
    using lanes::both, lanes::greater;
    const V zero = lanes::Traits<V>::of(0.0);
    const V height = safe_quotient(dot3(n, sub(q, p[0])), nn);
    auto inside = greater(nn, zero);
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        inside = both(inside, greater(dot3(cross3(n, e[i]), sub(q, p[i])), zero));
    }
    const V h = from_face ? height : -height;
    keep_closer(best, V3<V>{h * n.x, h * n.y, h * n.z}, inside);
}

/// Approximate closest direction. Triangles that pierce one another get some short direction, which
/// proves nothing.
/// @param edges_square  out, unless null: the least square of the nine pairs of edges
template <class V>
AXG_HD Closest<V> closest_direction(const TrianglePair<V>& p, const PairAxes<V>& x,
                                    V* edges_square = nullptr) noexcept {
    Closest<V> best;
    best.direction = sub(p.b[0], p.a[0]);
    best.square = dot3(best.direction, best.direction);
    const auto always = lanes::greater(lanes::Traits<V>::of(1.0), lanes::Traits<V>::of(0.0));
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        AXG_UNROLL(V)
        for (int j = 0; j < 3; ++j) {
            const V3<V> d = between_segments(p.a[i], x.ea[i], p.b[j], x.eb[j]);
            keep_closer(best, d, always);
            if (edges_square != nullptr) {
                const V square = dot3(d, d);
                *edges_square = i + j == 0 ? square : lanes::min(square, *edges_square);
            }
        }
    }
    const V na = dot3(x.na, x.na), nb = dot3(x.nb, x.nb);
    AXG_UNROLL(V)
    for (int i = 0; i < 3; ++i) {
        try_face(best, p.a, x.ea, x.na, na, p.b[i], true);
        try_face(best, p.b, x.eb, x.nb, nb, p.a[i], false);
    }
    return best;
}

/// Largest certified distance the direction proves, mm: never more than the true distance.
/// Negative: proves nothing.
template <class V>
AXG_HD V certified_distance(const TrianglePair<V>& p, const V3<V>& l) noexcept {
    using lanes::Traits;
    const AxisGap<V> g = axis_gap(p, l);
    const V square = dot3(l, l);
    const auto usable = lanes::greater(square, Traits<V>::of(0x1p-100));
    const V length = lanes::sqrt(lanes::select(usable, square, Traits<V>::of(1.0)));
    const V shrink = Traits<V>::of(1.0 - 8.0 * double(Traits<V>::kUnit));
    return lanes::select(usable, (g.gap - g.bound) * shrink / length, Traits<V>::of(-1.0));
}

}  // namespace axg::sat
