// SPDX-License-Identifier: Apache-2.0
// Writes a machine that is modelled much finer than it needs: machine.yaml, sixteen surfaces of
// 249,408 triangles in all, sixty-four checked pairs, and near.ngc, which runs it for seconds
// within millimetres of contact and never into it. Four balls and four rings stand at the corners
// of a cube; a carrier of smaller ones moves and turns between them. The same on every machine.
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/round_solids.hpp"
#include "tests/support/scene.hpp"

namespace {

using namespace axg;

constexpr int kCorners = 8;
constexpr double kFixedMm = 60, kCarriedMm = 35;       // radii of balls
constexpr double kTubeShare = 0.3;                     // of a ring's outer radius
constexpr double kFixedAtMm = 120, kCarriedAtMm = 45;  // half edges of the cubes
constexpr unsigned kCells = 36, kAround = 124, kAcross = 63;

constexpr const char* kAxes = R"(version: 1
name: fine
deadline_us: 1000
axes:
  X: {kind: linear, travel_mm: [-40, 40], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  Y: {kind: linear, travel_mm: [-40, 40], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  Z: {kind: linear, travel_mm: [-40, 40], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  C: {kind: rotary, travel_deg: [-60, 60], speed_deg_s: 60, acceleration_deg_s2: 300,
      jerk_deg_s3: 6000, stopping_deg_s2: 250}
bodies:
  - {name: slide, axis: X, direction: [1, 0, 0]}
  - {name: saddle, parent: slide, axis: Y, direction: [0, 1, 0]}
  - {name: ram, parent: saddle, axis: Z, direction: [0, 0, 1]}
  - {name: carrier, parent: ram, axis: C, direction: [0, 0, 1], pivot_mm: [0, 0, 0]}
)";

std::string name_of(int i) {
    return std::string(i < kCorners ? "fixed" : "carried") + std::to_string(i % kCorners);
}

std::string list_of(int first) {
    std::string out = "[";
    for (int i = first; i < first + kCorners; ++i) {
        out += (i == first ? "" : ", ") + name_of(i);
    }
    return out + "]";
}

double at_of(int i, int axis) {
    const double half = i < kCorners ? kFixedAtMm : kCarriedAtMm;
    return (i >> axis & 1) == 0 ? -half : half;
}

std::string machine_text() {
    std::string text = kAxes;
    for (int i = 0; i < 2 * kCorners; ++i) {
        char at[96];
        std::snprintf(at, sizeof at, "[%g, %g, %g]", at_of(i, 0), at_of(i, 1), at_of(i, 2));
        text += "  - {name: " + name_of(i) + (i < kCorners ? "" : ", parent: carrier") +
                ", mesh: {file: " + name_of(i) + ".stl, unit: mm}, at_mm: " + at + "}\n";
    }
    text += "pairs:\n  - {a: " + list_of(0) + ", b: " + list_of(kCorners) + ", margin_mm: 0.5}\n";
    text += "exclusions:\n";
    for (const int side : {0, kCorners}) {
        for (int i = side; i < side + kCorners; ++i) {
            for (int j = i + 1; j < side + kCorners; ++j) {
                text += "  - {a: " + name_of(i) + ", b: " + name_of(j) +
                        ", reason: they stand on the same part}\n";
            }
        }
    }
    return text;
}

/// Out to each corner until the nearest pair is a few mm apart, turned a little there, and back.
std::string program_text() {
    std::string text = "G21 G90 G94\nG0 X0 Y0 Z0 C0\n";
    for (int corner = 0; corner < kCorners; ++corner) {
        char line[160];
        const double way = 18;
        const double x = (corner & 1) != 0 ? way : -way, y = (corner & 2) != 0 ? way : -way,
                     z = (corner & 4) != 0 ? way : -way;
        std::snprintf(line, sizeof line,
                      "G1 X%g Y%g Z%g F6000\nC1.5 F600\nC-1.5\nC0\nX0 Y0 Z0 F6000\n", x, y, z);
        text += line;
    }
    return text + "M2\n";
}

void write_text(const std::string& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    if (!stream.flush()) {
        throw std::runtime_error(file + ": cannot write");
    }
}

test::Scene make_scene() {
    test::Scene scene;
    for (int i = 0; i < 2 * kCorners; ++i) {
        const double radius_mm = i < kCorners ? kFixedMm : kCarriedMm;
        const double tube_mm = kTubeShare * radius_mm;
        scene.bodies.push_back(
            {name_of(i), i % 2 == 0 ? test::ball(kCells, radius_mm)
                                    : test::ring(kAround, kAcross, radius_mm - tube_mm, tube_mm)});
    }
    return scene;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: axg_make_fine_machine OUT_DIR\n");
        return 2;
    }
    try {
        const std::string folder = argv[1];
        const test::Scene scene = make_scene();
        write_scene(scene, folder);
        write_text(folder + "/machine.yaml", machine_text());
        write_text(folder + "/near.ngc", program_text());
        std::size_t triangles = 0;
        for (const Mesh& mesh : scene.bodies) {
            triangles += mesh.triangles.size();
        }
        std::printf("%zu bodies, %zu triangles\n", scene.bodies.size(), triangles);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_fine_machine: %s\n", error.what());
        return 1;
    }
    return 0;
}
