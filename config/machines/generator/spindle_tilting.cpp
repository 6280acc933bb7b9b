// SPDX-License-Identifier: Apache-2.0
// A portal mill with a fork head: table in X, slide in Y on a fixed portal, ram in Z, fork C,
// spindle B in the fork. Machine coordinates at the zero pose: the axes B and C meet at the origin,
// nose face z = -200.
#include "config/machines/generator/parts.hpp"
#include "config/machines/generator/shapes.hpp"

namespace axg::generator {
namespace {

/// Two posts and a beam with bevelled shoulders, across y.
std::vector<Triangle> portal() {
    return extrude(kPlaneYZ,
                   {{550, -950},
                    {800, -950},
                    {800, 550},
                    {740, 610},
                    {-740, 610},
                    {-800, 550},
                    {-800, -950},
                    {-550, -950},
                    {-550, 250},
                    {550, 250}},
                   190, 420);
}

/// A slab with three T-slots along x.
std::vector<Triangle> table() {
    std::vector<Point> section{{-350, -770}, {350, -770}, {350, -670}};
    for (const double y : {200.0, 0.0, -200.0}) {
        for (const Point& p :
             {Point{9, -670}, Point{9, -688}, Point{16, -688}, Point{16, -700}, Point{-16, -700},
              Point{-16, -688}, Point{-9, -688}, Point{-9, -670}}) {
            section.push_back({y + p.x, p.y});
        }
    }
    section.push_back({-350, -670});
    return extrude(kPlaneYZ, section, -450, 450);
}

std::vector<Triangle> slide() {
    return extrude(kPlaneXY, {{110, -170}, {190, -200}, {190, 200}, {110, 170}}, 220, 640);
}

/// A column of eight corners over a round bearing flange.
std::vector<Triangle> ram() {
    const std::vector<Point> column{{-60, -100}, {60, -100}, {100, -60}, {100, 60},
                                    {60, 100},   {-60, 100}, {-100, 60}, {-100, -60}};
    const std::vector<Point> flange = around_circle({0, 0}, 85, 24);
    Polyhedron solid;
    const std::vector<Loop> f = stack(solid, kPlaneXY, {flange, flange}, {162, 190});
    const std::vector<Loop> c = stack(solid, kPlaneXY, {column, column}, {190, 980});
    solid.face(reversed(f[0]));
    solid.face(reversed(c[0]), {f[1]});
    solid.face(c[1]);
    return solid.triangles();
}

/// An upside-down U across y with bevelled shoulders and journals that reach in from both arms to
/// the spindle.
std::vector<Triangle> fork() {
    const std::vector<Point> section{{110, -60},  {150, -60},  {150, 135},  {125, 160},
                                     {-125, 160}, {-150, 135}, {-150, -60}, {-110, -60},
                                     {-110, 110}, {110, 110}};
    const std::vector<Point> journal = around_circle({0, 0}, 42, 16);
    Polyhedron solid;
    const Loop back = solid.ring(kPlaneYZ.at(section, -70));
    const Loop front = solid.ring(kPlaneYZ.at(section, 70));
    // Heights above the plane xz count towards -y; above the plane zx towards +y.
    const Plane zx{{}, {0, 0, 1}, {1, 0, 0}};
    const std::vector<Loop> right = stack(solid, kPlaneXZ, {journal, journal}, {-110, -92});
    const std::vector<Loop> left = stack(solid, zx, {journal, journal}, {-110, -92});
    solid.face(reversed(back));
    solid.face(front);
    solid.face(right[1]);
    solid.face(left[1]);
    for (std::uint32_t i = 0; i < section.size(); ++i) {
        const std::uint32_t next = (i + 1) % static_cast<std::uint32_t>(section.size());
        std::vector<Loop> holes;
        if (i == 9) {
            holes = {right[0]};
        } else if (i == 7) {
            holes = {left[0]};
        }
        solid.face({back[i], back[next], front[next], front[i]}, holes);
    }
    return solid.triangles();
}

/// Motor spindle: round housing, stepped nose; tilts about y.
std::vector<Triangle> spindle() {
    return solid_of_revolution({{45, -200}, {45, -170}, {75, -140}, {90, -140}, {90, 25}, {80, 40}},
                               32);
}

/// End mill of 16 mm in a collet chuck. Gauge face z = 0, tip z = -120.
std::vector<Triangle> end_mill() {
    return solid_of_revolution(
        {{8, -120}, {8, -70}, {21, -70}, {25, -62}, {25, -28}, {31.5, -28}, {31.5, 0}}, 24);
}

}  // namespace

std::vector<Part> spindle_tilting() {
    return {{"spindle-tilting/portal.stl", portal()},    {"spindle-tilting/table.stl", table()},
            {"spindle-tilting/slide.stl", slide()},      {"spindle-tilting/ram.stl", ram()},
            {"spindle-tilting/fork.stl", fork()},        {"spindle-tilting/spindle.stl", spindle()},
            {"spindle-tilting/end-mill.stl", end_mill()}};
}

}  // namespace axg::generator
