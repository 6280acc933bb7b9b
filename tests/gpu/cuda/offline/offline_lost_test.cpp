// SPDX-License-Identifier: Apache-2.0
// A device that is lost in the middle of an offline batch. A program of its own: nothing on the
// device works after it.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "cuda/offline/offline_parts.hpp"
#include "tests/gpu/fault_kernels.hpp"
#include "tests/support/offline_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

TEST(OfflineLost, TheDeviceIsLost) {
    test::Draw draw{test::printed_seed(91)};
    const std::vector<Mesh> meshes = {test::lumpy_ball(draw, 4, 30, 0.2)};
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
    Query query;
    query.pose.t[0] = 1000;
    QueryResult result;
    gpu.run({&query, 1}, {&result, 1});
    ASSERT_EQ(result.proof, Proof::far);
    ASSERT_EQ(test::launch_trap(gpu.parts().slots[0].stream), cudaSuccess);
    for (int i = 0; i < 3; ++i) {
        gpu.run({&query, 1}, {&result, 1});
        EXPECT_EQ(result.status, QueryStatus::not_run);
        EXPECT_EQ(result.proof, Proof::not_proven);
        ASSERT_NE(gpu.fault(), nullptr);
    }
    std::printf("%s\n", gpu.fault());
}

}  // namespace
}  // namespace axg
