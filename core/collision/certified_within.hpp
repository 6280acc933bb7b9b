// SPDX-License-Identifier: Apache-2.0
// The other side of the certified test: two triangles that are certified to be within the margin,
// so that no sound test can prove them apart and none needs to be run. mm. Any points of the two
// triangles are a legitimate witness; poor ones prove nothing. Source: docs/theory/accuracy.md,
// section 12.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/closest_direction.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::sat {

/// From a point of the triangle (p0, edges f1 and f2 from there) to q: the point nearest to q where
/// its foot falls inside, else some point. The weights are in [0, 1] and add up to at most 1 + u,
/// whatever the triangle's shape.
template <class V>
AXG_HD V3<V> from_face(const V3<V>& p0, const V3<V>& f1, const V3<V>& f2, const V3<V>& q) noexcept {
    using lanes::fma;
    const V3<V> z = sub(q, p0);
    const V g11 = dot3(f1, f1), g12 = dot3(f1, f2), g22 = dot3(f2, f2);
    const V z1 = dot3(z, f1), z2 = dot3(z, f2);
    const V divisor = difference_of_products(g11, g22, g12, g12);
    const V w1 = clamp01(safe_quotient(difference_of_products(g22, z1, g12, z2), divisor));
    const V w2 =
        lanes::min(clamp01(safe_quotient(difference_of_products(g11, z2, g12, z1), divisor)),
                   lanes::Traits<V>::of(1.0) - w1);
    return {fma(-w2, f2.x, fma(-w1, f1.x, z.x)), fma(-w2, f2.y, fma(-w1, f1.y, z.y)),
            fma(-w2, f2.z, fma(-w1, f1.z, z.z))};
}

/// A witness whose distance plus error bound is below this limit proves a distance of at most r.
AXG_HD float near_limit(double r_mm) noexcept {
    return static_cast<float>(r_mm * (1.0 - 0x1p-20));
}

/// True only where some point of a is at most r from some point of b.
/// @param edges_square  of closest_direction: nine of the witnesses; the other six are of faces
/// @param near_mm       near_limit(r)
template <class V>
AXG_HD typename lanes::Traits<V>::Mask certified_within(const TrianglePair<V>& p, V edges_square,
                                                        V near_mm) noexcept {
    using lanes::either, lanes::greater, lanes::sqrt;
    // Bounds the error of one witness, all coordinates together.
    const V errors = lanes::Traits<V>::of(3.0) * (p.scale.x + p.scale.y + p.scale.z) +
                     lanes::Traits<V>::of(0x1p-60);
    auto told = greater(near_mm, sqrt(edges_square) + errors);
    if (lanes::all(told)) {
        return told;
    }
    for (int side = 0; side < 2; ++side) {
        const V3<V>*const face = side == 0 ? p.a : p.b, *const other = side == 0 ? p.b : p.a;
        const V3<V> e1 = sub(face[1], face[0]), e2 = sub(face[2], face[0]);
        for (int i = 0; i < 3; ++i) {
            const V3<V> d = from_face(face[0], e1, e2, other[i]);
            told = either(told, greater(near_mm, sqrt(dot3(d, d)) + errors));
        }
    }
    return told;
}

}  // namespace axg::sat
