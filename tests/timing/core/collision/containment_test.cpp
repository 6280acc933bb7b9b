// SPDX-License-Identifier: Apache-2.0
// What containment costs beside the surfaces: on the paper's machine at positions spread over its
// travel, on a quarter of a million triangles, and where a ray meets everything there is. Least of
// several passes a pose, pose by pose in turn, so that what else runs here strikes both alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/certificate/pair_queries.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr int kPasses = 9;

double now_ns() {
    return static_cast<double>(std::chrono::steady_clock::now().time_since_epoch().count());
}

template <class Work>
double least_ns(const Work& work) {
    double least = HUGE_VAL;
    for (int i = 0; i < kPasses; ++i) {
        const double start = now_ns();
        work();
        least = std::min(least, now_ns() - start);
    }
    return least;
}

struct Times {
    std::vector<double> ns;

    [[nodiscard]] double at_share(double share) {
        std::sort(ns.begin(), ns.end());
        return ns.at(static_cast<std::size_t>(share * static_cast<double>(ns.size() - 1)));
    }
    void print(const char* what) {
        std::printf("%-34s %9.3f %9.3f %9.3f us\n", what, at_share(0.5) * 1e-3,
                    at_share(0.99) * 1e-3, at_share(1) * 1e-3);
    }
};

AxisSnapshot random_snapshot(const Machine& machine, test::Draw& draw) {
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        snapshot.position[i] =
            axis.unlimited ? draw.between(0, 2 * kPi) : draw.between(axis.min, axis.max);
    }
    return snapshot;
}

/// Random positions over the travel at which every pair is proven apart.
void measure(const LoadedMachine& loaded) {
    std::optional<CpuEngine> engine = make_engine(loaded);
    ASSERT_TRUE(engine.has_value());
    const std::optional<ContainmentTest> containment_test = make_containment_test(loaded, *engine);
    ASSERT_TRUE(containment_test.has_value());
    test::Draw draw(test::printed_seed(31));
    const auto pair_queries = std::make_unique<PairQueries>();
    std::vector<QueryResult> results(kPairsMax);
    std::vector<ContainmentResult> places(kPairsMax);
    Times posed, surfaces, contained, ratio;
    std::uint64_t rays = 0;
    while (ratio.ns.size() < 2000) {
        const AxisSnapshot snapshot = random_snapshot(loaded.machine, draw);
        const double posing_ns =
            least_ns([&] { make_contact_queries(loaded.machine, snapshot, *pair_queries); });
        const std::span<const Query> queries{pair_queries->queries.data(), pair_queries->count};
        const std::span<QueryResult> found{results.data(), pair_queries->count};
        const std::span<ContainmentResult> nested{places.data(), pair_queries->count};
        const double surface_ns = least_ns([&] { engine->run(queries, found); });
        if (std::any_of(found.begin(), found.end(),
                        [](const QueryResult& a) { return a.proof != Proof::far; })) {
            continue;  // a stop: no containment to query
        }
        const double containment_ns =
            least_ns([&] { containment_test->run(queries, found, nested); });
        for (const ContainmentResult& result : nested) {
            EXPECT_EQ(result.status, QueryStatus::ok);
            rays += result.rays;
        }
        posed.ns.push_back(posing_ns);
        surfaces.ns.push_back(surface_ns);
        contained.ns.push_back(containment_ns);
        ratio.ns.push_back(1000 * (posing_ns + surface_ns + containment_ns) /
                           (posing_ns + surface_ns));
    }
    std::printf("%s: %zu pairs, 2000 poses proven apart, %llu rays\n%-34s %9s %9s %9s\n",
                loaded.machine.name.c_str(), loaded.machine.pairs.size(),
                static_cast<unsigned long long>(rays), "", "median", "p99", "slowest");
    posed.print("plan");
    surfaces.print("surfaces, yes or no");
    contained.print("containment");
    std::printf("plan, surfaces and containment over plan and surfaces: %.2f median, %.2f most\n",
                ratio.at_share(0.5) * 1e-3, ratio.at_share(1) * 1e-3);
    EXPECT_LT(ratio.at_share(0.5) * 1e-3, 2);
}

TEST(ContainmentTime, OfThePapersMachine) {
    measure(test::load_paper_machine());
}

