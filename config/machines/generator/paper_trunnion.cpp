// SPDX-License-Identifier: Apache-2.0
// A mill with a tilting cradle: head in Z, table in X on a saddle in Y, cradle A between the
// table's uprights, plate C in the cradle. Machine coordinates at the zero pose: spindle axis x = y
// = 0, nose face z = 0, the axes A and C meet at z = -380. The seed paper gives the numbers of
// triangles of its parts, 44, 136, 180, 164, 548 and 716; a closed surface has 2 V - 4 + 4 g of
// them (V corners, g through holes), so each part below says how its corners add up.
#include "config/machines/generator/parts.hpp"
#include "config/machines/generator/shapes.hpp"
#include "core/base/sincos.hpp"

namespace axg::generator {
namespace {

/// Table with the two uprights that carry the cradle: a section of 12 corners along y. V = 24: 44
/// triangles.
std::vector<Triangle> table_x() {
    const std::vector<Point> section{{-330, -640}, {330, -640},  {330, -580},  {280, -580},
                                     {280, -320},  {210, -320},  {210, -580},  {-210, -580},
                                     {-210, -320}, {-280, -320}, {-280, -580}, {-330, -580}};
    return extrude(kPlaneXZ, section, -140, 140);
}

/// Saddle with two dovetail rails, chip lips and a channel over the ball screw's bore: a section of
/// 22 corners and a bore of 12 along x. V = 68, g = 1: 136 triangles.
std::vector<Triangle> saddle_y() {
    const std::vector<Point> section{
        {-160, -740}, {160, -740},  {180, -720},  {180, -650}, {165, -650},  {165, -665},
        {115, -665},  {125, -640},  {65, -640},   {75, -665},  {40, -665},   {40, -680},
        {-40, -680},  {-40, -665},  {-75, -665},  {-65, -640}, {-125, -640}, {-115, -665},
        {-165, -665}, {-165, -650}, {-180, -650}, {-180, -720}};
    return extrude(kPlaneYZ, section, -260, 260, {around_circle({0, -710}, 16, 12)});
}

/// Headstock: a housing of 14 corners (bevelled front, two guide grooves at the back), a stepped
/// spindle nose of twice 12, a motor of 8 corners on top. V = 28 + 48 + 16 = 92: 180 triangles.
std::vector<Triangle> head_z() {
    const std::vector<Point> housing{
        {-100, -130}, {100, -130}, {130, -100}, {130, 260}, {90, 260},  {90, 235},   {60, 235},
        {60, 260},    {-60, 260},  {-60, 235},  {-90, 235}, {-90, 260}, {-130, 260}, {-130, -100}};
    const std::vector<Point> nose = around_circle({0, 0}, 50, 12);
    const std::vector<Point> flange = around_circle({0, 0}, 80, 12);
    const std::vector<Point> motor = around_circle({0, 0}, 75, 8);
    Polyhedron solid;
    const std::vector<Loop> n = stack(solid, kPlaneXY, {nose, nose}, {0, 40});
    const std::vector<Loop> f = stack(solid, kPlaneXY, {flange, flange}, {40, 60});
    const std::vector<Loop> h = stack(solid, kPlaneXY, {housing, housing}, {60, 400});
    const std::vector<Loop> m = stack(solid, kPlaneXY, {motor, motor}, {400, 520});
    solid.face(reversed(n[0]));
    solid.face(reversed(f[0]), {n[1]});
    solid.face(reversed(h[0]), {f[1]});
    solid.face(h[1], {m[0]});
    solid.face(m[1]);
    return solid.triangles();
}

/// Cradle: a U of 10 corners along y, a journal of 10 corners on each arm, the seat of the plate's
/// hub, 12 corners sunk into the floor. In coordinates of the A axis. V = 20 + 40 + 24 = 84: 164
/// triangles.
std::vector<Triangle> cradle_a() {
    constexpr double kFront = 100, kBack = -100;  // heights above the plane xz, towards -y
    const std::vector<Point> section{{-175, -130}, {175, -130}, {200, -105}, {200, 60},
                                     {165, 60},    {165, -70},  {-165, -70}, {-165, 60},
                                     {-200, 60},   {-200, -105}};
    const std::vector<Point> journal = around_circle({0, 0}, 45, 10);
    const std::vector<Point> seat = around_circle({0, 0}, 80, 12);
    Polyhedron solid;
    const Loop back = solid.ring(kPlaneXZ.at(section, kBack));
    const Loop front = solid.ring(kPlaneXZ.at(section, kFront));
    const std::vector<Loop> right = stack(solid, kPlaneYZ, {journal, journal}, {200, 245});
    const std::vector<Loop> left = stack(solid, kPlaneZY, {journal, journal}, {200, 245});
    const Loop rim = solid.ring(kPlaneXY.at(seat, -70)), floor = solid.ring(kPlaneXY.at(seat, -95));
    solid.wall(reversed(floor), reversed(rim));
    solid.face(reversed(back));
    solid.face(front);
    solid.face(right[1]);
    solid.face(left[1]);
    solid.face(floor);
    for (std::uint32_t i = 0; i < section.size(); ++i) {
        const std::uint32_t next = (i + 1) % static_cast<std::uint32_t>(section.size());
        std::vector<Loop> holes;
        if (i == 2) {
            holes = {right[0]};
        } else if (i == 8) {
            holes = {left[0]};
        } else if (i == 5) {
            holes = {rim};
        }
        solid.face({back[i], back[next], front[next], front[i]}, holes);
    }
    return solid.triangles();
}

/// A clamping slot with round ends, 8 corners, along the direction given by its sine and cosine.
std::vector<Point> radial_slot(SinCos direction) {
    const double radius = 9;
    std::vector<Point> out;
    for (std::uint32_t k = 0; k < 8; ++k) {
        const bool is_outer = k < 2 || k > 5;
        const SinCos around = sin_cos((static_cast<double>(k) + 0.5) * kPi / 4.0);
        const double along = (is_outer ? 125 : 70) + radius * around.cos;
        const double aside = radius * around.sin;
        out.push_back({along * direction.cos - aside * direction.sin,
                       along * direction.sin + aside * direction.cos});
    }
    return out;
}

/// Plate: 36 corners in four rings (both rims bevelled), a hub of 18 below, a centring recess of 16
/// and four clamping slots of 8 corners above. In coordinates of the C axis. V = 144 + 36 + 32 + 64
/// = 276: 548 triangles.
std::vector<Triangle> plate_c() {
    const std::vector<Point> rim = around_circle({0, 0}, 150, 36);
    const std::vector<Point> bevel = around_circle({0, 0}, 146, 36);
    const std::vector<Point> hub = around_circle({0, 0}, 70, 18);
    const std::vector<Point> recess = around_circle({0, 0}, 25, 16);
    Polyhedron solid;
    const std::vector<Loop> disc =
        stack(solid, kPlaneXY, {bevel, rim, rim, bevel}, {-60, -56, -24, -20});
    const std::vector<Loop> below = stack(solid, kPlaneXY, {hub, hub}, {-88, -60});
    solid.face(reversed(below[0]));
    solid.face(reversed(disc[0]), {below[1]});
    std::vector<Loop> pockets;
    const auto sink = [&](const std::vector<Point>& outline, double depth) {
        const Loop top = solid.ring(kPlaneXY.at(outline, -20));
        const Loop floor = solid.ring(kPlaneXY.at(outline, -20 - depth));
        solid.wall(reversed(floor), reversed(top));
        solid.face(floor);
        pockets.push_back(top);
    };
    sink(recess, 12);
    for (const SinCos& direction : {SinCos{0, 1}, SinCos{1, 0}, SinCos{0, -1}, SinCos{-1, 0}}) {
        sink(radial_slot(direction), 18);
    }
    solid.face(disc[3], pockets);
    return solid.triangles();
}

/// Ball-nose cutter, 12 mm across, in a collet chuck with a gripper flange: 15 rings of 24 corners.
/// The ball is the polygon of its tangents, its tip the tangent plane. Gauge face z = 0, tip z =
/// -140. V = 360: 716 triangles.
std::vector<Triangle> ball_nose_cutter() {
    constexpr double kRadius = 6, kTip = -140;
    std::vector<Point> profile;
    for (std::uint32_t k = 0; k < 4;
         ++k) {  // tangents at 0, 22.5, 45, 67.5 and 90 degrees from the pole
        const SinCos half = sin_cos(kPi / 16.0), at = sin_cos((2.0 * k + 1.0) * kPi / 16.0);
        profile.push_back(
            {kRadius * at.sin / half.cos, kTip + kRadius * (1.0 - at.cos / half.cos)});
    }
    profile[3].x = kRadius;  // the last tangent is the shank: equal but for rounding
    for (const Point& p : {Point{6, -95}, Point{17, -95}, Point{20, -92}, Point{20, -70},
                           Point{15, -70}, Point{19, -26}, Point{31.5, -26}, Point{31.5, -19},
                           Point{27, -15}, Point{31.5, -11}, Point{31.5, 0}}) {
        profile.push_back(p);
    }
    return solid_of_revolution(profile, 24);
}

}  // namespace

std::vector<Part> paper_trunnion() {
    return {{"paper-trunnion/x.stl", table_x()}, {"paper-trunnion/y.stl", saddle_y()},
            {"paper-trunnion/z.stl", head_z()},  {"paper-trunnion/a.stl", cradle_a()},
            {"paper-trunnion/c.stl", plate_c()}, {"paper-trunnion/cutter.stl", ball_nose_cutter()}};
}

}  // namespace axg::generator
