// SPDX-License-Identifier: Apache-2.0
// What a pair of bodies costs by brute force (the certified test of every pair of triangles), by
// the whole surfaces' trees and by those of coarser models: in one process, pose by pose, on the
// fine machine's balls and rings within a few millimetres of contact. AXG_COUNT: poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "config/mesh/simplify_meshes.hpp"
#include "core/collision/lane_kernels.hpp"
#include "cuda/paper/brute_cpu.hpp"
#include "cuda/paper/paper_scene.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr double kModelDetailsMm[] = {0, 0.05, 0.1, 0.2, 0.4};  // 0: the whole surfaces
constexpr std::uint32_t kModels = std::size(kModelDetailsMm);
constexpr int kPasses = 9;
constexpr double kApartMm = 4;  // poses are up to so far from contact
constexpr double kShareOfBruteForce = 0.1;

using Clock = std::chrono::steady_clock;

template <class Work>
double least_us(int passes, const Work& work) {
    double least = HUGE_VAL;
    for (int i = 0; i < passes; ++i) {
        const Clock::time_point start = Clock::now();
        work();
        const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
        least = std::min(least, spent.count());
    }
    return least;
}

double median(std::vector<double> of) {
    std::sort(of.begin(), of.end());
    return of.at(of.size() / 2);
}

/// Two that stand, two that are carried; engine index: 4 * detail + body.
struct Models {
    std::vector<Mesh> all;
    std::vector<double> deviation_mm;
    std::vector<paper::Body> bodies;  // of the whole surfaces

    Models() {
        const std::vector<Mesh> whole{{"ball", ball(36, 60)},
                                      {"ring", ring(124, 63, 42, 18)},
                                      {"carried ball", ball(36, 35)},
                                      {"carried ring", ring(124, 63, 24.5, 10.5)}};
        for (const Mesh& mesh : whole) {
            bodies.push_back(paper::make_body(mesh.triangles));
        }
        for (const double detail_mm : kModelDetailsMm) {
            for (const Mesh& mesh : whole) {
                SimplifiedMesh simple =
                    detail_mm == 0 ? SimplifiedMesh{mesh, 0, 0} : simplify(mesh, detail_mm);
                all.push_back(std::move(simple.mesh));
                deviation_mm.push_back(simple.deviation_mm);
            }
        }
    }
    [[nodiscard]] Query at_detail(Query whole, std::uint32_t detail) const {
        whole.mesh_a += 4 * detail;
        whole.mesh_b += 4 * detail;
        whole.pose_error_mm = deviation_mm[whole.mesh_a] + deviation_mm[whole.mesh_b];
        return whole;
    }
};

/// A carried body beside one that stands, along a random direction: up to kApartMm from contact.
Query near_query(CpuEngine& engine, Draw& draw) {
    Query q;
    q.mesh_a = 2 + draw.below(2);
    q.mesh_b = draw.below(2);
    q.pose = random_rotation(draw);
    const Pose direction = random_rotation(draw);
    const auto put = [&](double away_mm) {
        for (int k = 0; k < 3; ++k) {
            q.pose.t[k] = away_mm * direction.r[k][0];
        }
    };
    double near = 0, far = 200;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (near + far);
        put(middle);
        (run_query(engine, q).proof == Proof::far ? far : near) = middle;
    }
    put(far + draw.between(0, kApartMm));
    return q;
}

TEST(ModelCost, BesideBruteForce) {
    const Models models;
    auto engine = engine_over(models.all);
    const LaneKernels* const lanes = lane_kernels(LaneSet::widest);
    ASSERT_TRUE(engine && lanes != nullptr);
    Draw draw(printed_seed(20261221));
    const std::uint64_t count = count_from_environment(12);
    std::vector<double> brute_us, us[kModels], of_brute[kModels], of_whole[kModels];
    std::uint32_t lost[kModels]{};
    std::uint64_t triangle_pairs = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Query whole = near_query(*engine, draw);
        const paper::Body &a = models.bodies[whole.mesh_a], &b = models.bodies[whole.mesh_b];
        paper::Found found;
        brute_us.push_back(
            least_us(1, [&] { found = paper::test_certified(*lanes, a, b, whole.pose); }));
        triangle_pairs += std::uint64_t{a.triangles.size()} * b.triangles.size();
        for (std::uint32_t detail = 0; detail < kModels; ++detail) {
            const Query q = models.at_detail(whole, detail);
            QueryResult result;
            us[detail].push_back(least_us(kPasses, [&] { result = run_query(*engine, q); }));
            of_brute[detail].push_back(us[detail].back() / brute_us.back());
            of_whole[detail].push_back(us[0].back() / us[detail].back());
            lost[detail] += found.touching == 0 && result.proof != Proof::far ? 1 : 0;
            EXPECT_FALSE(found.touching != 0 && result.proof == Proof::far) << i << ' ' << detail;
        }
    }
    std::printf("%llu poses; brute force: median %.0f us, %.2f ns a pair of triangles\n",
                static_cast<unsigned long long>(count), median(brute_us),
                1e3 * std::accumulate(brute_us.begin(), brute_us.end(), 0.0) /
                    static_cast<double>(triangle_pairs));
    for (std::uint32_t detail = 0; detail < kModels; ++detail) {
        std::printf(
            "%-5s mm: median %8.2f us, slowest %8.2f; of brute force %.6f %%; the whole takes "
            "%.2f times as long; %u of the poses lost\n",
            detail == 0 ? "whole" : std::to_string(kModelDetailsMm[detail]).substr(0, 4).c_str(),
            median(us[detail]), *std::max_element(us[detail].begin(), us[detail].end()),
            100 * median(of_brute[detail]), median(of_whole[detail]), lost[detail]);
        EXPECT_LE(median(of_brute[detail]), kShareOfBruteForce);
    }
    EXPECT_EQ(lost[0], 0U) << "the tree proves what brute force proves";
}

}  // namespace
}  // namespace axg::test
