// SPDX-License-Identifier: Apache-2.0
// A query's capacities on the GPU end where they do on the CPU: one place too few is not proven,
// just enough is proven, and so is one more.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using Field = std::uint32_t Capacities::*;
using Count = std::uint32_t QueryResult::*;

TEST(CudaCapacity, OneTooFewEnoughAndOneMore) {
    test::Draw draw{test::printed_seed(41)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::optional<CpuEngine> ample = test::engine_over(meshes);
    ASSERT_TRUE(ample);
    CudaOptions options;
    options.queries_max = 1;
    options.candidates = 16;
    const std::pair<Field, Count> limits[] = {
        {&Capacities::node_pairs, &QueryResult::node_pairs},
        {&Capacities::triangle_pairs, &QueryResult::triangle_pairs},
        {&Capacities::rechecks, &QueryResult::rechecks}};
    std::uint32_t tried[3] = {0, 0, 0};
    while (*std::min_element(tried, tried + 3) < 12) {
        Query q = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
        q.kind = QueryKind::touching;
        const QueryResult wanted = test::run_query(*ample, q);
        for (int l = 0; l < 3; ++l) {
            const std::uint32_t used = wanted.*limits[l].second;
            if (wanted.status != QueryStatus::ok || used < 2 || tried[l] >= 12) {
                continue;
            }
            ++tried[l];
            for (const int more : {-1, 0, 1}) {
                Capacities capacities = test::ample();
                capacities.*limits[l].first = used + static_cast<std::uint32_t>(more);
                AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, capacities, options);
                std::optional<CpuEngine> cpu = test::engine_over(meshes, capacities);
                QueryResult found;
                gpu.run({&q, 1}, {&found, 1});
                ASSERT_EQ(test::difference(q.kind, test::run_query(*cpu, q), found), "")
                    << "limit " << l << " " << used << " + " << more;
                ASSERT_EQ(test::is_overflow(found), more < 0) << test::text_of(found);
            }
        }
    }
}

}  // namespace
}  // namespace axg
