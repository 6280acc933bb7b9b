// SPDX-License-Identifier: Apache-2.0
// Verdicts over coarser models against those over the whole surfaces, at random poses near contact:
// whatever a coarser model calls far the whole surfaces are, by the engine or by the tests' own
// distance; the verdicts that it loses are counted, and how much room was left: never more than
// what the deviations cost as an error of each coordinate, and both surfaces stick out by.
// AXG_COUNT: poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "config/mesh/simplify_meshes.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/surface_distance.hpp"

namespace axg::test {
namespace {

constexpr double kModelDetailsMm[] = {0.05, 0.1, 0.2, 0.4};
constexpr double kOracleErrorMm = 1e-9;
// An error of so much in x, y and z: in the direction of a corner of the cube it is this much more.
constexpr double kErrorOfEachCoordinate = 1.7320508075688774;
constexpr double kBandMm = 1e-3;  // where an engine's roundings leave a query open: far less

/// Engine indices: the whole surfaces, then those of each detail.
struct Models {
    std::vector<Mesh> whole{
        {"ball", ball(16, 40)}, {"ring", ring(64, 24, 40, 9)}, {"small ball", ball(12, 15)}};
    std::vector<Mesh> all = whole;
    std::vector<double> deviation_mm = std::vector<double>(3, 0.0), excess_mm = deviation_mm;
    std::vector<DistanceTree> trees;

    Models() {
        for (const double detail_mm : kModelDetailsMm) {
            for (const Mesh& mesh : whole) {
                SimplifiedMesh simple = simplify(mesh, detail_mm);
                all.push_back(std::move(simple.mesh));
                deviation_mm.push_back(simple.deviation_mm);
                excess_mm.push_back(simple.excess_mm);
            }
        }
        for (const Mesh& mesh : whole) {
            trees.emplace_back(mesh.triangles);
        }
    }
};

struct Tally {
    std::uint64_t lost = 0;
    // Of a lost verdict: both deviations, these and both excesses, distance less margin.
    double inflation_mm = 0, bound_mm = 0, room_mm_most = 0;
};

Query near_query(Draw& draw) {
    Query q;
    q.mesh_a = draw.below(3);
    q.mesh_b = draw.below(3);
    q.pose = random_rotation(draw);
    const Pose direction = random_rotation(draw);
    const double away_mm = draw.between(10, 95);
    for (int k = 0; k < 3; ++k) {
        q.pose.t[k] = away_mm * direction.r[k][0];
    }
    q.r_mm = draw.between(0, 4);
    return q;
}

TEST(ModelVerdicts, DifferToTheSafeSideAlone) {
    const Models models;
    if (models.deviation_mm.back() == 0) {
        GTEST_SKIP() << "skipped: built without libmeshoptimizer";
    }
    auto engine = engine_over(models.all);
    ASSERT_TRUE(engine);
    Draw draw(printed_seed(20261190));
    const std::uint64_t count = count_from_environment(40'000);
    std::uint64_t far = 0;
    Tally tallies[std::size(kModelDetailsMm)];
    for (std::uint64_t i = 0; i < count; ++i) {
        const Query whole = near_query(draw);
        const bool is_far = run_query(*engine, whole).proof == Proof::far;
        far += is_far ? 1 : 0;
        for (std::size_t detail = 0; detail < std::size(kModelDetailsMm); ++detail) {
            Query coarse = whole;
            coarse.mesh_a += static_cast<std::uint32_t>(3 * (detail + 1));
            coarse.mesh_b += static_cast<std::uint32_t>(3 * (detail + 1));
            const double inflation_mm =
                models.deviation_mm[coarse.mesh_a] + models.deviation_mm[coarse.mesh_b];
            coarse.pose_error_mm = inflation_mm;
            const bool is_coarse_far = run_query(*engine, coarse).proof == Proof::far;
            if (is_coarse_far == is_far) {
                continue;
            }
            if (is_coarse_far) {  // the whole engine's own roundings: no more than a band
                const double distance_mm =
                    surface_distance(models.trees[whole.mesh_a], models.trees[whole.mesh_b],
                                     whole.pose, whole.r_mm + 1);
                ASSERT_GE(distance_mm, whole.r_mm - kOracleErrorMm) << "pose " << i;
                continue;
            }
            Query room = whole;
            room.kind = QueryKind::clearance;
            room.r_mm += 10;
            const double distance_mm = run_query(*engine, room).clearance_mm;
            const double bound_mm = kErrorOfEachCoordinate * inflation_mm +
                                    models.excess_mm[coarse.mesh_a] +
                                    models.excess_mm[coarse.mesh_b];
            ASSERT_LE(distance_mm - whole.r_mm, bound_mm + kBandMm) << "pose " << i;
            Tally& tally = tallies[detail];
            tally.bound_mm = std::max(tally.bound_mm, bound_mm);
            ++tally.lost;
            tally.inflation_mm = std::max(tally.inflation_mm, inflation_mm);
            tally.room_mm_most = std::max(tally.room_mm_most, distance_mm - whole.r_mm);
        }
    }
    std::printf("%llu poses, %llu far\n", static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(far));
    for (std::size_t detail = 0; detail < std::size(kModelDetailsMm); ++detail) {
        const Tally& tally = tallies[detail];
        std::printf(
            "%.2f mm: %llu lost (%.3f %% of far), inflation up to %.3f mm, room up to "
            "%.3f mm of %.3f\n",
            kModelDetailsMm[detail], static_cast<unsigned long long>(tally.lost),
            100.0 * static_cast<double>(tally.lost) / static_cast<double>(far), tally.inflation_mm,
            tally.room_mm_most, tally.bound_mm);
        // The inflation alone does not explain it, so both bounds are needed.
        EXPECT_TRUE(tally.room_mm_most > tally.inflation_mm || tally.lost < 100)
            << kModelDetailsMm[detail];
    }
    EXPECT_GT(far, count / 10);
    // Else this is too weak to tell anything.
    EXPECT_TRUE(tallies[std::size(kModelDetailsMm) - 1].lost > tallies[0].lost || count < 10'000);
}

}  // namespace
}  // namespace axg::test
