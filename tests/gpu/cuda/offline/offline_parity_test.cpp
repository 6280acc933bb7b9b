// SPDX-License-Identifier: Apache-2.0
// Offline batches of all sizes answer as the CPU engine and the cycle's engine do: random scenes
// near contact, triangles without area, few places, full lists, and a machine posed on the device.
// AXG_COUNT queries of each; the record is of more than 1e6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/posed_queries.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "tests/support/awkward_triangles.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/offline_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

std::uint32_t offline_count() {
    return test::number_from("AXG_COUNT", 100'000);
}

struct OfflineTotals {
    std::uint64_t queries = 0, far = 0, near = 0, overflows = 0;
};

std::vector<Query> random_queries(test::Draw& draw, std::uint32_t meshes, std::uint32_t count) {
    std::vector<Query> queries(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        queries[i] = test::random_query(draw, meshes);
        queries[i].is_float_only = i % 4 == 1;
        if (i % 16 != 0) {  // the other kinds are the CPU engine's
            queries[i].r_mm = queries[i].kind == QueryKind::clearance ? 0.5 : queries[i].r_mm;
            queries[i].kind = QueryKind::farther;
        }
    }
    return queries;
}

void expect_equal(const std::vector<Query>& queries, const std::vector<QueryResult>& x,
                  const std::vector<QueryResult>& y, OfflineTotals& totals) {
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const std::string what = test::difference(queries[i].kind, x[i], y[i]);
        if (!what.empty() && differ++ == 0) {
            ADD_FAILURE() << "query " << i << ": " << what << "\n"
                          << test::text_of(x[i]) << "\n"
                          << test::text_of(y[i]);
        }
        ++totals.queries;
        totals.far += x[i].proof == Proof::far ? 1 : 0;
        totals.near += x[i].status == QueryStatus::ok && x[i].proof != Proof::far ? 1 : 0;
        totals.overflows += test::is_overflow(x[i]) ? 1 : 0;
    }
    EXPECT_EQ(differ, 0U);
}

/// Calls of all sizes, up to several batches.
OfflineTotals compare(CpuEngine& cpu, OfflineEngine& gpu, test::Draw& draw, std::uint32_t meshes,
                      std::uint32_t count) {
    constexpr std::uint32_t kCalls[] = {512, 1, 70'000, 31, 8'192, 3};
    OfflineTotals totals;
    for (std::uint32_t done = 0, call = 0; done < count; ++call) {
        const std::uint32_t size = std::min(kCalls[call % 6], count - done);
        const std::vector<Query> queries = random_queries(draw, meshes, size);
        std::vector<QueryResult> x(size), y(size);
        cpu.run(queries, x);
        gpu.run(queries, y);
        EXPECT_EQ(gpu.fault(), nullptr) << gpu.fault();
        expect_equal(queries, x, y, totals);
        done += size;
    }
    std::printf("%llu queries: %llu far, %llu near, %llu too much; %llu answered by the CPU\n",
                static_cast<unsigned long long>(totals.queries),
                static_cast<unsigned long long>(totals.far),
                static_cast<unsigned long long>(totals.near),
                static_cast<unsigned long long>(totals.overflows),
                static_cast<unsigned long long>(gpu.work().again));
    return totals;
}

TEST(OfflineParity, RandomSurfacesNearContact) {
    test::Draw draw{test::printed_seed(71)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, (OfflineOptions{.batches = 3}));
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    const std::uint32_t count = offline_count();
    const OfflineTotals totals =
        compare(*cpu, gpu, draw, static_cast<std::uint32_t>(meshes.size()), count);
    EXPECT_GT(totals.far, count / 10);
    EXPECT_GT(totals.near, count / 20);
    EXPECT_LT(gpu.work().again, count / 6) << "the lists hold nearly all";
}

