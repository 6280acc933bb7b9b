// SPDX-License-Identifier: Apache-2.0
// The CUDA engine answers as the CPU engine does, bit for bit where the interface promises it:
// random scenes near contact, on whole coordinates, and of triangles without area or of next to no
// size. AXG_COUNT queries of each; the record is of 1e6 and more.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/awkward_triangles.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

std::uint32_t query_count(std::uint32_t usual) {
    return test::number_from("AXG_COUNT", usual);
}

struct Totals {
    std::uint64_t query_count = 0, far = 0, touching = 0, overflows = 0, near_clearances = 0;
    std::uint64_t other_nearest = 0, clearance_overflows = 0;
};

/// Lists agree as sets where both hold all that touches.
bool lists_agree(std::vector<TriangleIds> x, std::vector<TriangleIds> y, std::uint32_t touching) {
    if (touching > x.size()) {
        return true;
    }
    std::sort(x.begin(), x.begin() + touching);
    std::sort(y.begin(), y.begin() + touching);
    return std::equal(x.begin(), x.begin() + touching, y.begin());
}

void note(const Query& q, const QueryResult& x, const QueryResult& y, Totals& totals) {
    ++totals.query_count;
    totals.far += x.proof == Proof::far ? 1 : 0;
    totals.touching += x.touching != 0 ? 1 : 0;
    totals.overflows += test::is_overflow(x) && test::is_overflow(y) ? 1 : 0;
    if (q.kind == QueryKind::clearance) {
        totals.clearance_overflows += test::is_overflow(x) != test::is_overflow(y) ? 1 : 0;
        totals.near_clearances += x.clearance_mm > 0 && x.clearance_mm < q.r_mm ? 1 : 0;
        totals.other_nearest += x.nearest != y.nearest && x.clearance_mm > 0 ? 1 : 0;
    }
}

/// Runs batches of all sizes on both engines and compares every result.
void compare(CpuEngine& cpu, CudaEngine& gpu, test::Draw& draw, std::uint32_t mesh_count,
             std::uint32_t count, Totals& totals) {
    constexpr std::uint32_t kList = 24;
    constexpr std::uint32_t kBatches[] = {512, 1, 700, 31, 8, 512};
    std::uint32_t done = 0;
    for (std::uint32_t batch = 0; done < count; ++batch) {
        const std::uint32_t size = std::min(kBatches[batch % 6], count - done);
        std::vector<Query> queries(size);
        std::vector<QueryResult> x(size), y(size);
        std::vector<std::vector<TriangleIds>> list_x(size), list_y(size);
        for (std::uint32_t i = 0; i < size; ++i) {
            queries[i] = test::random_query(draw, mesh_count);
            queries[i].is_float_only = i % 4 == 1;
            list_x[i].resize(i % 3 == 0 ? kList : 0);
            list_y[i] = list_x[i];
            queries[i].list = list_x[i];
        }
        cpu.run(queries, x);
        for (std::uint32_t i = 0; i < size; ++i) {
            queries[i].list = list_y[i];
        }
        gpu.run(queries, y);
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        for (std::uint32_t i = 0; i < size; ++i) {
            const Query& q = queries[i];
            ASSERT_EQ(test::difference(q.kind, x[i], y[i]), "")
                << "question " << done + i << " ask " << static_cast<int>(q.kind) << " meshes "
                << q.mesh_a << "," << q.mesh_b << " r " << q.r_mm << "\n"
                << test::text_of(x[i]) << "\n"
                << test::text_of(y[i]);
            if (q.kind == QueryKind::touching && x[i].status == QueryStatus::ok &&
                !q.list.empty()) {
                ASSERT_TRUE(lists_agree(list_x[i], list_y[i], x[i].touching)) << done + i;
            }
            note(q, x[i], y[i], totals);
        }
        done += size;
    }
}

void print(const Totals& t) {
    std::printf(
        "%llu questions: %llu far, %llu touching, %llu too much for both, %llu clearances "
        "in range\nclearances: too much for one engine alone %llu, another pair of "
        "triangles named %llu\n",
        static_cast<unsigned long long>(t.query_count), static_cast<unsigned long long>(t.far),
        static_cast<unsigned long long>(t.touching), static_cast<unsigned long long>(t.overflows),
        static_cast<unsigned long long>(t.near_clearances),
        static_cast<unsigned long long>(t.clearance_overflows),
        static_cast<unsigned long long>(t.other_nearest));
}

TEST(CudaParity, RandomSurfacesNearContact) {
    test::Draw draw{test::printed_seed(11)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), CudaOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    Totals totals;
    const std::uint32_t count = query_count(20000);
    compare(*cpu, gpu, draw, static_cast<std::uint32_t>(meshes.size()), count, totals);
    print(totals);
    EXPECT_GT(totals.far, count / 10);
    EXPECT_GT(totals.touching, count / 20);
    EXPECT_GT(totals.near_clearances, count / 50);
    EXPECT_LT(totals.clearance_overflows, 1 + count / 100);
}

TEST(CudaParity, FewPlaces) {
    test::Draw draw{test::printed_seed(12)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    const Capacities few{200, 2000, 20};
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(few), CudaOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes, few);
    ASSERT_TRUE(cpu);
    Totals totals;
    const std::uint32_t count = query_count(20000);
    compare(*cpu, gpu, draw, static_cast<std::uint32_t>(meshes.size()), count, totals);
    print(totals);
    EXPECT_GT(totals.overflows, count / 100) << "the small capacities were met";
}

TEST(CudaParity, DegenerateTriangles) {
    test::Draw draw{test::printed_seed(13)};
    Totals totals;
    const std::uint32_t count = query_count(20000), scenes = 8;
    for (std::uint32_t scene = 0; scene < scenes; ++scene) {
        std::vector<Mesh> meshes;
        for (std::uint32_t i = 0; i < 6; ++i) {
            meshes.push_back(test::awkward_triangles(draw, i % 3));
        }
        AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), CudaOptions{});
        std::optional<CpuEngine> cpu = test::engine_over(meshes);
        ASSERT_TRUE(cpu);
        compare(*cpu, gpu, draw, static_cast<std::uint32_t>(meshes.size()), count / scenes, totals);
        if (HasFatalFailure()) {
            return;
        }
    }
    print(totals);
    EXPECT_GT(totals.far, count / 20);
    EXPECT_GT(totals.touching, count / 20);
}

TEST(CudaParity, RefusesWhatTheCpuRefuses) {
    test::Draw draw{test::printed_seed(14)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    meshes.push_back({"nothing", {}});
    const auto last = static_cast<std::uint32_t>(meshes.size() - 1);
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), CudaOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    std::vector<Query> queries(8);
    queries[0].mesh_a = last + 1;
    queries[1].mesh_b = last;
    queries[2].r_mm = -1;
    queries[3].r_mm = kMarginMmMax * 2;
    queries[4].pose.t[1] = 0.0 / 0.0;
    queries[5].pose.r[0][0] = 1 + 1e-8;
    queries[6].pose_error_mm = 2;
    queries[7].kind = QueryKind::clearance;  // nothing is nearer than 0: run, not refused
    std::vector<QueryResult> x(8), y(8);
    cpu->run(queries, x);
    gpu.run(queries, y);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        EXPECT_EQ(y[i].status, i < 7 ? QueryStatus::bad_query : QueryStatus::ok) << i;
        EXPECT_EQ(test::difference(queries[i].kind, x[i], y[i]), "") << i;
    }
}

}  // namespace
}  // namespace axg
