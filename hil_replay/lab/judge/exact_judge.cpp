// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/judge/exact_judge.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "hil_replay/lab/judge/exact_signs.hpp"

namespace axg::lab {

namespace {

using Corners = Vec3d[3];
using Signs = int[3];

/// Signs of the other's corners against the plane of `t`. True: all on one side, off the plane.
bool beside(const Corners& t, const Corners& other, Signs& signs) {
    for (int i = 0; i < 3; ++i) {
        signs[i] = orientation(t[0], t[1], t[2], other[i]);
    }
    return signs[0] != 0 && signs[0] == signs[1] && signs[0] == signs[2];
}

/// Whether an edge of `other` meets `t`, given the signs of its corners against t's plane. Skips
/// edges in the plane: each of their ends belongs to an edge that is not in it, unless all of
/// `other` is in the plane.
bool edge_meets(const Corners& t, const Corners& other, const Signs& signs) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        if (signs[i] * signs[j] > 0 || (signs[i] == 0 && signs[j] == 0)) {
            continue;
        }
        const Vec3d &p = other[i], &q = other[j];
        const int s0 = orientation(p, q, t[0], t[1]);
        const int s1 = orientation(p, q, t[1], t[2]);
        if (s0 * s1 < 0) {
            continue;
        }
        const int s2 = orientation(p, q, t[2], t[0]);
        if (s0 * s2 >= 0 && s1 * s2 >= 0) {
            return true;
        }
    }
    return false;
}

bool is_zero(const Signs& s) {
    return s[0] == 0 && s[1] == 0 && s[2] == 0;
}

Flat dropped(const Vec3d& p, int axis) {
    return axis == 0 ? Flat{p.y, p.z} : axis == 1 ? Flat{p.z, p.x} : Flat{p.x, p.y};
}

using FlatCorners = Flat[3];

/// Whether the line of an edge of `t` has all of `t` on one closed side and all of the other off it
/// on the other side.
bool edge_separates(const FlatCorners& t, const FlatCorners& other) {
    for (int i = 0; i < 3; ++i) {
        const Flat &p = t[i], &q = t[(i + 1) % 3];
        const int own = orientation(p, q, t[(i + 2) % 3]);
        const int there = orientation(p, q, other[0]);
        if (there != 0 && own * there <= 0 && there == orientation(p, q, other[1]) &&
            there == orientation(p, q, other[2])) {
            return true;
        }
    }
    return false;
}

/// For triangles in one plane, at least one with an area. The plane projected along the dropped
/// axis is more than a line, so the projection preserves contacts.
bool meet_in_plane(const Pair<double>& pair, int axis) {
    FlatCorners a, b;
    for (int i = 0; i < 3; ++i) {
        a[i] = dropped(pair.a[i], axis);
        b[i] = dropped(pair.b[i], axis);
    }
    return !edge_separates(a, b) && !edge_separates(b, a);
}

/// An axis along which the projected triangle has an area; -1 if the triangle has none.
int axis_with_area(const Corners& t) {
    for (int axis = 0; axis < 3; ++axis) {
        if (orientation(dropped(t[0], axis), dropped(t[1], axis), dropped(t[2], axis)) != 0) {
            return axis;
        }
    }
    return -1;
}

// --- The distance: whole numbers of one power of two.

struct Point {
    mpz_class x, y, z;
};

