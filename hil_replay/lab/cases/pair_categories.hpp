// SPDX-License-Identifier: Apache-2.0
// The table of the categories of pair_cases.hpp: kind of contact, gap, and placement of the pair.
// Sizes and offsets in mm.
#pragma once

namespace axg::lab {

/// The contact before a pair is turned and moved: nearest points at the origin and (0, 0, gap), a
/// below, b above; for shapes in one plane (0, gap, 0), a at y <= 0. Sizes about 1.
enum class Shape {
    loose,  // anywhere
    pierced,
    face_vertex,
    edge_vertex,
    vertices,
    edges,
    faces,
    tilted_faces,
    flat_vertex,  // one plane, a vertex against an edge
    flat_loose,   // one plane, anywhere
    flat_inside,  // one plane, b inside a
    flat_edges,   // one plane, edges on one line
    same,
    fan_edge,    // two neighbours of a fan
    fan_vertex,  // two of a fan that share only its hub
    lattice,     // whole coordinates
    cad_faces,   // sides of two boxes on the micrometre grid
    slot,        // a facet of a cutter next to the wall of its slot
    climbed,     // a final pair of a hill climb
    small_turn,  // a triangle and itself, turned by 1 to 100 steps of a rotary axis
};

enum class Gap {
    none,
    powers,      // 0 or 2^-k of the size, of either sign
    apart,       // 2^-k of the size, k from 11 to 22 (double: 37): truly apart
    micrometre,  // 2^-8 to 128 um, of either sign
};

enum class Place {
    turned,    // any rotation, rounded
    quarter,   // signed permutation of the axes: exact
    grid,      // as quarter, of coordinates rounded to eighths
    rational,  // an integer rotation, divided by its length: rounded
    scaled,    // an integer rotation, not divided: exact on whole coordinates
    trunnion,  // two rotary axes in steps of 0.001 degrees, rounded
    as_is,
};

struct Category {
    const char* name;
    Shape shape;
    Gap gap = Gap::powers;
    Place place = Place::turned;
    double size_mm = 10;
    double ratio = 1;     // size of b over that of a
    double aspect = 1;    // 1e-6: slivers
    int angle_bits = -1;  // edges cross at an angle of 2^-bits or less, 99: 0; -1: any
    double offset_mm = 0;
    int nudges = 0;        // coordinates moved by one representable value at the end
    bool one_way = false;  // vertices chosen to round apart relative to an origin
    int flat = 0;          // 1: b is a segment, 2: a point, 3: both segments, 4: both points
    int axis = -1;         // pair_category_axis
};

inline constexpr int kParallel = 99;

inline constexpr Category kCategories[] = {
    {.name = "loose", .shape = Shape::loose},
    {.name = "loose, 1e3 mm away", .shape = Shape::loose, .offset_mm = 1e3},
    {.name = "loose, 1e-3 against 1", .shape = Shape::loose, .ratio = 1e-3},
    {.name = "pierced", .shape = Shape::pierced},
    {.name = "pierced by a needle", .shape = Shape::pierced, .aspect = 1e-5},

    {.name = "vertex on face", .shape = Shape::face_vertex},
    {.name = "vertex on face, 300 mm", .shape = Shape::face_vertex, .size_mm = 300},
    {.name = "vertex on face, 1 m", .shape = Shape::face_vertex, .size_mm = 1e3},
    {.name = "vertex on sliver 1e2", .shape = Shape::face_vertex, .aspect = 1e-2},
    {.name = "vertex on sliver 1e4", .shape = Shape::face_vertex, .aspect = 1e-4},
    {.name = "vertex on sliver 1e6", .shape = Shape::face_vertex, .aspect = 1e-6},
    {.name = "vertex on face, grid", .shape = Shape::face_vertex, .place = Place::grid},
    {.name = "vertex on face, grid, nudged",
     .shape = Shape::face_vertex,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .offset_mm = 64,
     .nudges = 2},
    {.name = "vertex on face, grid, nudged at zero",
     .shape = Shape::face_vertex,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .nudges = 2},
    {.name = "vertex on face, 1e3 mm away", .shape = Shape::face_vertex, .offset_mm = 1e3},
    {.name = "vertex on face, 1e5 mm away", .shape = Shape::face_vertex, .offset_mm = 1e5},
    {.name = "small vertex on large face",
     .shape = Shape::face_vertex,
     .size_mm = 1e3,
     .ratio = 1e-4},
    {.name = "large vertex on small face",
     .shape = Shape::face_vertex,
     .size_mm = 0.1,
     .ratio = 1e4},
    {.name = "vertex on face, one way", .shape = Shape::face_vertex, .one_way = true},

    {.name = "edges", .shape = Shape::edges},
    {.name = "edges of slivers 1e4", .shape = Shape::edges, .aspect = 1e-4},
    {.name = "edges of slivers 1e6", .shape = Shape::edges, .aspect = 1e-6},
    {.name = "needles along one another", .shape = Shape::edges, .aspect = 1e-5, .angle_bits = 16},
    {.name = "edges, angle 2^-6", .shape = Shape::edges, .angle_bits = 6},
    {.name = "edges, angle 2^-12", .shape = Shape::edges, .angle_bits = 12},
    {.name = "edges, angle 2^-20", .shape = Shape::edges, .angle_bits = 20},
    {.name = "edges, angle 2^-26", .shape = Shape::edges, .size_mm = 100, .angle_bits = 26},
    {.name = "parallel edges", .shape = Shape::edges, .angle_bits = kParallel},
    {.name = "parallel edges, 1 m", .shape = Shape::edges, .size_mm = 1e3, .angle_bits = kParallel},
    {.name = "edges, grid", .shape = Shape::edges, .place = Place::grid},
    {.name = "edges, grid, nudged",
     .shape = Shape::edges,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .offset_mm = 64,
     .nudges = 2},
    {.name = "edges, 1e4 mm away", .shape = Shape::edges, .offset_mm = 1e4},
    {.name = "edges, one way", .shape = Shape::edges, .one_way = true},

    {.name = "vertex on edge", .shape = Shape::edge_vertex},
    {.name = "vertex on edge of sliver 1e5", .shape = Shape::edge_vertex, .aspect = 1e-5},
    {.name = "vertex on edge, grid", .shape = Shape::edge_vertex, .place = Place::grid},
    {.name = "vertex on edge, grid, nudged",
     .shape = Shape::edge_vertex,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .offset_mm = 64,
     .nudges = 2},
    {.name = "vertex on edge, 1e5 mm away", .shape = Shape::edge_vertex, .offset_mm = 1e5},
    {.name = "vertex on vertex", .shape = Shape::vertices},
    {.name = "tips of needles", .shape = Shape::vertices, .aspect = 1e-6},
    {.name = "shared vertex, grid", .shape = Shape::vertices, .place = Place::grid},
    {.name = "shared vertex, grid, nudged",
     .shape = Shape::vertices,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .offset_mm = 64,
     .nudges = 3},
    {.name = "shared vertex, turned", .shape = Shape::vertices, .gap = Gap::none, .offset_mm = 100},

    {.name = "parallel faces", .shape = Shape::faces},
    {.name = "parallel faces, 300 mm", .shape = Shape::faces, .size_mm = 300},
    {.name = "parallel faces, 1e3 mm away", .shape = Shape::faces, .offset_mm = 1e3},
    {.name = "parallel slivers", .shape = Shape::faces, .aspect = 1e-5},
    {.name = "parallel faces, grid", .shape = Shape::faces, .place = Place::grid},
    {.name = "one plane, grid, nudged",
     .shape = Shape::faces,
     .gap = Gap::none,
     .place = Place::grid,
     .size_mm = 8,
     .offset_mm = 64,
     .nudges = 3},
    {.name = "nearly parallel faces", .shape = Shape::tilted_faces},
    {.name = "parallel faces, one way", .shape = Shape::faces, .one_way = true},

    {.name = "one plane, vertex at edge",
     .shape = Shape::flat_vertex,
     .place = Place::quarter,
     .offset_mm = 100},
    {.name = "one plane, anywhere", .shape = Shape::flat_loose, .place = Place::quarter},
    {.name = "one plane, grid", .shape = Shape::flat_loose, .place = Place::grid},
    {.name = "one plane, b inside", .shape = Shape::flat_inside, .place = Place::quarter},
    {.name = "one plane, edges on one line", .shape = Shape::flat_edges, .place = Place::quarter},
    {.name = "one plane, edges, grid", .shape = Shape::flat_edges, .place = Place::grid},
    {.name = "one plane, slivers",
     .shape = Shape::flat_vertex,
     .place = Place::quarter,
     .aspect = 1e-5},
    {.name = "one plane, turned and rounded", .shape = Shape::flat_vertex, .offset_mm = 100},
    {.name = "one plane, rational turn",
     .shape = Shape::flat_edges,
     .place = Place::rational,
     .offset_mm = 100},
    {.name = "identical", .shape = Shape::same, .gap = Gap::none},
    {.name = "identical, nudged", .shape = Shape::same, .gap = Gap::none, .nudges = 4},

    {.name = "only normal of a", .shape = Shape::face_vertex, .gap = Gap::apart, .axis = 0},
    {.name = "only normal of b", .shape = Shape::face_vertex, .gap = Gap::apart, .axis = 1},
    {.name = "only edges 0, 0", .shape = Shape::edges, .gap = Gap::apart, .axis = 2},
    {.name = "only edges 0, 1", .shape = Shape::edges, .gap = Gap::apart, .axis = 3},
    {.name = "only edges 0, 2", .shape = Shape::edges, .gap = Gap::apart, .axis = 4},
    {.name = "only edges 1, 0", .shape = Shape::edges, .gap = Gap::apart, .axis = 5},
    {.name = "only edges 1, 1", .shape = Shape::edges, .gap = Gap::apart, .axis = 6},
    {.name = "only edges 1, 2", .shape = Shape::edges, .gap = Gap::apart, .axis = 7},
    {.name = "only edges 2, 0", .shape = Shape::edges, .gap = Gap::apart, .axis = 8},
    {.name = "only edges 2, 1", .shape = Shape::edges, .gap = Gap::apart, .axis = 9},
    {.name = "only edges 2, 2", .shape = Shape::edges, .gap = Gap::apart, .axis = 10},
    {.name = "only in-plane 0 of a",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 11},
    {.name = "only in-plane 1 of a",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 12},
    {.name = "only in-plane 2 of a",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 13},
    {.name = "only in-plane 0 of b",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 14},
    {.name = "only in-plane 1 of b",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 15},
    {.name = "only in-plane 2 of b",
     .shape = Shape::flat_vertex,
     .gap = Gap::apart,
     .place = Place::quarter,
     .axis = 16},

    {.name = "neighbours in a fan", .shape = Shape::fan_edge, .gap = Gap::none},
    {.name = "neighbours in a fan, 200 mm away",
     .shape = Shape::fan_edge,
     .gap = Gap::none,
     .size_mm = 40,
     .offset_mm = 200,
     .nudges = 1},
    {.name = "hub of a fan", .shape = Shape::fan_vertex, .gap = Gap::none, .size_mm = 40},
    {.name = "lattice, integer turn",
     .shape = Shape::lattice,
     .gap = Gap::none,
     .place = Place::scaled,
     .size_mm = 1},
    {.name = "lattice, rational turn",
     .shape = Shape::lattice,
     .gap = Gap::none,
     .place = Place::rational,
     .size_mm = 1},
    {.name = "sides of boxes, micrometre grid",
     .shape = Shape::cad_faces,
     .gap = Gap::none,
     .place = Place::as_is},
    {.name = "cutter in a slot",
     .shape = Shape::slot,
     .gap = Gap::micrometre,
     .place = Place::as_is},
    {.name = "trunnion, vertex on face",
     .shape = Shape::face_vertex,
     .gap = Gap::micrometre,
     .place = Place::trunnion,
     .size_mm = 40,
     .offset_mm = 400},
    {.name = "trunnion, edges",
     .shape = Shape::edges,
     .gap = Gap::micrometre,
     .place = Place::trunnion,
     .size_mm = 100,
     .offset_mm = 400},
    {.name = "small steps of a rotary axis",
     .shape = Shape::small_turn,
     .gap = Gap::none,
     .size_mm = 100,
     .offset_mm = 200},

    {.name = "tiny 1e-4", .shape = Shape::face_vertex, .size_mm = 1e-4},
    {.name = "tiny 1e-12", .shape = Shape::edges, .size_mm = 1e-12},
    {.name = "tiny 1e-20", .shape = Shape::face_vertex, .size_mm = 1e-20},
    {.name = "tiny 1e-30", .shape = Shape::edge_vertex, .size_mm = 1e-30},
    {.name = "subnormal", .shape = Shape::face_vertex, .size_mm = 1e-43},
    {.name = "subnormal edges", .shape = Shape::edges, .size_mm = 1e-39},
    {.name = "subnormal against 1 mm", .shape = Shape::vertices, .size_mm = 1, .ratio = 1e-42},
    {.name = "large 1e4", .shape = Shape::edges, .size_mm = 1e4},
    {.name = "large 1e5", .shape = Shape::face_vertex, .size_mm = 9e4},
    {.name = "large 1e5 against small", .shape = Shape::edges, .size_mm = 9e4, .ratio = 1e-6},

    {.name = "segment on face", .shape = Shape::face_vertex, .flat = 1},
    {.name = "point on face", .shape = Shape::face_vertex, .flat = 2},
    {.name = "point on edge, grid", .shape = Shape::edge_vertex, .place = Place::grid, .flat = 2},
    {.name = "segments", .shape = Shape::edges, .flat = 3},
    {.name = "segments in one plane, grid",
     .shape = Shape::flat_vertex,
     .place = Place::grid,
     .flat = 3},
    {.name = "points", .shape = Shape::vertices, .flat = 4},
    {.name = "climbed",
     .shape = Shape::climbed,
     .gap = Gap::none,
     .place = Place::as_is,
     .size_mm = 1},
    {.name = "climbed, nudged",
     .shape = Shape::climbed,
     .gap = Gap::none,
     .place = Place::as_is,
     .size_mm = 1,
     .nudges = 3},
    {.name = "climbed, quarter turns",
     .shape = Shape::climbed,
     .gap = Gap::none,
     .place = Place::quarter,
     .size_mm = 1,
     .nudges = 1},

    // Three rounded vertices of a line, deep in a triangle: their normal is only rounding.
    {.name = "pierced by a rounded line", .shape = Shape::pierced, .size_mm = 100, .aspect = 1e-17},
};

[[nodiscard]] constexpr bool is_flat(Shape shape) noexcept {
    return shape == Shape::flat_vertex || shape == Shape::flat_loose ||
           shape == Shape::flat_inside || shape == Shape::flat_edges;
}

}  // namespace axg::lab
