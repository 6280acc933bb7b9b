// SPDX-License-Identifier: Apache-2.0
// Exact arithmetic on what floats and doubles hold: whole numbers times powers of two, and the
// exact squared distance of two closed triangles as a fraction of them. Nothing here rounds.
// Source: closest features (nine edge pairs, eighteen vertex-edge pairs, six vertex-face pairs,
// six piercings); a triangle without area is the union of its edges.
#pragma once

#include <gmpxx.h>

#include <array>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::test {

/// mantissa * 2^exponent. Not normalised: sums and products alone, so the numbers stay small.
class Dyadic {
  public:
    Dyadic() = default;
    /// Exactly the number `d` holds. Precondition: finite.
    explicit Dyadic(double d);

    friend Dyadic operator+(const Dyadic& a, const Dyadic& b);
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b);
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b);
    [[nodiscard]] int sign() const { return sgn(mantissa_); }
    [[nodiscard]] mpq_class value() const;

  private:
    mpz_class mantissa_ = 0;
    long exponent_ = 0;
};

using ExactPoint = std::array<Dyadic, 3>;
using ExactTriangle = std::array<ExactPoint, 3>;

template <class T>
using PlainTriangle = std::array<std::array<T, 3>, 3>;

[[nodiscard]] ExactTriangle exact(const PlainTriangle<double>& t);
[[nodiscard]] ExactTriangle exact(const PlainTriangle<float>& t);
[[nodiscard]] ExactTriangle exact(const Triangle& t);
/// R v + t with the numbers of the pose taken as they are.
[[nodiscard]] ExactTriangle placed(const Pose& pose, const Triangle& t);

/// A squared distance, mm^2, as above / below; below > 0.
struct ExactSquare {
    Dyadic above, below;

    [[nodiscard]] bool is_zero() const { return above.sign() == 0; }
    /// Distance > r. Precondition: r >= 0.
    [[nodiscard]] bool more_than(double r) const;
    /// Distance >= r. Precondition: r >= 0.
    [[nodiscard]] bool at_least(double r) const;
    [[nodiscard]] bool less_than(const ExactSquare& other) const;
    /// Distance in mm, rounded: for reports and for bounds far wider than 2^-50.
    [[nodiscard]] double mm() const;
};

/// 0 exactly where the closed triangles share a point.
[[nodiscard]] ExactSquare squared_distance(const ExactTriangle& a, const ExactTriangle& b);

}  // namespace axg::test
