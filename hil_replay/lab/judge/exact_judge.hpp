// SPDX-License-Identifier: Apache-2.0
// The truth about a pair of triangles, without rounding: whether the closed triangles share a
// point, from exact signs of orientation, and their squared distance as a fraction of GMP's whole
// numbers. Triangles may have no area. Coordinates are finite doubles (floats are doubles too) and
// count as exact. The code shares only Vec3d and Pose with core/, and no computation with
// tests/support/exact_distance.*.
#pragma once

#include <gmpxx.h>

#include "core/base/pose.hpp"
#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

template <class T>
[[nodiscard]] Pair<double> in_double(const Pair<T>& pair) {
    Pair<double> out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {double(pair.a[i].x), double(pair.a[i].y), double(pair.a[i].z)};
        out.b[i] = {double(pair.b[i].x), double(pair.b[i].y), double(pair.b[i].z)};
    }
    return out;
}

/// Whether the closed triangles share a point: a touch counts. On generated pairs 0.8 us for floats
/// and 2.6 us for doubles (docs/measurements/certified-pairs.md).
[[nodiscard]] bool intersect(const Pair<double>& pair);

/// Squared distance in mm^2; 0 exactly where `intersect` is true. Some 30 us.
[[nodiscard]] mpq_class squared_distance(const Pair<double>& pair);
/// The same with a moved: a vertex p of a is at pose * p, with the matrix exactly as given.
[[nodiscard]] mpq_class squared_distance(const Pair<double>& pair, const Pose& pose_of_a);

/// The root, rounded down: never more than the distance.
[[nodiscard]] double distance_mm(const mpq_class& squared_mm2);

}  // namespace axg::lab
