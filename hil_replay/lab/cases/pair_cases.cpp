// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/cases/pair_cases.hpp"

#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/sincos.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_categories.hpp"
#include "hil_replay/lab/cases/pair_shapes.hpp"

namespace axg::lab {

namespace {

using Raw = Pair<double>;

/// A signed permutation of the axes; half of them mirror.
void quarter_turn(Draw& draw, double (&r)[3][3]) {
    static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                          {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const auto& order = kOrders[draw.below(6)];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            r[i][j] = j == order[i] ? draw.sign() : 0;
        }
    }
}

/// Rotation matrix of a quaternion, times the square of its length: whole for whole numbers.
void quaternion_matrix(const double (&q)[4], double (&r)[3][3]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    r[0][0] = w * w + x * x - y * y - z * z;
    r[0][1] = 2 * (x * y - w * z);
    r[0][2] = 2 * (x * z + w * y);
    r[1][0] = 2 * (x * y + w * z);
    r[1][1] = w * w - x * x + y * y - z * z;
    r[1][2] = 2 * (y * z - w * x);
    r[2][0] = 2 * (x * z - w * y);
    r[2][1] = 2 * (y * z + w * x);
    r[2][2] = w * w - x * x - y * y + z * z;
}

double square_length(const double (&q)[4]) {
    return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

void shrink(double (&r)[3][3], double by) {
    for (auto& row : r) {
        for (double& x : row) {
            x /= by;
        }
    }
}

void any_turn(Draw& draw, double (&r)[3][3]) {
    double q[4];
    do {
        for (double& x : q) {
            x = draw.between(-1, 1);
        }
    } while (square_length(q) > 1 || square_length(q) < 0.01);
    quaternion_matrix(q, r);
    shrink(r, square_length(q));
}

void whole_turn(Draw& draw, double (&r)[3][3], bool divided) {
    double q[4];
    do {
        for (double& x : q) {
            x = static_cast<double>(draw.below(7)) - 3;
        }
    } while (square_length(q) == 0);
    quaternion_matrix(q, r);
    if (divided) {
        shrink(r, square_length(q));
    }
}

/// Rotation of C about z, then of A about x, in steps of 0.001 degrees.
void trunnion_turn(Draw& draw, double (&r)[3][3]) {
    constexpr double kStepRad = kPi / 180e3;
    const SinCos a = sin_cos(kStepRad * (static_cast<double>(draw.below(220000)) - 110000));
    const SinCos c = sin_cos(kStepRad * static_cast<double>(draw.below(360000)));
    const double made[3][3] = {{c.cos, -c.sin, 0},
                               {a.cos * c.sin, a.cos * c.cos, -a.sin},
                               {a.sin * c.sin, a.sin * c.cos, a.cos}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            r[i][j] = made[i][j];
        }
    }
}

void make_turn(Draw& draw, Place place, double (&r)[3][3]) {
    switch (place) {
        case Place::turned:
            return any_turn(draw, r);
        case Place::quarter:
        case Place::grid:
            return quarter_turn(draw, r);
        case Place::rational:
            return whole_turn(draw, r, true);
        case Place::scaled:
            return whole_turn(draw, r, false);
        case Place::trunnion:
            return trunnion_turn(draw, r);
        case Place::as_is:
            break;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            r[i][j] = i == j ? 1 : 0;
        }
    }
}

/// A gap in units of the category's size.
double draw_gap(Draw& draw, const Category& c, unsigned finest) {
    switch (c.gap) {
        case Gap::none:
            return 0;
        case Gap::powers: {
            const std::uint32_t kind = draw.below(8);
            const double gap = std::ldexp(1.0, -static_cast<int>(draw.below(finest)));
            return kind == 0 ? 0 : kind < 3 ? -gap : gap;
        }
        case Gap::apart:
            return std::ldexp(1.0, -11 - static_cast<int>(draw.below(finest / 2 - 3)));
        case Gap::micrometre:
            break;
    }
    const double gap_mm = 1e-3 * std::ldexp(1.0, 7 - static_cast<int>(draw.below(16)));
    return (draw.below(4) == 0 ? -gap_mm : gap_mm) / c.size_mm;
}

void turn_vertices(Vec3d (&t)[3], std::uint32_t by) {
    const Vec3d kept[3] = {t[0], t[1], t[2]};
    for (std::uint32_t i = 0; i < 3; ++i) {
        t[(i + by) % 3] = kept[i];
    }
}

/// Puts vertices and triangles in random order, or in the order that makes `axis` (if it is not
/// negative) the only separating one.
void order_vertices(Draw& draw, int axis, Raw& p) {
    if (axis < 0) {
        turn_vertices(p.a, draw.below(3));
        turn_vertices(p.b, draw.below(3));
        const std::uint32_t swaps = draw.below(8);
        if ((swaps & 1U) != 0) {
            std::swap(p.a[0], p.a[1]);
        }
        if ((swaps & 2U) != 0) {
            std::swap(p.b[0], p.b[1]);
        }
        if ((swaps & 4U) != 0) {
            std::swap(p.a, p.b);
        }
        return;
    }
    const auto at = static_cast<std::uint32_t>(axis);
    if (axis == 1 || axis >= 14) {
        std::swap(p.a, p.b);
    }
    if (axis >= 2 && axis <= 10) {  // the edges that cross run from vertex 0 to vertex 1
        turn_vertices(p.a, (at - 2) / 3);
        turn_vertices(p.b, (at - 2) % 3);
    } else if (axis >= 11) {
        turn_vertices(axis < 14 ? p.a : p.b, (at - 11) % 3);
    }
}

double rounded_to_eighths(double x) {
    return std::floor(x * 8 + 0.5) / 8;
}

