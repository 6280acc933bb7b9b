// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data long
// Both sides of a simplified surface: how far the whole one leaves it, and how far it sticks out of
// the whole one, certified and sampled; on the fine machine's ball and ring and on castings of a
// real machine, whose meshes are not ours. Prints the table of docs/figures/simplified-sides.csv:
// with AXG_COUNT, points a side; without it smaller surfaces are judged, and coarse ones alone.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "config/mesh/simplify_meshes.hpp"
#include "tests/support/count.hpp"
#include "tests/support/farthest_point.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr double kSidesDetailsMm[] = {0.05, 0.1, 0.2, 0.4};
constexpr double kSidesErrorMm = 1e-9;

/// A surface at each detail; the tightest share of a certified side that a point came to.
struct Tightest {
    double deviation = 0, excess = 0;
};

void judge(const Mesh& whole, std::span<const double> details_mm, std::uint64_t count,
           std::mt19937_64& random, Tightest& tightest) {
    const DistanceTree whole_tree(whole.triangles);
    for (const double detail_mm : details_mm) {
        const SimplifiedMesh simple = simplify(whole, detail_mm);
        const DistanceTree simple_tree(simple.mesh.triangles);
        const double leaves = farthest_point_mm(whole.triangles, simple_tree, count, random);
        const double sticks_out =
            farthest_point_mm(simple.mesh.triangles, whole_tree, count, random);
        std::printf("%s,%g,%zu,%zu,%.4f,%.4f,%.4f,%.4f\n", whole.name.c_str(), detail_mm,
                    whole.triangles.size(), simple.mesh.triangles.size(), simple.deviation_mm,
                    leaves, simple.excess_mm, sticks_out);
        EXPECT_LE(leaves, simple.deviation_mm + kSidesErrorMm) << whole.name << ' ' << detail_mm;
        EXPECT_LE(sticks_out, simple.excess_mm + kSidesErrorMm) << whole.name << ' ' << detail_mm;
        EXPECT_LE(simple.deviation_mm, detail_mm);
        EXPECT_LE(simple.excess_mm, detail_mm);
        if (simple.deviation_mm > 0) {
            tightest.deviation = std::max(tightest.deviation, leaves / simple.deviation_mm);
            tightest.excess = std::max(tightest.excess, sticks_out / simple.excess_mm);
        }
    }
}

TEST(SimplifiedSides, NoPointOfEitherIsFartherThanCertified) {
    std::mt19937_64 random(printed_seed(20261220));
    const std::uint64_t count = count_from_environment(20'000);
    const bool is_whole = std::getenv("AXG_COUNT") != nullptr;
    const std::span<const double> details_mm = std::span(kSidesDetailsMm).subspan(is_whole ? 0 : 2);
    std::vector<Mesh> surfaces{{"ball", is_whole ? ball(36, 60) : ball(16, 40)},
                               {"ring", is_whole ? ring(124, 63, 42, 18) : ring(64, 24, 40, 9)}};
    const std::string root = std::string(AXG_SHARED_DATA) + "/machines/probe-basic-xyzac";
    if (std::filesystem::exists(root)) {
        LoadedMachine loaded;
        ASSERT_TRUE(
            load(source_file("config/machines/probe-basic-xyzac.yaml"), root, loaded, stderr));
        for (const Mesh& mesh : loaded.meshes.bodies) {
            if (mesh.triangles.size() > 1000 && (is_whole || mesh.triangles.size() < 5000)) {
                surfaces.push_back(mesh);
            }
        }
    }
    if (simplify(surfaces[0], 0.4).deviation_mm == 0) {
        GTEST_SKIP() << "skipped: built without libmeshoptimizer";
    }
    std::printf(
        "surface,simplify_mm,whole_triangles,triangles,deviation_mm,deviation_sampled_mm,"
        "excess_mm,excess_sampled_mm\n");
    Tightest tightest;
    for (const Mesh& whole : surfaces) {
        judge(whole, details_mm, count, random, tightest);
    }
    // Else the bounds are too loose for this to tell anything.
    EXPECT_GT(tightest.deviation, 0.9);
    EXPECT_GT(tightest.excess, 0.9);
}

}  // namespace
}  // namespace axg::test
