// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles made to be hard to tell apart: contacts of every kind at a chosen gap, thin,
// parallel, coplanar, degenerate, tiny, large, far away. Coordinates come out in double; round them
// to the format under test, and judge what was rounded.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "core/base/pose.hpp"
#include "tests/support/between.hpp"

namespace axg::test {

enum class Contact { face_vertex, edges, edge_vertex, vertices, faces, coplanar, random, pierced };

struct CaseKind {
    const char* name;
    Contact contact;
    double scale_mm = 10;   // size of the triangles
    double aspect = 1;      // 1e-6: slivers
    double angle_rad = -1;  // between the two edges of Contact::edges; negative: any
    double offset_mm = 0;   // of both from the origin
    bool on_grid = false;   // not turned, coordinates on a coarse grid, mostly touching exactly
    int flat = 0;           // 1: b shrinks to a segment, 2: to a point, 3: both to segments
};

inline constexpr CaseKind kCaseKinds[] = {
    {.name = "random", .contact = Contact::random},
    {.name = "pierced", .contact = Contact::pierced},
    {.name = "vertex-face", .contact = Contact::face_vertex},
    {.name = "vertex-face 300 mm", .contact = Contact::face_vertex, .scale_mm = 300},
    {.name = "vertex-face sliver 1e3", .contact = Contact::face_vertex, .aspect = 1e-3},
    {.name = "vertex-face sliver 1e6", .contact = Contact::face_vertex, .aspect = 1e-6},
    {.name = "edge-edge", .contact = Contact::edges},
    {.name = "edge-edge sliver 1e4", .contact = Contact::edges, .aspect = 1e-4},
    {.name = "near-parallel edges 1e-3", .contact = Contact::edges, .angle_rad = 1e-3},
    {.name = "near-parallel edges 1e-6", .contact = Contact::edges, .angle_rad = 1e-6},
    {.name = "parallel edges", .contact = Contact::edges, .angle_rad = 0},
    {.name = "parallel edges 1 m", .contact = Contact::edges, .scale_mm = 1e3, .angle_rad = 0},
    {.name = "vertex-edge", .contact = Contact::edge_vertex},
    {.name = "vertex-edge sliver 1e5", .contact = Contact::edge_vertex, .aspect = 1e-5},
    {.name = "vertex-vertex", .contact = Contact::vertices},
    {.name = "parallel faces", .contact = Contact::faces},
    {.name = "parallel faces 1e3 from the origin", .contact = Contact::faces, .offset_mm = 1e3},
    {.name = "coplanar", .contact = Contact::coplanar},
    {.name = "coplanar on the grid", .contact = Contact::coplanar, .on_grid = true},
    {.name = "vertex on face, grid", .contact = Contact::face_vertex, .on_grid = true},
    {.name = "edges crossing, grid", .contact = Contact::edges, .on_grid = true},
    {.name = "vertex on edge, grid", .contact = Contact::edge_vertex, .on_grid = true},
    {.name = "shared vertex, grid", .contact = Contact::vertices, .on_grid = true},
    {.name = "shared plane, grid", .contact = Contact::faces, .on_grid = true},
    {.name = "tiny 1e-4", .contact = Contact::face_vertex, .scale_mm = 1e-4},
    {.name = "tiny 1e-12", .contact = Contact::edges, .scale_mm = 1e-12},
    {.name = "subnormal", .contact = Contact::face_vertex, .scale_mm = 1e-43},
    {.name = "large 1e4", .contact = Contact::edges, .scale_mm = 1e4},
    {.name = "large 1e5", .contact = Contact::face_vertex, .scale_mm = 1e5},
    {.name = "far 1e5", .contact = Contact::edge_vertex, .offset_mm = 1e5},
    {.name = "far 1e4 edges", .contact = Contact::edges, .offset_mm = 1e4},
    {.name = "segment on face", .contact = Contact::face_vertex, .flat = 1},
    {.name = "point on face", .contact = Contact::face_vertex, .flat = 2},
    {.name = "segments", .contact = Contact::edges, .flat = 3},
    {.name = "segments in a plane, grid", .contact = Contact::coplanar, .on_grid = true, .flat = 3},
};

struct TriangleCase {
    std::array<std::array<double, 3>, 3> a, b;
};

/// A rotation from a random unit quaternion; rigid to a few 2^-53.
inline Pose random_turn(std::mt19937_64& random) {
    double q[4], square = 0;
    do {
        square = 0;
        for (double& x : q) {
            x = between(random, -1, 1);
            square += x * x;
        }
    } while (square > 1 || square < 1e-3);
    const double f = 2 / square;
    Pose p;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        p.r[i][i] = 1 - f * (q[j] * q[j] + q[k] * q[k]);
        p.r[i][j] = f * (q[i] * q[j] - q[k] * q[3]);
        p.r[j][i] = f * (q[i] * q[j] + q[k] * q[3]);
    }
    return p;
}

