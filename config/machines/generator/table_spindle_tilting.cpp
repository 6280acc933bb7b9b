// SPDX-License-Identifier: Apache-2.0
// A travelling-column mill: carriage in X with a rotary plate C, column in Y, slide in Z, swivel
// head B on the slide. Machine coordinates at the zero pose: spindle axis x = y = 0, the axis B
// through the origin along y, nose z = -200.
#include "config/machines/generator/parts.hpp"
#include "config/machines/generator/shapes.hpp"

namespace axg::generator {
namespace {

/// T-shaped bed, seen from above: the bar carries the carriage, the stem the column.
std::vector<Triangle> bed() {
    return extrude(kPlaneXY,
                   {{-700, -300},
                    {700, -300},
                    {700, 300},
                    {300, 300},
                    {300, 1200},
                    {-300, 1200},
                    {-300, 300},
                    {-700, 300}},
                   -950, -720);
}

/// Carriage with a round seat on top.
std::vector<Triangle> carriage() {
    const std::vector<Point> slab = {{-260, -220}, {260, -220}, {280, -200}, {280, 200},
                                     {260, 220},   {-260, 220}, {-280, 200}, {-280, -200}};
    const std::vector<Point> seat = around_circle({0, 0}, 160, 32);
    Polyhedron solid;
    const std::vector<Loop> lower = stack(solid, kPlaneXY, {slab, slab}, {-720, -650});
    const std::vector<Loop> upper = stack(solid, kPlaneXY, {seat, seat}, {-650, -600});
    solid.face(reversed(lower[0]));
    solid.face(lower[1], {upper[0]});
    solid.face(upper[1]);
    return solid.triangles();
}

/// Rotary plate with a through bore and a ring of eight bores for clamps.
std::vector<Triangle> plate() {
    std::vector<std::vector<Point>> bores{around_circle({0, 0}, 30, 16)};
    for (const Point& p : around_circle({0, 0}, 130, 8)) {
        bores.push_back(around_circle(p, 8, 8));
    }
    return extrude(kPlaneXY, around_circle({0, 0}, 200, 48), -600, -550, bores);
}

/// Column, seen from above: hollow at the back, guides at the front.
std::vector<Triangle> column() {
    return extrude(kPlaneXY,
                   {{-220, 420},
                    {-140, 420},
                    {-140, 450},
                    {140, 450},
                    {140, 420},
                    {220, 420},
                    {260, 820},
                    {120, 820},
                    {120, 600},
                    {-120, 600},
                    {-120, 820},
                    {-260, 820}},
                   -720, 700);
}

std::vector<Triangle> slide() {
    return extrude(kPlaneXY,
                   {{-150, 150}, {150, 150}, {200, 230}, {200, 420}, {-200, 420}, {-200, 230}},
                   -130, 330);
}

/// Swivel head: rounded top about the B axis, flat bottom with a stepped spindle nose.
std::vector<Triangle> head() {
    const std::vector<Point> section{{-85, -120}, {85, -120}, {85, 35},  {60, 75},
                                     {20, 95},    {-20, 95},  {-60, 75}, {-85, 35}};
    const std::vector<Point> nose = around_circle({0, 0}, 45, 24);
    const std::vector<Point> collar = around_circle({0, 0}, 70, 24);
    Polyhedron solid;
    const Loop back = solid.ring(kPlaneXZ.at(section, -145));
    const Loop front = solid.ring(kPlaneXZ.at(section, 90));
    const std::vector<Loop> n = stack(solid, kPlaneXY, {nose, nose}, {-200, -160});
    const std::vector<Loop> c = stack(solid, kPlaneXY, {collar, collar}, {-160, -120});
    solid.face(reversed(n[0]));
    solid.face(reversed(c[0]), {n[1]});
    solid.face(reversed(back));
    solid.face(front);
    for (std::uint32_t i = 0; i < section.size(); ++i) {
        const std::uint32_t next = (i + 1) % static_cast<std::uint32_t>(section.size());
        const std::vector<Loop> holes = i == 0 ? std::vector<Loop>{c[1]} : std::vector<Loop>{};
        solid.face({back[i], back[next], front[next], front[i]}, holes);
    }
    return solid.triangles();
}

}  // namespace

std::vector<Part> table_spindle_tilting() {
    return {{"table-spindle-tilting/bed.stl", bed()},
            {"table-spindle-tilting/carriage.stl", carriage()},
            {"table-spindle-tilting/plate.stl", plate()},
            {"table-spindle-tilting/column.stl", column()},
            {"table-spindle-tilting/slide.stl", slide()},
            {"table-spindle-tilting/head.stl", head()}};
}

}  // namespace axg::generator
