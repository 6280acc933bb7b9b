// SPDX-License-Identifier: Apache-2.0
// A device that is lost in the middle of its work: a kernel traps, and with it the context is gone.
// The engine answers not_run from then on, at once, and its end does not hang. A program of its
// own, for nothing on the device works after it.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "cuda/engine/engine_parts.hpp"
#include "tests/gpu/fault_kernels.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

TEST(CudaFault, TheDeviceIsLost) {
    test::Draw draw{test::printed_seed(31)};
    const std::vector<Mesh> meshes = {test::lumpy_ball(draw, 4, 30, 0.2)};
    CudaOptions options;
    options.deadline_us = 50'000;
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), options);
    Query query;
    query.pose.t[0] = 1000;
    QueryResult result;
    gpu.run({&query, 1}, {&result, 1});
    ASSERT_EQ(result.proof, Proof::far);
    ASSERT_EQ(test::launch_trap(gpu.parts().partition.stream), cudaSuccess);
    for (int i = 0; i < 3; ++i) {
        gpu.run({&query, 1}, {&result, 1});
        EXPECT_EQ(result.status, QueryStatus::not_run);
        EXPECT_EQ(result.proof, Proof::not_proven);
        ASSERT_NE(gpu.fault(), nullptr);
    }
    std::printf("%s\n", gpu.fault());
    std::string fault;
    EXPECT_FALSE(test::cuda_engine_over(meshes, Capacities{}, options, fault))
        << "no second engine on a lost device";
    std::printf("%s\n", fault.c_str());
}

}  // namespace
}  // namespace axg
