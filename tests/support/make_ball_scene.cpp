// SPDX-License-Identifier: Apache-2.0
// Writes a scene folder of sixteen lumpy balls and sixty-four pairs, with as many triangles as
// wanted: eight balls stand at the corners of a cube, eight smaller ones on a carrier that turns
// and moves between them. Every pose leaves the balls that are nearest between 0.2 and 5 mm apart,
// but for lumps that may take some of it away. For measuring how an engine's time grows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "tests/support/random_queries.hpp"
#include "tests/support/scene.hpp"

namespace {

using namespace axg;
using axg::test::Draw;
using axg::test::Scene;

constexpr int kCorners = 8;
constexpr double kFixedMm = 60, kCarriedMm = 35;            // radii
constexpr double kFixedAtMm = 120, kCarriedAtMm = 45;       // half edges of the cubes
constexpr double kLump = 0.02;                              // of the radius, both ways
constexpr double kLeastMm = 0.2, kMostMm = 5, kWayMm = 60;  // of a pose

struct Options {
    std::string out;
    std::uint32_t cells = 36, poses = 256;
    std::uint64_t seed = 1;
};

void corner(int i, double half_edge_mm, double (&at)[3]) {
    for (int k = 0; k < 3; ++k) {
        at[k] = (i >> k & 1) == 0 ? -half_edge_mm : half_edge_mm;
    }
}

/// Distance of the nearest pair of balls without their lumps.
double least_gap(const std::vector<Pose>& placed) {
    double least = 1e9;
    for (int fixed = 0; fixed < kCorners; ++fixed) {
        for (int carried = kCorners; carried < 2 * kCorners; ++carried) {
            double square = 0;
            for (int k = 0; k < 3; ++k) {
                const double d = placed[fixed].t[k] - placed[carried].t[k];
                square += d * d;
            }
            least = std::min(least, std::sqrt(square) - kFixedMm - kCarriedMm);
        }
    }
    return least;
}

std::vector<Pose> draw_pose(Draw& draw) {
    for (;;) {
        std::vector<Pose> placed(2 * kCorners);
        const Pose turn = test::random_rotation(draw);
        double way[3];
        for (double& w : way) {
            w = draw.between(-kWayMm, kWayMm);
        }
        for (int i = 0; i < kCorners; ++i) {
            corner(i, kFixedAtMm, placed[i].t);
            double at[3];
            corner(i, kCarriedAtMm, at);
            Pose& carried = placed[kCorners + i];
            carried = turn;
            for (int k = 0; k < 3; ++k) {
                carried.t[k] =
                    way[k] + turn.r[k][0] * at[0] + turn.r[k][1] * at[1] + turn.r[k][2] * at[2];
            }
        }
        const double gap = least_gap(placed);
        if (gap >= kLeastMm && gap <= kMostMm) {
            return placed;
        }
    }
}

Scene make_scene(const Options& options) {
    Draw draw(options.seed);
    Scene scene;
    for (int i = 0; i < 2 * kCorners; ++i) {
        // A radius that no lump exceeds: lumps only dig in.
        const double radius_mm = (i < kCorners ? kFixedMm : kCarriedMm) / (1 + kLump / 2);
        scene.bodies.push_back(test::lumpy_ball(draw, options.cells, radius_mm, kLump));
        scene.bodies.back().name = (i < kCorners ? "fixed" : "carried") + std::to_string(i % 8);
    }
    for (std::uint32_t a = kCorners; a < 2 * kCorners; ++a) {
        for (std::uint32_t b = 0; b < kCorners; ++b) {
            scene.pairs.push_back({scene.bodies[a].name + "-" + scene.bodies[b].name, a, b});
        }
    }
    for (std::uint32_t i = 0; i < options.poses; ++i) {
        const std::vector<Pose> placed = draw_pose(draw);
        scene.placed.insert(scene.placed.end(), placed.begin(), placed.end());
    }
    scene.pose_count = options.poses;
    return scene;
}

[[noreturn]] void usage(const char* why) {
    std::fprintf(stderr,
                 "make_ball_scene: %s\nusage: axg_make_ball_scene OUT_DIR [--cells N] [--poses N] "
                 "[--seed N]\n12 N^2 triangles a ball, sixteen balls; N is 36 unless stated\n",
                 why);
    std::exit(2);
}

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool has_value = i + 1 < argc;
        if (argument == "--cells" && has_value) {
            options.cells = static_cast<std::uint32_t>(std::strtoul(argv[++i], nullptr, 10));
        } else if (argument == "--poses" && has_value) {
            options.poses = static_cast<std::uint32_t>(std::strtoul(argv[++i], nullptr, 10));
        } else if (argument == "--seed" && has_value) {
            options.seed = std::strtoull(argv[++i], nullptr, 10);
        } else if (argument.rfind("--", 0) != 0 && options.out.empty()) {
            options.out = argument;
        } else {
            usage(argv[i]);
        }
    }
    if (options.out.empty() || options.poses == 0 || options.cells == 0) {
        usage("wanted OUT_DIR, and at least one cell and one pose");
    }
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse(argc, argv);
        const Scene scene = make_scene(options);
        write_scene(scene, options.out);
        std::size_t triangles = 0;
        for (const Mesh& mesh : scene.bodies) {
            triangles += mesh.triangles.size();
        }
        std::printf("%zu bodies, %zu triangles, %zu pairs, %u poses\n", scene.bodies.size(),
                    triangles, scene.pairs.size(), scene.pose_count);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_ball_scene: %s\n", error.what());
        return 1;
    }
    return 0;
}
