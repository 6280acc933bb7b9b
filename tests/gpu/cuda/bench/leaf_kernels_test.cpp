// SPDX-License-Identifier: Apache-2.0
// Every kernel for pairs of leaves gives what the engine's own gives, field for field: results,
// counts, and what groups used. AXG_COUNT: batches.
#include "cuda/bench/leaf_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kAmple = 1U << 30U;

/// Lists that are never full: what is found behind a full one depends on the order of work.
CudaOptions long_lists(cuda::LaunchLeaves launch_leaves) {
    CudaOptions options;
    options.level_pairs = 1U << 20U;
    options.leaf_pairs = 1U << 22U;
    options.candidates = 1;
    options.launch_leaves = launch_leaves;
    return options;
}

/// Field for field; pairs that touch are counted, and named in no order.
void expect_same(const QueryResult& x, const QueryResult& y, const char* kernel) {
    ASSERT_EQ(x.status, y.status) << kernel;
    ASSERT_EQ(x.proof, y.proof) << kernel;
    ASSERT_TRUE(test::equal_bits(x.clearance_mm, y.clearance_mm)) << kernel;
    if (x.status == QueryStatus::ok) {
        ASSERT_TRUE(test::equal_counts(x, y)) << kernel << "\n"
                                              << test::text_of(x) << "\n"
                                              << test::text_of(y);
    }
}

TEST(CudaLeafKernels, GiveTheBitsOfTheEnginesOwn) {
    test::Draw draw{test::printed_seed(243)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    const Capacities capacities = test::ample();
    AXG_CUDA_ENGINE_OR_SKIP(own, meshes, capacities, long_lists(nullptr));
    ASSERT_EQ(leaf_kernels().size(), 4U);
    for (const LeafKernel& kernel : leaf_kernels()) {
        AXG_CUDA_ENGINE_OR_SKIP(other, meshes, capacities, long_lists(kernel.launch));
        std::uint64_t far = 0, near = 0;
        const std::uint32_t count = test::number_from("AXG_COUNT", 40);
        for (std::uint32_t batch = 0; batch < count; ++batch) {
            const bool is_stage = batch % 2 == 1;
            std::vector<Query> queries(1 + draw.below(512));
            for (Query& q : queries) {
                q = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
                q.kind = q.kind == QueryKind::clearance ? QueryKind::farther : q.kind;
                q.is_float_only = draw.below(2) == 0;
                q.group = static_cast<std::uint16_t>(is_stage ? draw.below(4) : 0);
            }
            std::vector<GroupWork> x_groups(is_stage ? 4 : 0,
                                            {.share = {kAmple, kAmple, kAmple, kAmple, kAmple}});
            std::vector<GroupWork> y_groups = x_groups;
            std::vector<QueryResult> x(queries.size()), y(queries.size());
            own.run(queries, x, x_groups);
            other.run(queries, y, y_groups);
            ASSERT_EQ(own.fault(), nullptr) << own.fault();
            ASSERT_EQ(other.fault(), nullptr) << kernel.name << ": " << other.fault();
            for (std::size_t i = 0; i < queries.size(); ++i) {
                ASSERT_NO_FATAL_FAILURE(expect_same(x[i], y[i], kernel.name));
                (x[i].proof == Proof::far ? far : near) += 1;
            }
            for (std::size_t g = 0; g < x_groups.size(); ++g) {
                ASSERT_EQ(x_groups[g].used, y_groups[g].used) << kernel.name;
            }
        }
        EXPECT_GT(far, 0U);
        EXPECT_GT(near, 0U);
    }
}

}  // namespace
}  // namespace axg
