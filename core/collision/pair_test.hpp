// SPDX-License-Identifier: Apache-2.0
// The certified test of pairs of triangles in float, in its stages: shared axes; without a margin
// each axis by itself; with one the two normals and the closest direction. Every stage proves by
// itself; a later one only matters for what the earlier ones left, which then goes to
// core/collision/double_test.hpp.
// Source: docs/theory/accuracy.md. Read by g++, clang++ and nvcc; one lane or many.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/closest_direction.hpp"
#include "core/collision/shared_axes.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::sat {

/// Inputs of a test in addition to the vertices. docs/theory/accuracy.md, "Constants of a query".
template <class V>
struct PairLimits {
    V d;         // errors of the vertices: d of scale_of
    V margin;    // r' at or above r (1 + 8u); unused without a margin
    V r_square;  // at or above r^2 (1 + 2^-18)
};

template <class V>
AXG_HD TrianglePair<V> scaled_pair(const V3<V>* a, const V3<V>* b, V d) noexcept {
    using lanes::abs, lanes::max;
    const V zero = lanes::Traits<V>::of(0.0);
    V most[3] = {zero, zero, zero};
    for (int i = 0; i < 3; ++i) {
        most[0] = max(most[0], max(abs(a[i].x), abs(b[i].x)));
        most[1] = max(most[1], max(abs(a[i].y), abs(b[i].y)));
        most[2] = max(most[2], max(abs(a[i].z), abs(b[i].z)));
    }
    return {{a[0], a[1], a[2]},
            {b[0], b[1], b[2]},
            {scale_of(most[0], d), scale_of(most[1], d), scale_of(most[2], d)}};
}

/// Whether a query with a margin also tries the nine edge crosses and the six in-plane normals by
/// themselves. If the triangles are more than the margin apart, their closest direction separates
/// them: the fifteen would only prove pairs that this direction loses to rounding.
/// Source: docs/theory/accuracy.md, section 2.
inline constexpr bool kTriesAxesWithMargin = false;

/// The later stages, for lanes that the shared axes left undecided.
/// @param told  lanes that the shared axes proved apart; not all lanes
template <bool kMargin, bool kTriesAxes = !kMargin || kTriesAxesWithMargin, class V>
AXG_HD typename lanes::Traits<V>::Mask apart_by_itself(typename lanes::Traits<V>::Mask told,
                                                       const V3<V>* a, const V3<V>* b,
                                                       const PairLimits<V>& x,
                                                       V* edges_square = nullptr) noexcept {
    using lanes::all, lanes::either;
    const TrianglePair<V> p = scaled_pair(a, b, x.d);
    if constexpr (kTriesAxes) {
        told = either(told, separated_17<kMargin>(p, x.margin));
    }
    if constexpr (kMargin) {
        const PairAxes<V> axes = axes_of(p);
        if constexpr (!kTriesAxes) {
            told = either(told, separated_by_normals<true>(p, axes, x.margin));
        }
        if (!all(told)) {
            const Closest<V> closest = closest_direction(p, axes, edges_square);
            told = either(told, separates<true>(p, closest.direction, x.margin));
        }
    }
    return told;
}

/// True only where every point of a is more than r from every point of b (kMargin false: r = 0).
/// @tparam kTriesAxes  whether all seventeen axes are tried by themselves
/// @param a, b          [3] local vertices, |coordinate| <= 2^20 mm
/// @param edges_square  kMargin: as of closest_direction, where any lane is not apart; may be null
template <bool kMargin, bool kTriesAxes = !kMargin || kTriesAxesWithMargin, class V>
AXG_HD typename lanes::Traits<V>::Mask apart(const V3<V>* a, const V3<V>* b, const PairLimits<V>& x,
                                             V* edges_square = nullptr) noexcept {
    const auto told = separated_shared<kMargin, true>(a, b, x.d, x.r_square);
    return lanes::all(told) ? told
                            : apart_by_itself<kMargin, kTriesAxes>(told, a, b, x, edges_square);
}

}  // namespace axg::sat