TEST(OfflineParity, FarEqualsTheCyclesEngineInEveryField) {
    test::Draw draw{test::printed_seed(72)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
    AXG_CUDA_ENGINE_OR_SKIP(cycles, meshes, test::ample(), CudaOptions{});
    const std::uint32_t count = offline_count();
    std::vector<Query> queries =
        random_queries(draw, static_cast<std::uint32_t>(meshes.size()), count);
    std::erase_if(queries, [](const Query& q) { return q.kind != QueryKind::farther; });
    std::vector<QueryResult> x(queries.size()), y(queries.size());
    cycles.run(queries, x);
    gpu.run(queries, y);
    ASSERT_EQ(cycles.fault(), nullptr);
    ASSERT_EQ(gpu.fault(), nullptr);
    OfflineTotals totals;
    expect_equal(queries, x, y, totals);
    EXPECT_GT(totals.far, queries.size() / 10);
}

TEST(OfflineParity, FewPlacesAreTheCpusToAnswer) {
    test::Draw draw{test::printed_seed(73)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    const Capacities few{200, 2000, 20};
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, few, OfflineOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes, few);
    ASSERT_TRUE(cpu);
    const std::uint32_t count = offline_count();
    const OfflineTotals totals =
        compare(*cpu, gpu, draw, static_cast<std::uint32_t>(meshes.size()), count);
    EXPECT_GT(totals.overflows, count / 1000) << "the small capacities were met";
    EXPECT_GT(gpu.work().again, count / 1000);
}

TEST(OfflineParity, FullListsAreTheCpusToAnswer) {
    test::Draw draw{test::printed_seed(74)};
    // Two fine balls almost in the same place: more pairs of nodes open than the device lists.
    const std::vector<Mesh> meshes = {test::lumpy_ball(draw, 96, 50, 0),
                                      test::lumpy_ball(draw, 96, 49, 0)};
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, (Capacities{1U << 20U, 1U << 22U}), OfflineOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes, {1U << 20U, 1U << 22U});
    ASSERT_TRUE(cpu);
    std::vector<Query> queries(8);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        queries[i].mesh_b = 1;
        queries[i].r_mm = 0.01 * static_cast<double>(i);
        queries[i].pose = test::random_rotation(draw);
    }
    std::vector<QueryResult> x(queries.size()), y(queries.size());
    cpu->run(queries, x);
    gpu.run(queries, y);
    ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
    OfflineTotals totals;
    expect_equal(queries, x, y, totals);
    std::printf("%llu far, %llu near, %llu answered by the CPU\n",
                static_cast<unsigned long long>(totals.far),
                static_cast<unsigned long long>(totals.near),
                static_cast<unsigned long long>(gpu.work().again));
    EXPECT_GT(gpu.work().again, 0U) << "no list was full";
}

TEST(OfflineParity, DegenerateTriangles) {
    test::Draw draw{test::printed_seed(75)};
    constexpr std::uint32_t kScenes = 8;
    OfflineTotals totals;
    for (std::uint32_t scene = 0; scene < kScenes; ++scene) {
        std::vector<Mesh> meshes;
        for (std::uint32_t i = 0; i < 6; ++i) {
            meshes.push_back(test::awkward_triangles(draw, i % 3));
        }
        AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
        std::optional<CpuEngine> cpu = test::engine_over(meshes);
        ASSERT_TRUE(cpu);
        const OfflineTotals more = compare(*cpu, gpu, draw, 6, offline_count() / kScenes);
        totals.far += more.far;
        totals.near += more.near;
    }
    EXPECT_GT(totals.far, offline_count() / 20);
    EXPECT_GT(totals.near, offline_count() / 20);
}

TEST(OfflineParity, RefusesWhatTheCpuRefuses) {
    test::Draw draw{test::printed_seed(76)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    meshes.push_back({"nothing", {}});
    const auto last = static_cast<std::uint32_t>(meshes.size() - 1);
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    std::vector<Query> queries(8);
    queries[0].mesh_a = last + 1;
    queries[1].mesh_b = last;
    queries[2].r_mm = -1;
    queries[3].r_mm = kMarginMmMax * 2;
    queries[4].pose.t[1] = std::numeric_limits<double>::quiet_NaN();
    queries[5].pose.r[0][0] = 1 + 1e-8;
    queries[6].pose_error_mm = 2;
    queries[7].pose.t[0] = 1000;  // the only one that can be run
    std::vector<QueryResult> x(8), y(8);
    cpu->run(queries, x);
    gpu.run(queries, y);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        EXPECT_EQ(y[i].status, i < 7 ? QueryStatus::bad_query : QueryStatus::ok) << i;
        EXPECT_EQ(test::difference(queries[i].kind, x[i], y[i]), "") << i;
    }
    EXPECT_EQ(y[7].proof, Proof::far);
    gpu.run(std::span<const Query>{}, {});
    EXPECT_EQ(gpu.fault(), nullptr) << "a call without a query";
}

