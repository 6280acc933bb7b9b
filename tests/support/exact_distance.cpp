// SPDX-License-Identifier: Apache-2.0
#include "tests/support/exact_distance.hpp"

#include <cmath>
#include <utility>

namespace axg::test {

namespace {

ExactPoint operator-(const ExactPoint& a, const ExactPoint& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Dyadic dot(const ExactPoint& a, const ExactPoint& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ExactPoint cross(const ExactPoint& a, const ExactPoint& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void keep_less(ExactSquare& best, ExactSquare found) {
    if (found.less_than(best)) {
        best = std::move(found);
    }
}

/// Point q against the segment p + s u, s in [0, 1].
ExactSquare point_segment(const ExactPoint& q, const ExactPoint& p, const ExactPoint& u) {
    const Dyadic one(1.0);
    const ExactPoint w = q - p;
    const Dyadic uu = dot(u, u), along = dot(w, u);
    if (along.sign() <= 0) {
        return {dot(w, w), one};
    }
    if ((along - uu).sign() >= 0) {
        const ExactPoint end = w - u;
        return {dot(end, end), one};
    }
    return {dot(w, w) * uu - along * along, uu};
}

/// The common perpendicular of two segments, where it meets both inside.
void try_crossing(ExactSquare& best, const ExactPoint& p, const ExactPoint& u, const ExactPoint& q,
                  const ExactPoint& v) {
    const ExactPoint n = cross(u, v), w = q - p;
    const Dyadic nn = dot(n, n);
    if (nn.sign() == 0) {
        return;  // parallel: an end is as near
    }
    const Dyadic s = dot(cross(w, v), n), t = dot(cross(w, u), n);
    if (s.sign() >= 0 && t.sign() >= 0 && (nn - s).sign() >= 0 && (nn - t).sign() >= 0) {
        const Dyadic height = dot(w, n);
        keep_less(best, {height * height, nn});
    }
}

/// The foot of q on the face, where it lies on it.
void try_face(ExactSquare& best, const ExactTriangle& t, const ExactPoint& n, const Dyadic& nn,
              const ExactPoint& q) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (dot(cross(n, t[(i + 1) % 3] - t[i]), q - t[i]).sign() < 0) {
            return;
        }
    }
    const Dyadic height = dot(n, q - t[0]);
    keep_less(best, {height * height, nn});
}

/// Whether the segment p, q goes through the face from one side to the other.
bool pierces(const ExactTriangle& t, const ExactPoint& n, const ExactPoint& p,
             const ExactPoint& q) {
    if (dot(n, p - t[0]).sign() * dot(n, q - t[0]).sign() >= 0) {
        return false;  // an end on the plane is found as a vertex on the face
    }
    const ExactPoint along = q - p;
    int sides[3];
    for (std::size_t i = 0; i < 3; ++i) {
        sides[i] = dot(along, cross(t[i] - p, t[(i + 1) % 3] - p)).sign();
    }
    const bool no_left = sides[0] <= 0 && sides[1] <= 0 && sides[2] <= 0;
    const bool no_right = sides[0] >= 0 && sides[1] >= 0 && sides[2] >= 0;
    return no_left || no_right;
}

/// Everything that needs the face of `t`: feet of the other's vertices, piercings by its edges.
void try_against_face(ExactSquare& best, const ExactTriangle& t, const ExactTriangle& other) {
    const ExactPoint n = cross(t[1] - t[0], t[2] - t[0]);
    const Dyadic nn = dot(n, n);
    if (nn.sign() == 0) {
        return;  // no area: its edges are all of it
    }
    for (std::size_t i = 0; i < 3; ++i) {
        try_face(best, t, n, nn, other[i]);
        if (pierces(t, n, other[i], other[(i + 1) % 3])) {
            best = {Dyadic(0.0), Dyadic(1.0)};
        }
    }
}

template <class T>
ExactTriangle exact_of(const PlainTriangle<T>& t) {
    ExactTriangle out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out[i][k] = Dyadic(static_cast<double>(t[i][k]));
        }
    }
    return out;
}

}  // namespace

