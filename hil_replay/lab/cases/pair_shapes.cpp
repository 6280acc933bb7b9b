// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/cases/pair_shapes.hpp"

#include <cmath>
#include <iterator>

#include "core/base/sincos.hpp"
#include "hil_replay/lab/cases/climbed_pairs.hpp"

namespace axg::lab {

namespace {

using Raw = Pair<double>;

// No expression contains two draws: the compiler may evaluate operands in any order.

/// Direction of b's edge against the x axis.
void edge_direction(Draw& draw, int angle_bits, double& c, double& s) {
    if (angle_bits == kParallel) {
        c = 1, s = 0;
    } else if (angle_bits >= 0) {
        const double side = draw.sign();
        c = 1, s = side * std::ldexp(draw.between(0.5, 1), -angle_bits);
    } else {
        const double side = draw.sign();
        c = draw.between(-1, 1), s = side * draw.between(0.3, 1);
    }
}

/// A point of the rim of a disc of `count` facets.
Vec3d rim(std::uint32_t at, std::uint32_t count, double radius) {
    const SinCos turn = sin_cos(2 * kPi * static_cast<double>(at) / static_cast<double>(count));
    return {radius * turn.cos, radius * turn.sin, 0};
}

Raw fan(Draw& draw, bool next) {
    const std::uint32_t count = 12 + draw.below(60), at = draw.below(count);
    const std::uint32_t other = next ? at + 1 : at + 2 + draw.below(count / 2);
    const double cone = draw.below(2) == 0 ? 0 : draw.between(-0.3, 0.3);
    const Vec3d hub{0, 0, cone};
    return {{hub, rim(at, count, 1), rim(at + 1, count, 1)},
            {hub, rim(other, count, 1), rim(other + 1, count, 1)}};
}

Vec3d lattice_point(Draw& draw) {
    const auto x = [&draw] { return static_cast<double>(draw.below(7)) - 3; };
    return {x(), x(), x()};
}

/// One triangle of a side of a box, on the micrometre grid; sides face x, y or z.
void box_side(Draw& draw, int axis, double at_um, Vec3d (&t)[3]) {
    const auto um = [&draw](std::uint32_t most) { return static_cast<double>(draw.below(most)); };
    const double u0 = um(2000) - 1000, v0 = um(2000) - 1000;
    const double u1 = u0 + 1 + um(40000), v1 = v0 + 1 + um(40000);
    const double corners[3][2] = {{u0, v0}, {u1, v0}, {draw.below(2) == 0 ? u0 : u1, v1}};
    for (int i = 0; i < 3; ++i) {
        double p[3];
        p[axis] = at_um / 1000;
        p[(axis + 1) % 3] = corners[i][0] / 1000;
        p[(axis + 2) % 3] = corners[i][1] / 1000;
        t[i] = {p[0], p[1], p[2]};
    }
}

Raw cad_faces(Draw& draw) {
    Raw out;
    const int axis = static_cast<int>(draw.below(3));
    const double at_um = static_cast<double>(draw.below(60000)) - 30000;
    const double step_um = draw.below(3) == 0 ? 0 : static_cast<double>(draw.below(5)) - 2;
    box_side(draw, axis, at_um, out.a);
    if (draw.below(3) == 0) {
        box_side(draw, (axis + 1) % 3, static_cast<double>(draw.below(4000)) - 2000, out.b);
    } else {
        box_side(draw, axis, at_um + step_um, out.b);
    }
    return out;
}

/// A facet of a cutter of radius 4 mm next to the wall x = 4 mm + gap, in units of the category's
/// size (10 mm).
Raw slot(Draw& draw, double gap) {
    constexpr double kRadius = 0.4;
    const std::uint32_t count = 24 + 8 * draw.below(6), at = draw.below(2);
    const double low = draw.between(-1, 0), high = draw.between(0.5, 4);
    const Vec3d from = rim(count - 1 + at, count, kRadius), to = rim(count + at, count, kRadius);
    const double wall = kRadius + gap, along = draw.between(-3, 3);
    return {
        {{from.x, from.y + along, low}, {to.x, to.y + along, low}, {from.x, from.y + along, high}},
        {{wall, -5, -2}, {wall, 5, -2}, {wall, draw.below(2) == 0 ? 5.0 : -5.0, 1}}};
}

Raw climbed(Draw& draw) {
    const auto count = static_cast<std::uint32_t>(std::size(kClimbedPairs));
    const Pair<float>& from = kClimbedPairs[draw.below(count)];
    Raw out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = widen(from.a[i]);
        out.b[i] = widen(from.b[i]);
    }
    return out;
}

Raw small_turn(Draw& draw) {
    constexpr double kStepRad = kPi / 180e3;
    const SinCos step = sin_cos(kStepRad * static_cast<double>(1 + draw.below(100)));
    Raw out;
    const double lift = draw.below(2) == 0 ? 0 : std::ldexp(1.0, -static_cast<int>(draw.below(24)));
    for (int i = 0; i < 3; ++i) {
        const Vec3d p{draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)};
        out.a[i] = p;
        out.b[i] = {step.cos * p.x - step.sin * p.y, step.sin * p.x + step.cos * p.y, p.z + lift};
    }
    return out;
}

