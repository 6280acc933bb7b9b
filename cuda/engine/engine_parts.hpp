// SPDX-License-Identifier: Apache-2.0
// The parts of the CUDA engine. For cuda/ and for the tests that break it on purpose.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/collision/tree.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "cuda/engine/device_data.hpp"
#include "cuda/engine/kernels.hpp"

namespace axg::cuda {

/// A green context's stream, or one over the whole device.
struct Partition {
    void* green = nullptr;  // CUgreenCtx
    cudaStream_t stream = nullptr;
    unsigned multiprocessors = 0;
};

/// Opens device 0. On failure returns false and sets `fault` to the reason.
[[nodiscard]] bool open_device(CudaDevice& device, std::string& fault);

/// Creates a stream on this many multiprocessors (0: all). On failure returns false, sets `fault`.
[[nodiscard]] bool make_partition(unsigned wanted, Partition& out, std::string& fault);
/// Destroys its stream and its context. Precondition: no work runs in it.
void close_partition(const Partition& partition) noexcept;

/// The most groups of a call: Query::group has 16 bits.
inline constexpr std::uint32_t kGroupsMax = 1U << 16U;
inline constexpr std::uint16_t kNoGroup = 0xffffU;

/// Builds the trees of an engine's meshes; those of unusable ones are empty.
[[nodiscard]] TreeBodies tree_bodies_of(std::span<const Mesh* const> meshes);

/// One batch as a graph. Null if it was not captured.
struct BatchGraph {
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t exec = nullptr;
};

}  // namespace axg::cuda

namespace axg {

struct CudaEngine::Parts {
    CudaMemoryPlan memory_plan;
    CudaDevice device;
    std::uint32_t deadline_us = 0;
    cuda::Partition partition;
    std::byte* device_memory = nullptr;
    std::byte* pinned_memory = nullptr;
    cuda::DeviceBuffers buffers;          // device addresses
    cuda::DeviceLimits clearance_limits;  // of a batch with a clearance query
    // Limits of a batch of queries in groups; without rechecks in double; and, also without them,
    // beginning with parts of boxes.
    cuda::DeviceLimits stage_limits, float_stage_limits, part_limits;
    // The same pinned memory, by host addresses.
    cuda::BatchHead* head = nullptr;
    Query* queries = nullptr;
    QueryTree* query_trees = nullptr;
    cuda::PartBlock* part_blocks = nullptr;
    cuda::DeviceResult* results = nullptr;
    TriangleIds* listed = nullptr;
    GroupSums* groups_in = nullptr;
    cuda::DeviceGroupResult* groups_out = nullptr;
    // Graphs without and with the kernels that clearance needs; in groups, with and without
    // rechecks; and beginning with parts of boxes.
    cuda::BatchGraph proofs, clearances, stages, float_stages, part_stages;
    std::uint32_t sequence = 0;  // of the last batch
    // Groups of a launch: the call's group at each place, and the place of each group of the call.
    std::vector<std::uint16_t> groups_here, place_of_group;
    const char* fault = nullptr;

    /// CudaEngine::create over trees instead of meshes.
    [[nodiscard]] static std::optional<CudaEngine> engine_over(const TreeBodies& bodies,
                                                               const Capacities& capacities,
                                                               const CudaOptions& options,
                                                               std::string& fault);

    void give_up(const char* why) noexcept {
        if (fault == nullptr) {
            fault = why;
        }
    }
};

}  // namespace axg
