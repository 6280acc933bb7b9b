// SPDX-License-Identifier: Apache-2.0
// What a batch may use together: each list of the batch ends where it says, the constructed worst
// case does no less than any of many batches made to be bad, and overflow is never far and never
// depends on the order of work. AXG_COUNT: bad batches.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "cuda/bench/batch_work.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kQueries = 512, kTreeLevels = 2;

CudaOptions batch_options() {
    CudaOptions options;
    options.multiprocessors = test::number_from("AXG_SMS", 0);
    options.deadline_us = test::number_from("AXG_DEADLINE_US", 100'000);
    return options;
}

#define AXG_WORST_CASE_ENGINE_OR_SKIP(name, worst_case, capacities)         \
    std::string name##_fault;                                               \
    std::optional<CudaEngine> name##_made = CudaEngine::Parts::engine_over( \
        (worst_case).bodies, capacities, batch_options(), name##_fault);    \
    if (!name##_made) {                                                     \
        GTEST_SKIP() << name##_fault;                                       \
    }                                                                       \
    CudaEngine& name = *name##_made

TEST(CudaWorstCase, EveryListOfABatchEndsWhereItSays) {
    using Field = std::uint32_t BatchCapacities::*;
    constexpr Field kLists[] = {&BatchCapacities::level_pairs, &BatchCapacities::leaf_pairs,
                                &BatchCapacities::box_rows, &BatchCapacities::triangle_pairs,
                                &BatchCapacities::rechecks};
    const Capacities usual;
    WorstCaseBatch worst_case;
    ASSERT_EQ(
        make_worst_case_batch(usual, kQueries, kTreeLevels, WorstCaseLayout::even, worst_case), "");
    for (const Field list : kLists) {
        for (const int more : {-1, 0, 1}) {
            Capacities capacities = usual;
            capacities.batch.*list += static_cast<std::uint32_t>(more);
            AXG_WORST_CASE_ENGINE_OR_SKIP(gpu, worst_case, capacities);
            std::vector<QueryResult> results(kQueries);
            gpu.run(worst_case.queries, results);
            ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
            const auto lost = std::count_if(results.begin(), results.end(), test::is_overflow);
            // A batch without room for all rechecks loses the queries that do not fit.
            const int wanted = more >= 0 ? 0 : list == &BatchCapacities::rechecks ? 1 : 512;
            EXPECT_EQ(lost, wanted) << "list " << &list - kLists << " " << more;
            for (const QueryResult& result : results) {
                ASSERT_TRUE(test::is_overflow(result) || result.status == QueryStatus::ok);
                ASSERT_FALSE(test::is_overflow(result) && result.proof == Proof::far);
            }
        }
    }
}

TEST(CudaWorstCase, IsMeasuredAndDoesTheWorkItWasMadeFor) {
    std::string fault;
    for (const std::uint32_t tree_levels : {1U, 2U, 3U}) {
        WorstCaseCycle cycle = batch_cycle(Capacities{});
        cycle.tree_levels = tree_levels;
        cycle.count = 30;
        const auto measured = measure_worst_case(batch_options(), cycle, fault);
        if (!measured && tree_levels == 1 && fault.find("bug") == std::string::npos) {
            GTEST_SKIP() << fault;
        }
        ASSERT_TRUE(measured) << fault;
        ASSERT_EQ(measured->lines.size(), 9U);
        for (const WorstCaseMeasurement::Line& line : measured->lines) {
            ASSERT_EQ(line.cycle_us.size(), 10U);
            EXPECT_LE(*std::max_element(line.cycle_us.begin(), line.cycle_us.end()),
                      measured->us_max);
        }
        std::printf("%u levels: slowest %.1f us\n", tree_levels, measured->us_max);
    }
}

// Parts that the engine poses do the work that the batch was made for, else it is refused.
TEST(CudaWorstCase, IsMeasuredWithPartsThatTheEnginePoses) {
    for (const std::uint32_t roots : {1U, 8U, 32U, 256U}) {
        WorstCaseCycle cycle = batch_cycle(Capacities{});
        WorstCaseCall& call = cycle.calls[0];
        call.capacities.batch.rechecks = 0;
        call.queries = 514;
        call.is_stage = true;
        call.roots_max = roots;
        call.trees_max = 8;
        cycle.count = 9;
        std::string fault;
        const auto measured = measure_worst_case(batch_options(), cycle, fault);
        if (!measured && fault.find("bug") == std::string::npos) {
            GTEST_SKIP() << fault;
        }
        ASSERT_TRUE(measured) << fault;
        std::printf("%u roots: slowest %.1f us\n", roots, measured->us_max);
    }
}

/// Queries that are many, deep in contact, all of one pair, or of wide margins.
void draw_bad(test::Draw& draw, std::uint32_t mesh_count, std::vector<Query>& queries) {
    const std::uint32_t kind = draw.below(5);
    queries.resize(1 + draw.below(kQueries));
    for (Query& q : queries) {
        q = test::random_query(draw, mesh_count);
        q.kind = draw.below(2) == 0 ? QueryKind::farther : QueryKind::touching;
        q.r_mm = kind == 1 ? draw.between(0, 30) : draw.below(2) == 0 ? 0 : draw.between(0, 4);
        const double nearer = kind == 2 ? 0.2 : kind == 3 ? 0.6 : 1.0;
        for (double& t : q.pose.t) {
            t *= nearer;
        }
    }
    if (kind == 4) {
        std::fill(queries.begin(), queries.end(), queries[0]);
    }
}

void expect_no_more(const BatchWork& work, const BatchWork& most, std::uint32_t rows_beyond) {
    for (std::size_t tree_level = 0; tree_level < work.level_pairs.size(); ++tree_level) {
        ASSERT_LE(work.level_pairs[tree_level], most.level_pairs[tree_level])
            << "level " << tree_level;
    }
    ASSERT_LE(work.leaf_pairs, most.leaf_pairs);
    ASSERT_LE(work.rechecks, most.rechecks);
    ASSERT_LE(work.box_rows, most.box_rows + rows_beyond);
}

TEST(CudaWorstCase, NoBatchDoesMore) {
    test::Draw draw{test::printed_seed(61)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    const Capacities capacities;
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, capacities, CudaOptions{});
    std::optional<CpuEngine> cpu = test::engine_over(meshes, capacities);
    ASSERT_TRUE(cpu);
    ASSERT_LE(gpu.tree_levels(), kTreeLevels);
    WorstCaseBatch worst_case;
    ASSERT_EQ(
        make_worst_case_batch(capacities, kQueries, kTreeLevels, WorstCaseLayout::even, worst_case),
        "");
    // Who meets the end of the rows finishes the pair it is at: at most 32 rows, of the six blocks
    // that open on each level and of the sixteen warps in the leaves.
    const std::uint32_t rows_beyond =
        gpu.device().multiprocessors_used * kNodeWidth * (6 * kTreeLevels + 16);
    std::vector<Query> queries;
    std::vector<QueryResult> results, again, wanted;
    BatchWork most;
    std::uint32_t overflows = 0, far = 0;
    double us_max = 0;
    const std::uint32_t count = test::number_from("AXG_COUNT", 500);
    for (std::uint32_t i = 0; i < count; ++i) {
        draw_bad(draw, static_cast<std::uint32_t>(meshes.size()), queries);
        results.resize(queries.size());
        const auto start = std::chrono::steady_clock::now();
        gpu.run(queries, results);
        const std::chrono::duration<double, std::micro> spent =
            std::chrono::steady_clock::now() - start;
        us_max = std::max(us_max, spent.count());
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        std::string fault;
        const BatchWork work = cuda::last_work(gpu.parts(), fault);
        ASSERT_EQ(fault, "");
        expect_no_more(work, worst_case.work, rows_beyond);
        most.leaf_pairs = std::max(most.leaf_pairs, work.leaf_pairs);
        most.box_rows = std::max(most.box_rows, work.box_rows);
        most.rechecks = std::max(most.rechecks, work.rechecks);
        again.resize(queries.size());
        gpu.run(queries, again);
        for (std::size_t q = 0; q < results.size(); ++q) {
            ASSERT_EQ(results[q].status, again[q].status) << "batch " << i << " question " << q;
            ASSERT_EQ(results[q].proof, again[q].proof) << "batch " << i << " question " << q;
            overflows += test::is_overflow(results[q]) ? 1 : 0;
            far += results[q].proof == Proof::far ? 1 : 0;
        }
        if (i % 64 == 0) {  // the CPU takes its time
            wanted.resize(queries.size());
            cpu->run(queries, wanted);
            for (std::size_t q = 0; q < results.size(); ++q) {
                ASSERT_FALSE(results[q].proof == Proof::far && wanted[q].proof != Proof::far);
            }
        }
    }
    std::printf(
        "%u batches: slowest %.1f us; most leaf pairs %u, rows %u, rechecks %u; questions "
        "that overflowed %u, far %u\n",
        count, us_max, most.leaf_pairs, most.box_rows, most.rechecks, overflows, far);
    EXPECT_GT(overflows, 0U);
    EXPECT_GT(far, 0U);
    EXPECT_EQ(most.leaf_pairs, capacities.batch.leaf_pairs) << "the batches are bad enough";
}

}  // namespace
}  // namespace axg