/// The shipped machine, posed by the host as in contact mode and by the device.
class OfflinePoses : public testing::Test {
  protected:
    void fill(std::uint32_t rows) {
        const Machine& machine = paper.loaded.machine;
        const auto pair_queries = std::make_unique<PairQueries>();
        for (std::uint32_t i = 0; i < rows; ++i) {
            const AxisSnapshot snapshot = sampled_position(machine, i);
            make_contact_queries(machine, snapshot, *pair_queries);
            const auto row = static_cast<std::uint32_t>(positions.size() / machine.axes.size());
            positions.insert(positions.end(), snapshot.position.begin(),
                             snapshot.position.begin() + machine.axes.size());
            for (std::uint32_t k = 0; k < pair_queries->count; ++k) {
                Query q = pair_queries->queries[k];
                q.r_mm = 0.25 * (i % 8);
                given.push_back(q);
                posed.push_back({posed_pair(machine, pair_queries->pair[k], pair_queries->tool),
                                 row, q.r_mm, q.pose_error_mm, false});
            }
        }
    }
    [[nodiscard]] std::optional<OfflineEngine> engine(std::string& fault) const {
        const PosedPairs pairs = posed_pairs_of(paper.loaded.machine);
        return OfflineEngine::create(surface_list(paper.loaded).engines,
                                     paper.loaded.machine.capacities, pairs.chains, pairs.pairs, {},
                                     fault);
    }

    test::PaperMachine paper;
    std::vector<double> positions;
    std::vector<PosedQuery> posed;
    std::vector<Query> given;
};

TEST_F(OfflinePoses, OfTheDeviceAreTheHosts) {
    std::string fault;
    std::optional<OfflineEngine> gpu = engine(fault);
    if (!gpu) {
        GTEST_SKIP() << fault;
    }
    fill(offline_count() / 4);
    std::vector<QueryResult> x(given.size()), y(given.size()), z(given.size());
    std::optional<CpuEngine> cpu =
        CpuEngine::create(surface_list(paper.loaded).engines, paper.loaded.machine.capacities);
    ASSERT_TRUE(cpu);
    cpu->run(given, x);
    gpu->run(PosedQueries{posed, positions}, y);
    gpu->run(given, z);
    ASSERT_EQ(gpu->fault(), nullptr) << gpu->fault();
    OfflineTotals totals;
    expect_equal(given, x, y, totals);
    expect_equal(given, y, z, totals);
    for (std::size_t i = 0; i < given.size(); ++i) {  // near ones too: the same engine, same bits
        ASSERT_TRUE(y[i].status == z[i].status && test::equal_counts(y[i], z[i])) << i;
    }
    std::printf(
        "%llu queries: %llu far, %llu near\n", static_cast<unsigned long long>(totals.queries),
        static_cast<unsigned long long>(totals.far), static_cast<unsigned long long>(totals.near));
    EXPECT_GT(totals.near, 100U);
}

TEST_F(OfflinePoses, RefusesWrongPairsRowsAndPositions) {
    std::string fault;
    std::optional<OfflineEngine> gpu = engine(fault);
    if (!gpu) {
        GTEST_SKIP() << fault;
    }
    fill(6);
    const std::size_t axes = paper.loaded.machine.axes.size(), pairs = given.size() / 6;
    positions[1 * axes] = std::numeric_limits<double>::infinity();
    positions[2 * axes + axes - 1] = 1e6;  // more than sin_cos() allows
    posed[3 * pairs].pair = 1U << 20U;
    posed.back().row = 6;
    std::vector<QueryResult> found(posed.size());
    gpu->run(PosedQueries{posed, positions}, found);
    ASSERT_EQ(gpu->fault(), nullptr) << gpu->fault();
    std::uint32_t refused[6] = {};
    for (std::size_t i = 0; i < found.size(); ++i) {
        refused[i / pairs] += found[i].status == QueryStatus::bad_query ? 1 : 0;
    }
    EXPECT_EQ(refused[0], 0U);
    EXPECT_GT(refused[1], 0U) << "pairs that the first axis moves";
    EXPECT_GT(refused[2], 0U);
    EXPECT_EQ(refused[3], 1U);
    EXPECT_EQ(refused[4], 0U);
    EXPECT_EQ(refused[5], 1U);
}

}  // namespace
}  // namespace axg