Point operator-(const Point& a, const Point& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
mpz_class dot(const Point& a, const Point& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A squared length, above / below, below > 0.
struct Fraction {
    mpz_class above, below = 1;
};

void keep_less(Fraction& best, Fraction found) {
    if (found.above * best.below < best.above * found.below) {
        best = std::move(found);
    }
}

/// From the origin to the segment w + s u, s in [0, 1].
Fraction to_segment(const Point& w, const Point& u) {
    const mpz_class uu = dot(u, u), wu = dot(w, u);
    if (wu >= 0) {
        return {dot(w, w)};  // also a point: u is zero then
    }
    if (-wu >= uu) {
        const Point end{w.x + u.x, w.y + u.y, w.z + u.z};
        return {dot(end, end)};
    }
    return {dot(w, w) * uu - wu * wu, uu};
}

/// From the origin to w + s u + t v, if the least over all s and t is at 0 <= s, t and at
/// s + t <= 1 (triangle) or s, t <= 1 (parallelogram). Solves the equations of the least square.
void try_inside(Fraction& best, const Point& w, const Point& u, const Point& v, bool is_triangle) {
    const mpz_class uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), wu = dot(w, u), wv = dot(w, v);
    const mpz_class determinant = uu * vv - uv * uv;
    if (determinant == 0) {
        return;  // parallel: the least is on a border as well
    }
    const mpz_class s = uv * wv - vv * wu, t = uv * wu - uu * wv;
    if (s < 0 || t < 0 ||
        (is_triangle ? s + t > determinant : s > determinant || t > determinant)) {
        return;
    }
    keep_less(best, {dot(w, w) * determinant + s * wu + t * wv, determinant});
}

using ExactCorners = std::array<Point, 3>;

Fraction least_square(const ExactCorners& a, const ExactCorners& b) {
    const Point first = b[0] - a[0];
    Fraction best{dot(first, first)};
    for (std::size_t i = 0; i < 3; ++i) {
        const Point ea = a[(i + 1) % 3] - a[i], eb = b[(i + 1) % 3] - b[i];
        const Point back{-ea.x, -ea.y, -ea.z};
        for (std::size_t j = 0; j < 3; ++j) {
            keep_less(best, to_segment(a[j] - b[i], {-eb.x, -eb.y, -eb.z}));
            keep_less(best, to_segment(b[j] - a[i], back));
            try_inside(best, b[j] - a[i], b[(j + 1) % 3] - b[j], back, false);
        }
        try_inside(best, b[i] - a[0], a[0] - a[1], a[0] - a[2], true);
        try_inside(best, a[i] - b[0], b[0] - b[1], b[0] - b[2], true);
    }
    return best;
}

/// Exactly a double, as a fraction.
mpq_class exact(double x) {
    return mpq_class(x);
}

using Rational = std::array<mpq_class, 18>;

/// All coordinates as whole numbers of `unit`.
void to_whole(const Rational& p, ExactCorners& a, ExactCorners& b, mpq_class& unit) {
    mpz_class below = 1;  // all are powers of two: the largest is the common one
    for (const mpq_class& x : p) {
        below = x.get_den() > below ? mpz_class(x.get_den()) : below;
    }
    for (std::size_t i = 0; i < 18; ++i) {
        const mpz_class whole = p[i].get_num() * (below / p[i].get_den());
        Point& corner = i < 9 ? a[i / 3] : b[i / 3 - 3];
        (i % 3 == 0 ? corner.x : i % 3 == 1 ? corner.y : corner.z) = whole;
    }
    unit = mpq_class(1, below);
}

Rational rational(const Pair<double>& pair) {
    Rational out;
    for (std::size_t i = 0; i < 6; ++i) {
        const Vec3d& v = i < 3 ? pair.a[i] : pair.b[i - 3];
        out[3 * i] = exact(v.x);
        out[3 * i + 1] = exact(v.y);
        out[3 * i + 2] = exact(v.z);
    }
    return out;
}

mpq_class square_of(const Fraction& f, const mpq_class& unit) {
    mpq_class out(f.above, f.below);
    out.canonicalize();
    return out * unit * unit;
}

int plane_side(const ExactCorners& t, const Point& p) {
    const Point u = t[1] - t[0], v = t[2] - t[0], w = p - t[0];
    const Point n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    return sgn(dot(n, w));
}

/// Whether an edge of `other` goes through `t` from one side to the other.
bool pierces(const ExactCorners& t, const ExactCorners& other) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Point &p = other[i], &q = other[(i + 1) % 3];
        if (plane_side(t, p) * plane_side(t, q) >= 0) {
            continue;
        }
        const int s[3] = {plane_side({p, q, t[0]}, t[1]), plane_side({p, q, t[1]}, t[2]),
                          plane_side({p, q, t[2]}, t[0])};
        if (s[0] * s[1] >= 0 && s[1] * s[2] >= 0 && s[0] * s[2] >= 0) {
            return true;
        }
    }
    return false;
}

mpq_class square_between(const Rational& p) {
    ExactCorners a, b;
    mpq_class unit;
    to_whole(p, a, b, unit);
    if (pierces(a, b) || pierces(b, a)) {
        return 0;
    }
    return square_of(least_square(a, b), unit);
}

}  // namespace

bool intersect(const Pair<double>& pair) {
    Signs of_b, of_a;
    if (beside(pair.a, pair.b, of_b) || beside(pair.b, pair.a, of_a)) {
        return false;
    }
    const bool flat_b = is_zero(of_b), flat_a = is_zero(of_a);
    if (!flat_b || !flat_a) {
        // All signs of only one triangle are zero: then the other has no area, because two with
        // area would both be in one plane. Only the edges of the one without area are tested.
        return (!flat_b && edge_meets(pair.a, pair.b, of_b)) ||
               (!flat_a && edge_meets(pair.b, pair.a, of_a));
    }
    const int axis_a = axis_with_area(pair.a);
    const int axis = axis_a >= 0 ? axis_a : axis_with_area(pair.b);
    return axis >= 0 ? meet_in_plane(pair, axis) : squared_distance(pair) == 0;
}

mpq_class squared_distance(const Pair<double>& pair) {
    return square_between(rational(pair));
}

mpq_class squared_distance(const Pair<double>& pair, const Pose& pose_of_a) {
    Rational p = rational(pair);
    for (std::size_t i = 0; i < 3; ++i) {
        const mpq_class from[3] = {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
        for (std::size_t k = 0; k < 3; ++k) {
            p[3 * i + k] = exact(pose_of_a.t[k]);
            for (std::size_t j = 0; j < 3; ++j) {
                p[3 * i + k] += exact(pose_of_a.r[k][j]) * from[j];
            }
        }
    }
    return square_between(p);
}

double distance_mm(const mpq_class& squared_mm2) {
    // floor(sqrt(above 4^shift / below)) with more than 60 bits, then rounded down to a double.
    if (squared_mm2 == 0) {
        return 0;
    }
    const auto bits = static_cast<long>(mpz_sizeinbase(squared_mm2.get_den_mpz_t(), 2)) -
                      static_cast<long>(mpz_sizeinbase(squared_mm2.get_num_mpz_t(), 2));
    const long shift = bits / 2 + 70;
    mpz_class above = squared_mm2.get_num(), below = squared_mm2.get_den();
    if (shift >= 0) {
        above <<= static_cast<mp_bitcnt_t>(2 * shift);
    } else {
        below <<= static_cast<mp_bitcnt_t>(-2 * shift);
    }
    const mpz_class root = sqrt(mpz_class(above / below));
    long exponent = 0;
    const double mantissa = mpz_get_d_2exp(&exponent, root.get_mpz_t());  // truncates
    return std::ldexp(mantissa, static_cast<int>(exponent - shift));
}

}  // namespace axg::lab