/// The contact before it is scaled, turned and moved: nearest points at the origin and (0, 0, gap),
/// sizes about 1. `gap` may be negative: then they overlap, or nearly so.
inline TriangleCase contact_at(std::mt19937_64& random, const CaseKind& kind, double gap) {
    const auto some = [&random](double low, double high) { return between(random, low, high); };
    const double thin = kind.aspect;
    const double turn = kind.angle_rad >= 0 ? kind.angle_rad : some(0, 6.28);
    const double c = std::cos(turn), s = std::sin(turn);
    const double down = -some(0.2, 1), up = gap + some(0.2, 1), down2 = -some(0.2, 1);
    switch (kind.contact) {
        case Contact::face_vertex:
            return {
                {{{-some(0.3, 1), -0.5 * thin, 0}, {1, -some(0.1, 0.4) * thin, 0}, {0, thin, 0}}},
                {{{0, 0, gap}, {some(-1, 1), some(-1, 1), up}, {some(-1, 1), 0.3, up}}}};
        case Contact::edges:
            return {{{{-some(0.2, 1), 0, 0}, {some(0.2, 1), 0, 0}, {0.1, 0.3 * thin, down * thin}}},
                    {{{-c, -s, gap}, {c, s, gap}, {0.2, 0.1, gap + (up - gap) * thin}}}};
        case Contact::edge_vertex:
            return {
                {{{-some(0.2, 1), 0, 0}, {some(0.2, 1), 0, 0}, {0.1, some(-1, 1), down * thin}}},
                {{{0, 0, gap}, {c, s * thin, up}, {some(-1, 1), 0.3 * thin, up}}}};
        case Contact::vertices:
            return {{{{0, 0, 0}, {some(-1, 1), some(-1, 1), down}, {some(-1, 1), 0.5, down2}}},
                    {{{0, 0, gap}, {some(-1, 1), some(-1, 1), up}, {some(-1, 1), 0.25, up}}}};
        case Contact::faces:
            return {{{{-1, -some(0.2, 1), 0}, {1, -0.5, 0}, {some(-1, 1), thin, 0}}},
                    {{{-c, -s, gap}, {c, s, gap}, {-s, c, gap}}}};
        case Contact::coplanar:
            return {{{{-1, 0, 0}, {1, 0, 0}, {some(-1, 1), 0, down}}},
                    {{{-some(0, 1), 0, gap}, {some(0, 1), 0, up}, {some(-2, 2), 0, up}}}};
        case Contact::pierced:
            return {{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}},
                    {{{0, 0, -gap}, {some(-1, 1), some(-1, 1), 1}, {0.1, -0.2, some(-1, 1)}}}};
        case Contact::random:
            break;
    }
    TriangleCase out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out.a[i][k] = some(-1, 1);
            out.b[i][k] = some(-1, 1) + (k == 2 ? gap : 0);
        }
    }
    return out;
}

/// One pair of that kind. Its gap is 0, or a power of two from 2^finest to 2^4 mm of either sign.
inline TriangleCase make_case(std::mt19937_64& random, const CaseKind& kind, int finest) {
    double gap_mm = std::ldexp(1.0, static_cast<int>(random() % (5U - finest)) + finest);
    gap_mm *= (random() & 3U) == 0 ? -1 : 1;
    if ((random() & 7U) == 0) {
        gap_mm = 0;
    }
    if (kind.scale_mm < 1e-6) {
        gap_mm *= kind.scale_mm;
    }
    if (kind.on_grid && (random() & 3U) != 0) {
        gap_mm = 0;
    }
    TriangleCase out = contact_at(random, kind, gap_mm / kind.scale_mm);
    if (kind.flat == 1 || kind.flat == 3) {
        out.b[2] = out.b[1];
    }
    if (kind.flat == 2) {
        out.b[1] = out.b[2] = out.b[0];
    }
    if (kind.flat == 3) {
        out.a[2] = out.a[0];
    }
    Pose turn;
    double offset[3] = {0, 0, 0};
    if (!kind.on_grid) {
        turn = random_turn(random);
        for (double& x : offset) {
            x = between(random, -kind.offset_mm, kind.offset_mm);
        }
    }
    for (auto* triangle : {&out.a, &out.b}) {
        for (auto& v : *triangle) {
            if (kind.on_grid) {
                for (std::size_t k = 0; k < 2; ++k) {
                    v[k] = std::round(v[k] * 8) / 8;
                }
            }
            const Vec3d p = rotate(turn, {v[0], v[1], v[2]});
            v = {kind.scale_mm * p.x + offset[0], kind.scale_mm * p.y + offset[1],
                 kind.scale_mm * p.z + offset[2]};
        }
    }
    return out;
}

}  // namespace axg::test
