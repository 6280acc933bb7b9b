// SPDX-License-Identifier: Apache-2.0
// Arguments of the paper's kernels, and one wrapper per kernel. Only for cuda/paper/.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "cuda/engine/kernels.hpp"
#include "cuda/paper/certified_pair.hpp"
#include "cuda/paper/paper_gpu.hpp"
#include "cuda/paper/paper_scene.hpp"

namespace axg::paper {

inline constexpr std::uint32_t kPairsOfLaunchMax = 8;  // the paper's eight

/// One body in the device's memory.
struct DeviceBody {
    const Triangle* triangles = nullptr;
    const float* planes = nullptr;  // [9][triangle_count] the same coordinates, one after the other
    const SubBox* boxes = nullptr;
    const SubBox* tiles = nullptr;
    std::uint32_t triangle_count = 0, box_count = 0, tile_count = 0;
    SubBox whole{};
};

/// A group of a and a group of b.
struct GroupPair {
    std::uint32_t a, b;
};

/// One query's counts, zeroed before a series.
struct Counters {
    std::uint32_t touching, tested, left;
    std::uint32_t listed;  // entries of the launch's list
    std::uint32_t done;    // blocks that have finished that list
};

/// Counts in the host's memory, for which the host polls; the device writes `sequence` last.
struct Told {
    Counters counts[kPairsOfLaunchMax];
    std::uint32_t sequence;
};

/// A pair of triangles of query `query` that the first certified stage left undecided.
struct alignas(16) LeftPair {
    std::uint32_t query, a, b, unused;
};

struct OpenArguments {
    DeviceBody a, b;
    FloatPose a_in_b;
    GroupPair* list;
    Counters* counters;
};

struct TestArguments {
    DeviceBody a, b;
    FloatPose a_in_b, b_in_a;
    const GroupPair* list;  // null: every tile of a against every tile of b
    std::uint8_t* carried;  // [a][b] the axis that separated the pair last
    Counters* counters;
};

struct ProveArguments {
    std::uint32_t count, items;                   // queries, and items: one per warp
    std::uint32_t first_item[kPairsOfLaunchMax];  // of each query
    CertifiedPose pose[kPairsOfLaunchMax];
    DeviceBody a[kPairsOfLaunchMax], b[kPairsOfLaunchMax];
    LeftPair* left;
    Counters* counters;  // [count]; the first one has the length of the list
    Told* told;          // null: the host does not poll
    std::uint32_t sequence;
};

/// Tests the bodies' boxes, then every sub-box of a against every one of b.
cudaError_t launch_open_boxes(const OpenArguments& arguments, cudaStream_t stream) noexcept;

/// Tests the pairs of triangles, 32 x 32 per block. Precondition: blocks_of_test is not 0.
cudaError_t launch_test_pairs(const Techniques& techniques, const TestArguments& arguments,
                              unsigned blocks, cudaStream_t stream) noexcept;

/// Blocks of this kernel that a multiprocessor runs at once; 0: it was not compiled, or does not
/// load.
[[nodiscard]] unsigned blocks_of_test(const Techniques& techniques) noexcept;

/// Certified: the shared axes for every pair of triangles, then the later stages for the rest.
cudaError_t launch_prove_pairs(const ProveArguments& arguments, cudaStream_t stream) noexcept;
cudaError_t launch_prove_left(const ProveArguments& arguments, const cuda::Launch& launch) noexcept;

/// Items of one query, one per warp; first_item counts them.
[[nodiscard]] std::uint32_t prove_items(const DeviceBody& a, const DeviceBody& b) noexcept;

/// Resources of each compiled kernel.
[[nodiscard]] KernelFacts facts_of_open();
[[nodiscard]] KernelFacts facts_of_test(const Techniques& techniques);
[[nodiscard]] KernelFacts facts_of_prove();
[[nodiscard]] KernelFacts facts_of_left();
[[nodiscard]] KernelFacts facts_of(const void* kernel, std::string name);

}  // namespace axg::paper