TEST(ContainmentTime, OfARealMachine) {
    const std::string root = std::string(AXG_SHARED_DATA) + "/machines/probe-basic-xyzac";
    if (!std::filesystem::exists(root)) {
        GTEST_SKIP() << "no shared data at " << root;
    }
    LoadedMachine loaded;
    ASSERT_TRUE(
        load(test::source_file("config/machines/probe-basic-xyzac.yaml"), root, loaded, stderr));
    measure(loaded);
}

TEST(ContainmentTime, InAQuarterOfAMillionTriangles) {
    test::Draw draw(test::printed_seed(32));
    test::ContainmentScene scene(
        {{"cube", test::box({-1, -1, -1}, {1, 1, 1})}, {"ring", test::ring(500, 250, 400, 150)}});
    Times queried;
    std::uint32_t most_nodes = 0, most_triangles = 0, inside = 0;
    while (queried.ns.size() < 1000) {
        Pose pose = test::random_rotation(draw);
        for (int k = 0; k < 3; ++k) {
            pose.t[k] = draw.between(-1, 1) * (k < 2 ? 550 : 150);
        }
        const Query query = test::ContainmentScene::about(pose);
        const QueryResult surface = test::run_query(scene.engine(), query);
        ContainmentResult result;
        scene.containment_test().run({&query, 1}, {&surface, 1}, {&result, 1});
        if (result.rays == 0) {
            continue;
        }
        queried.ns.push_back(least_ns([&] {
            scene.containment_test().run({&query, 1}, {&surface, 1}, {&result, 1});
        }));
        inside += result.containment == Containment::a_in_b ? 1 : 0;
        most_nodes = std::max(most_nodes, result.nodes);
        most_triangles = std::max(most_triangles, result.triangles);
    }
    std::printf(
        "1000 poses within the box of 250,000 triangles, %u inside; at most %u nodes, %u "
        "triangles\n",
        inside, most_nodes, most_triangles);
    queried.print("containment");
    EXPECT_LT(most_triangles, 250'000U / 100);
    EXPECT_GT(inside, 200U);
}

// Wide plates stacked on one another: no side is nearer than through half of them, and no tree can
// shorten that ray.
TEST(ContainmentTime, OfARayThroughEverything) {
    test::Triangles stack;
    for (int i = 0; i < 5000; ++i) {
        const auto z = static_cast<float>(4 * (i - 2500));
        stack = test::together(std::move(stack), test::box({-3e4F, -3e4F, z}, {3e4F, 3e4F, z + 1}));
    }
    const test::SolidBody body(stack);
    for (const Vec3d& p : {Vec3d{1234, 567, 2}, Vec3d{0, 0, 2}}) {  // between edges, along edges
        RayWork work;
        const double ns = least_ns([&] {
            work = RayWork{};
            EXPECT_TRUE(body.wound(p, work, {1U << 20, 1U << 20, 1U << 20}).is_known);
        });
        std::printf(
            "60,000 triangles in 5,000 plates: %u nodes, %u triangles, %u exact signs in "
            "%.1f us\n",
            work.nodes, work.triangles, work.exact_signs, ns * 1e-3);
        RayWork limited;
        const bool is_known = body.wound(p, limited).is_known;
        EXPECT_EQ(is_known, work.exact_signs <= Capacities{}.rechecks);
    }
}

// One sum in space: the point is in the plane of the facet but for the noise of its corners.
TEST(ContainmentTime, OfASignBeyondDouble) {
    const Vec3f e{8, 0x1p-90F, 0x1p-100F}, n{0x1p-95F, 8, 0x1p-92F}, u{0x1p-99F, 0x1p-93F, 8};
    const Vec3f o{0, 0, 0};
    const test::SolidBody body(test::Triangles{{o, n, e}, {o, e, u}, {o, u, n}, {e, n, u}});
    RayWork work;
    const double ns = least_ns([&] {
        work = RayWork{};
        EXPECT_EQ(body.wound({4, 3, 1}, work).number, 1);
    });
    std::printf("a point 2^-91 mm from a facet: %u exact signs in %.2f us\n", work.exact_signs,
                ns * 1e-3);
    EXPECT_EQ(work.exact_signs, 1U);
}

}  // namespace
}  // namespace axg