/// Scales, turns and moves the shape. Returns the direction of its gap.
Vec3d place_pair(Draw& draw, const Category& c, Raw& p) {
    double r[3][3], offset[3] = {0, 0, 0};
    make_turn(draw, c.place, r);
    if (c.offset_mm > 0) {
        for (double& x : offset) {
            x = draw.between(-c.offset_mm, c.offset_mm);
            x = c.place == Place::quarter || c.place == Place::grid ? std::floor(x) : x;
        }
    }
    const bool on_grid = c.place == Place::grid;
    const bool rounds_y = !is_flat(c.shape) || draw.below(2) == 0;
    for (int i = 0; i < 6; ++i) {
        Vec3d& v = i < 3 ? p.a[i] : p.b[i - 3];
        const double size = i < 3 ? c.size_mm : c.size_mm * c.ratio;
        if (on_grid) {
            v.x = rounded_to_eighths(v.x);
            v.y = rounds_y ? rounded_to_eighths(v.y) : v.y;
        }
        const double x[3] = {size * v.x, size * v.y, (i < 3 ? size : c.size_mm) * v.z};
        double moved[3];
        for (int k = 0; k < 3; ++k) {
            moved[k] = r[k][0] * x[0] + r[k][1] * x[1] + r[k][2] * x[2] + offset[k];
        }
        v = {moved[0], moved[1], moved[2]};
    }
    const int along = is_flat(c.shape) ? 1 : 2;
    return {r[0][along], r[1][along], r[2][along]};
}

template <class T>
T* coordinate_of(Pair<T>& p, std::uint32_t i) {
    Vec3<T>& v = i < 9 ? p.a[i / 3] : p.b[i / 3 - 3];
    return i % 3 == 0 ? &v.x : i % 3 == 1 ? &v.y : &v.z;
}

/// Moves vertices by up to three representable values, so that relative to a's first vertex they
/// round apart along `normal`: b along it, a against it.
template <class T>
void round_apart(Pair<T>& p, const Vec3d& normal) {
    const double push[3] = {normal.x, normal.y, normal.z};
    for (std::uint32_t i = 3; i < 18; ++i) {
        T* const x = coordinate_of(p, i);
        const T origin = *coordinate_of(p, i % 3);
        const double wanted = i < 9 ? -push[i % 3] : push[i % 3];
        T best = *x, tried = *x;
        double most = -1;
        for (int step = 0; step < 4; ++step) {
            const T local = tried - origin;
            const T back = local - tried;
            const T missing = (tried - (local - back)) - (origin + back);  // exactly (Knuth)
            const double gained = -static_cast<double>(missing) * wanted;
            if (gained > most) {
                most = gained;
                best = tried;
            }
            tried = std::nextafter(tried, static_cast<T>(HUGE_VAL));
        }
        *x = best;
    }
}

/// Replaces triangles by segments and points.
void flatten(int flat, Raw& p) {
    if (flat == 1 || flat == 3) {
        p.b[2] = p.b[1];
    }
    if (flat == 2 || flat == 4) {
        p.b[1] = p.b[2] = p.b[0];
    }
    if (flat == 3) {
        p.a[2] = p.a[0];
    }
    if (flat == 4) {
        p.a[1] = p.a[2] = p.a[0];
    }
}

template <class T>
Vec3<T> rounded(const Vec3d& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}

Draw draw_for(std::size_t category, std::uint64_t seed, std::uint64_t index) {
    Draw mixed(seed ^ (category + 1) * 0xd1342543de82ef95U);
    return Draw(mixed.bits() + index * 0xa24baed4963ee407U);
}

}  // namespace

std::size_t pair_category_count() noexcept {
    return std::size(kCategories);
}
const char* pair_category_name(std::size_t category) noexcept {
    return kCategories[category].name;
}
int pair_category_axis(std::size_t category) noexcept {
    return kCategories[category].axis;
}

template <class T>
Pair<T> make_pair_case(std::size_t category, std::uint64_t seed, std::uint64_t index) noexcept {
    const Category& c = kCategories[category];
    Draw draw = draw_for(category, seed, index);
    const unsigned finest = sizeof(T) == sizeof(float) ? 30 : 60;
    Raw raw = make_shape(draw, c, draw_gap(draw, c, finest));
    flatten(c.flat, raw);
    if (!c.one_way) {  // round_apart needs a's first vertex in its place of the shape
        order_vertices(draw, c.axis, raw);
    }
    const Vec3d normal = place_pair(draw, c, raw);
    Pair<T> out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = rounded<T>(raw.a[i]);
        out.b[i] = rounded<T>(raw.b[i]);
    }
    if (c.one_way) {
        round_apart(out, normal);
    }
    for (int i = 0; i < c.nudges; ++i) {
        T* const x = coordinate_of(out, draw.below(18));
        *x = std::nextafter(*x, static_cast<T>(draw.sign() * HUGE_VAL));
    }
    return out;
}
template Pair<float> make_pair_case(std::size_t, std::uint64_t, std::uint64_t) noexcept;
template Pair<double> make_pair_case(std::size_t, std::uint64_t, std::uint64_t) noexcept;

PosedPair make_posed_case(std::size_t category, std::uint64_t seed, std::uint64_t index) noexcept {
    PosedPair out;
    out.pair = make_pair_case<float>(category, seed, index);
    Draw draw = draw_for(category, ~seed, index);
    any_turn(draw, out.pose.r);
    for (double& t : out.pose.t) {
        t = draw.between(-500, 500);
    }
    const Pose back = inverse(out.pose);
    for (Vec3f& v : out.pair.a) {
        v = rounded<float>(apply(back, widen(v)));
    }
    return out;
}

}  // namespace axg::lab
