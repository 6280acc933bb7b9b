// SPDX-License-Identifier: Apache-2.0
// A batch takes no memory on either side after the engine is made: every call of operator new
// counts, the heap in use (the driver's own included) does not grow, and neither does what the
// device has given out. AXG_COUNT batches.
#include <cuda_runtime.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <new>
#include <vector>

#include "tests/support/cuda_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace {
std::size_t allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size == 0 ? 1 : size)) {
        return memory;
    }
    std::abort();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace axg {
namespace {

std::size_t free_device_bytes() {
    std::size_t free_bytes = 0, all_bytes = 0;
    EXPECT_EQ(cudaMemGetInfo(&free_bytes, &all_bytes), cudaSuccess);
    return free_bytes;
}

TEST(CudaNoAlloc, BatchesTakeNoMemory) {
    test::Draw draw{test::printed_seed(51)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), CudaOptions{});
    constexpr std::size_t kBatch = 10, kBatches = 64;
    std::vector<Query> queries(kBatch * kBatches);
    std::vector<TriangleIds> list(16);
    for (Query& q : queries) {
        q = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
        q.list = list;
    }
    std::vector<QueryResult> results(kBatch);
    const std::uint32_t count = test::number_from("AXG_COUNT", 2000);
    std::size_t before = 0, heap_before = 0, free_before = 0, far = 0;
    for (std::uint32_t i = 0; i < count + kBatches; ++i) {
        if (i == kBatches) {  // every kind of batch has been run once
            free_before = free_device_bytes();
            heap_before = mallinfo2().uordblks;
            before = allocations;
        }
        gpu.run({queries.data() + i % kBatches * kBatch, kBatch}, results);
        far += results[0].proof == Proof::far ? 1 : 0;
    }
    EXPECT_EQ(allocations, before);
    EXPECT_EQ(mallinfo2().uordblks, heap_before);
    EXPECT_EQ(free_device_bytes(), free_before);
    EXPECT_EQ(gpu.fault(), nullptr);
    EXPECT_GT(far, count / 10);
}

TEST(CudaNoAlloc, AnAllocationIsSeen) {
    const std::size_t before = allocations, heap_before = mallinfo2().uordblks;
    // volatile: the compiler may otherwise leave both out; too large for the thread's own cache,
    // which the heap counts as in use.
    int* volatile numbers = new int[8192];
    EXPECT_GT(allocations, before);
    EXPECT_GT(mallinfo2().uordblks, heap_before);
    delete[] numbers;
}

}  // namespace
}  // namespace axg
