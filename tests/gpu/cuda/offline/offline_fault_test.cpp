// SPDX-License-Identifier: Apache-2.0
// An offline engine that is broken on purpose: steps left out, bits of the trees and of the answers
// turned over, a device that does not answer in time. None of it is read as a result.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "cuda/offline/offline_parts.hpp"
#include "tests/gpu/fault_kernels.hpp"
#include "tests/support/offline_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kQueries = 600;

/// Far where `is_far`, otherwise in the middle of each other.
std::vector<Query> pair_of_balls(bool is_far) {
    std::vector<Query> queries(kQueries);
    for (Query& q : queries) {
        q.pose.t[0] = is_far ? 500 : 3;
    }
    return queries;
}

class OfflineFault : public testing::Test {
  protected:
    /// Runs both kinds of queries in turn, so that what a batch left behind is wrong for the next.
    void settle(OfflineEngine& gpu) {
        for (int i = 0; i < 4; ++i) {
            gpu.run(pair_of_balls(true), results);
            ASSERT_EQ(results[kQueries - 1].proof, Proof::far);
        }
        ASSERT_EQ(gpu.fault(), nullptr);
    }
    void expect_lost(OfflineEngine& gpu) {
        for (int i = 0; i < 2; ++i) {
            gpu.run(pair_of_balls(false), results);
            ASSERT_NE(gpu.fault(), nullptr);
            for (const QueryResult& result : results) {
                ASSERT_EQ(result.status, QueryStatus::not_run);
                ASSERT_EQ(result.proof, Proof::not_proven);
            }
        }
    }

    test::Draw draw{test::printed_seed(81)};
    const std::vector<Mesh> meshes{test::lumpy_ball(draw, 6, 30, 0.2)};
    std::vector<QueryResult> results{kQueries};
};

TEST_F(OfflineFault, ALeftOutStepIsSeen) {
    for (std::uint32_t steps = 1; steps < 16; ++steps) {
        AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, (OfflineOptions{.queries_max = 256}));
        settle(gpu);
        gpu.parts().left_out = steps;
        expect_lost(gpu);
        std::printf("steps %x left out: %s\n", steps, gpu.fault());
    }
}

// Asks what is refused: no kernel then follows an index that was turned over.
TEST_F(OfflineFault, ChangedTreesAreSeen) {
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
    OfflineEngine::Parts& parts = gpu.parts();
    const std::size_t bytes = parts.wanted.size() * cuda::kOfflineSliceWords * std::size_t{16};
    const std::uint32_t count = test::number_from("AXG_COUNT", 300);
    Query refused;
    refused.r_mm = -1;
    for (std::uint32_t i = 0; i < count; ++i) {
        QueryResult result;
        gpu.run({&refused, 1}, {&result, 1});
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        ASSERT_EQ(result.status, QueryStatus::bad_query);
        std::byte* const at = parts.device_memory + draw.bits() % bytes;
        std::byte byte{};
        ASSERT_EQ(cudaMemcpy(&byte, at, 1, cudaMemcpyDeviceToHost), cudaSuccess);
        const std::byte turned = byte ^ std::byte{1} << draw.below(8);
        ASSERT_EQ(cudaMemcpy(at, &turned, 1, cudaMemcpyHostToDevice), cudaSuccess);
        gpu.run({&refused, 1}, {&result, 1});
        ASSERT_NE(gpu.fault(), nullptr) << "byte " << at - parts.device_memory;
        ASSERT_EQ(result.status, QueryStatus::not_run);
        parts.fault = nullptr;
        ASSERT_EQ(cudaMemcpy(at, &byte, 1, cudaMemcpyHostToDevice), cudaSuccess);
    }
}

TEST_F(OfflineFault, AnAnswerOfAnotherPlaceOrBatchIsSeen) {
    cuda::OfflineAnswer answer{};
    answer.sequence = 7;
    answer.state = cuda::kOfflineFar;
    answer.node_pairs = 3;
    answer.check = cuda::check_of(answer, 5);
    EXPECT_NE(answer.check, cuda::check_of(answer, 6)) << "the place";
    for (std::uint32_t word = 0; word < 6; ++word) {
        for (std::uint32_t bit = 0; bit < 32; ++bit) {
            cuda::OfflineAnswer changed = answer;
            std::uint32_t* const fields[] = {&changed.sequence,       &changed.check,
                                             &changed.state,          &changed.node_pairs,
                                             &changed.triangle_pairs, &changed.rechecks};
            *fields[word] ^= 1U << bit;
            EXPECT_NE(changed.check, cuda::check_of(changed, 5)) << word << " " << bit;
        }
    }
}

TEST_F(OfflineFault, ABatchThatDoesNotEndIsLost) {
    AXG_OFFLINE_ENGINE_OR_SKIP(gpu, meshes, Capacities{}, OfflineOptions{});
    settle(gpu);
    void* stop = nullptr;
    ASSERT_EQ(cudaHostAlloc(&stop, sizeof(std::uint32_t), cudaHostAllocMapped), cudaSuccess);
    auto* const flag = static_cast<volatile std::uint32_t*>(stop);
    *flag = 0;
    for (const cuda::OfflineSlot& slot : gpu.parts().slots) {
        ASSERT_EQ(test::launch_endless(const_cast<const std::uint32_t*>(flag), slot.stream),
                  cudaSuccess);
    }
    gpu.parts().options.deadline_us = 50'000;
    expect_lost(gpu);
    *flag = 1;
    ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
    ASSERT_EQ(cudaFreeHost(stop), cudaSuccess);
}

}  // namespace
}  // namespace axg
