// SPDX-License-Identifier: Apache-2.0
// Exact signs of orientation for any coordinates. Three steps, each only if the previous one cannot
// decide: double with a proven bound, 128-bit whole numbers, GMP. The code shares only Vec3d with
// core/, so that a fault there has no twin here.
#pragma once

#include "core/base/vec3.hpp"

namespace axg::lab {

/// Sign of the determinant (b - a, c - a, d - a): 1 if d is on that side of the plane a, b, c from
/// which a, b, c turns counter-clockwise; 0 exactly if the four points are in one plane.
/// Precondition: finite.
[[nodiscard]] int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// A point of a plane.
struct Flat {
    double x, y;
};

/// Sign of the determinant (b - a, c - a): 1 if c is to the left of a, b.
[[nodiscard]] int orientation(const Flat& a, const Flat& b, const Flat& c);

/// How many signs each step decided, in this thread.
struct SignCounts {
    unsigned long long by_double = 0, by_integers = 0, by_gmp = 0;
};
[[nodiscard]] SignCounts sign_counts();

}  // namespace axg::lab