/// Shapes in the plane z = 0.
Raw flat_shape(Draw& draw, const Category& c, double gap) {
    const auto some = [&draw](double low, double high) { return draw.between(low, high); };
    switch (c.shape) {
        case Shape::flat_vertex:
            return {{{-some(0.3, 1), 0, 0},
                     {some(0.3, 1), 0, 0},
                     {some(-1, 1), -some(0.2, 1) * c.aspect, 0}},
                    {{0, gap, 0},
                     {-some(0.1, 1), gap + some(0.2, 1) * c.aspect, 0},
                     {some(0.1, 1), gap + some(0.2, 1) * c.aspect, 0}}};
        case Shape::flat_inside:
            return {{{-1, -1, 0}, {1, -1, 0}, {some(-1, 1), 1, 0}},
                    {{0, 0, 0}, {some(0, 0.2), some(-0.5, 0), 0}, {some(-0.2, 0), gap, 0}}};
        case Shape::flat_edges:
            return {{{-some(0, 1), 0, 0}, {some(0, 1), 0, 0}, {some(-1, 1), -some(0.2, 1), 0}},
                    {{some(-2, 0), gap, 0},
                     {some(0, 2), gap, 0},
                     {some(-1, 1), gap + some(0.2, 1), 0}}};
        default:
            break;
    }
    Raw out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {some(-1, 1), some(-1, 1), 0};
        out.b[i] = {some(-1, 1), some(-1, 1) + gap, 0};
    }
    return out;
}

/// Shapes in space whose nearest points are at the origin and (0, 0, gap).
Raw contact_shape(Draw& draw, const Category& c, double gap) {
    const auto some = [&draw](double low, double high) { return draw.between(low, high); };
    const double thin = c.aspect, up = gap + some(0.2, 1), up2 = gap + some(0.2, 1);
    const double down = -some(0.2, 1);
    double along = 0, across = 0;
    edge_direction(draw, c.angle_bits, along, across);
    switch (c.shape) {
        case Shape::face_vertex:
            return {{{-some(0.3, 1), -0.5 * thin, 0},
                     {1, -some(0.1, 0.4) * thin, 0},
                     {some(-0.2, 0.2), thin, 0}},
                    {{0, 0, gap}, {some(-1, 1), some(-1, 1), up}, {some(-1, 1), some(-1, 1), up2}}};
        case Shape::edges: {
            const double before = some(0.2, 1), after = some(0.2, 1);
            return {{{-some(0.2, 1), 0, 0}, {some(0.2, 1), 0, 0}, {0.1, 0.3 * thin, down * thin}},
                    {{-before * along, -before * across, gap},
                     {after * along, after * across, gap},
                     {0.2, 0.1 * thin, gap + (up - gap) * thin}}};
        }
        case Shape::edge_vertex:
            return {{{-some(0.2, 1), 0, 0}, {some(0.2, 1), 0, 0}, {0.1, some(-1, 1), down * thin}},
                    {{0, 0, gap}, {along, across * thin, up}, {some(-1, 1), 0.3 * thin, up2}}};
        case Shape::vertices:
            return {{{0, 0, 0},
                     {some(-1, 1), some(-1, 1) * thin, down},
                     {some(-1, 1) * thin, 0.5 * thin, 1.5 * down}},
                    {{0, 0, gap},
                     {some(-1, 1), some(-1, 1) * thin, up},
                     {some(-1, 1) * thin, 0.25 * thin, up2}}};
        case Shape::tilted_faces:
            across = draw.sign();
            across = std::ldexp(across, -2 - static_cast<int>(draw.below(26)));
            return {{{-1, -some(0.2, 1), 0}, {1, -0.5, 0}, {some(-1, 1), 1, 0}},
                    {{some(-1, 1), some(-1, 1), gap},
                     {some(-1, 1), some(-1, 1), gap},
                     {some(-1, 1), some(-1, 1), gap + across}}};
        case Shape::pierced:
            return {{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
                    {{0, 0, -gap},
                     {some(-1, 1) * thin, some(-1, 1) * thin, 1},
                     {0.1 * thin, -0.2 * thin, some(-1, 1)}}};
        default:
            break;
    }
    return {{{-1, -some(0.2, 1), 0}, {1, -0.5 * thin, 0}, {some(-1, 1), thin, 0}},
            {{-some(0.1, 1), -some(0.1, 1) * thin, gap},
             {some(0.1, 1), -some(0, 0.1) * thin, gap},
             {some(-1, 1), some(0.1, 1) * thin, gap}}};
}

}  // namespace

Raw make_shape(Draw& draw, const Category& c, double gap) {
    Raw out;
    switch (c.shape) {
        case Shape::flat_vertex:
        case Shape::flat_loose:
        case Shape::flat_inside:
        case Shape::flat_edges:
            return flat_shape(draw, c, gap);
        case Shape::fan_edge:
        case Shape::fan_vertex:
            return fan(draw, c.shape == Shape::fan_edge);
        case Shape::cad_faces:
            return cad_faces(draw);
        case Shape::climbed:
            return climbed(draw);
        case Shape::slot:
            return slot(draw, gap);
        case Shape::small_turn:
            return small_turn(draw);
        case Shape::loose:
        case Shape::same:
        case Shape::lattice:
            for (int i = 0; i < 3; ++i) {
                const auto some = [&draw] { return draw.between(-1, 1); };
                const bool whole = c.shape == Shape::lattice;
                out.a[i] = whole ? lattice_point(draw) : Vec3d{some(), some(), some()};
                out.b[i] = whole ? lattice_point(draw) : Vec3d{some(), some(), some() + gap};
                out.b[i] = c.shape == Shape::same ? out.a[i] : out.b[i];
            }
            return out;
        default:
            return contact_shape(draw, c, gap);
    }
}

}  // namespace axg::lab