Dyadic::Dyadic(double d) {
    if (d != 0) {
        int e = 0;
        mantissa_ = std::ldexp(std::frexp(d, &e), 53);
        exponent_ = e - 53;
        const auto zeros = static_cast<long>(mpz_scan1(mantissa_.get_mpz_t(), 0));
        mantissa_ >>= static_cast<mp_bitcnt_t>(zeros);
        exponent_ += zeros;
    }
}

Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.sign() == 0 || b.sign() == 0) {
        return a.sign() == 0 ? b : a;
    }
    const Dyadic &fine = a.exponent_ < b.exponent_ ? a : b, &coarse = &fine == &a ? b : a;
    Dyadic out;
    out.exponent_ = fine.exponent_;
    out.mantissa_ = coarse.mantissa_ << static_cast<mp_bitcnt_t>(coarse.exponent_ - fine.exponent_);
    out.mantissa_ += fine.mantissa_;
    return out;
}

Dyadic operator-(const Dyadic& a, const Dyadic& b) {
    Dyadic minus = b;
    minus.mantissa_ = -minus.mantissa_;
    return a + minus;
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic out;
    out.mantissa_ = a.mantissa_ * b.mantissa_;
    out.exponent_ = a.exponent_ + b.exponent_;
    return out;
}

mpq_class Dyadic::value() const {
    const auto by = static_cast<mp_bitcnt_t>(std::labs(exponent_));
    mpq_class out(mantissa_);
    if (exponent_ < 0) {
        out >>= by;
    } else {
        out <<= by;
    }
    return out;
}

ExactTriangle exact(const PlainTriangle<double>& t) {
    return exact_of(t);
}
ExactTriangle exact(const PlainTriangle<float>& t) {
    return exact_of(t);
}
ExactTriangle exact(const Triangle& t) {
    return exact(PlainTriangle<float>{
        {{t.a.x, t.a.y, t.a.z}, {t.b.x, t.b.y, t.b.z}, {t.c.x, t.c.y, t.c.z}}});
}

ExactTriangle placed(const Pose& pose, const Triangle& t) {
    const ExactTriangle from = exact(t);
    ExactTriangle out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out[i][k] = Dyadic(pose.t[k]);
            for (std::size_t j = 0; j < 3; ++j) {
                out[i][k] = out[i][k] + Dyadic(pose.r[k][j]) * from[i][j];
            }
        }
    }
    return out;
}

bool ExactSquare::more_than(double r) const {
    return (above - Dyadic(r) * Dyadic(r) * below).sign() > 0;
}
bool ExactSquare::at_least(double r) const {
    return (above - Dyadic(r) * Dyadic(r) * below).sign() >= 0;
}
bool ExactSquare::less_than(const ExactSquare& other) const {
    return (above * other.below - other.above * below).sign() < 0;
}
double ExactSquare::mm() const {
    const mpq_class square = above.value() / below.value();
    mpf_class wide(square, 256);
    return mpf_class(sqrt(wide)).get_d();
}

ExactSquare squared_distance(const ExactTriangle& a, const ExactTriangle& b) {
    const ExactPoint first = a[0] - b[0];
    ExactSquare best{dot(first, first), Dyadic(1.0)};
    for (std::size_t i = 0; i < 3; ++i) {
        const ExactPoint u = a[(i + 1) % 3] - a[i];
        for (std::size_t j = 0; j < 3; ++j) {
            const ExactPoint v = b[(j + 1) % 3] - b[j];
            keep_less(best, point_segment(b[j], a[i], u));
            keep_less(best, point_segment(a[i], b[j], v));
            try_crossing(best, a[i], u, b[j], v);
        }
    }
    try_against_face(best, a, b);
    try_against_face(best, b, a);
    return best;
}

}  // namespace axg::test
