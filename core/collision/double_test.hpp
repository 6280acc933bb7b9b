// SPDX-License-Identifier: Apache-2.0
// The certified test in double of one pair of triangles: the recheck of pairs that float could
// not decide. Source: docs/theory/accuracy.md, section 4.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/closest_direction.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::sat {

/// Whether a triangle is so thin that its normal may be noise: then the closest direction is tried
/// as well.
AXG_HD bool thin(const V3<double>& n, const V3<double>& e, const V3<double>& f) noexcept {
    return !(dot3(n, n) > 1e-12 * (dot3(e, e) * dot3(f, f)));
}

template <bool kMargin>
AXG_HD bool apart_in_double(const TrianglePair<double>& p, double margin) noexcept {
    const PairAxes<double> x = axes_of(p);
    if (separated_17_wide<kMargin>(p, x, margin)) {
        return true;
    }
    if (!kMargin && !thin(x.na, x.ea[0], x.ea[1]) && !thin(x.nb, x.eb[0], x.eb[1])) {
        return false;  // the seventeen axes are complete
    }
    return separates<kMargin>(p, closest_direction(p, x).direction, margin);
}

}  // namespace axg::sat
