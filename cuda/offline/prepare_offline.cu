// SPDX-License-Identifier: Apache-2.0
// First kernel of an offline batch, a thread a query: makes the pose of posed queries and the
// constants of all.
#include "cuda/engine/prepare_query.cuh"
#include "cuda/offline/offline_kernels.hpp"
#include "cuda/offline/offline_prepared.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64;
static_assert(sizeof(OfflinePrepared) % sizeof(uint4) == 0);

/// Fills the query from its item; false: it cannot be posed. Sets the item's batch.
__device__ bool read_query(const OfflineBuffers& b, std::uint32_t i, Query& q,
                           std::uint32_t& sequence) {
    q.kind = QueryKind::farther;
    if (b.given != nullptr) {
        const GivenItem& item = b.given[i];
        sequence = item.sequence;
        q.is_float_only = item.is_float_only != 0;
        q.mesh_a = item.mesh_a;
        q.mesh_b = item.mesh_b;
        q.r_mm = item.r_mm;
        q.pose_error_mm = item.pose_error_mm;
        q.pose = item.pose;
        return true;
    }
    const PosedItem item = b.posed[i];
    sequence = item.sequence;
    q.is_float_only = item.is_float_only != 0;
    q.r_mm = item.r_mm;
    q.pose_error_mm = item.pose_error_mm;
    return item.pair < b.pairs && item.row < b.rows &&
           fill_posed(b.joints, b.placed, b.posed_pairs[item.pair],
                      b.positions + std::size_t{item.row} * b.axes, q);
}

__global__ void __launch_bounds__(kThreads)
    prepare_offline_kernel(const __grid_constant__ OfflineBuffers b) {
    // Through shared memory, so that whole lines go to device memory.
    __shared__ OfflinePrepared prepared[kThreads];
    const std::uint32_t first = blockIdx.x * kThreads, i = first + threadIdx.x;
    if (i < b.count) {
        OfflinePrepared& to = prepared[threadIdx.x];
        Query q;
        std::uint32_t sequence = 0;
        const bool is_posed = read_query(b, i, q, sequence);
        to.is_usable = is_posed && prepare_query(b.trees, b.meshes, q, to.q) ? 1 : 0;
        to.sequence = sequence == b.sequence ? sequence : 0;
    }
    __syncthreads();
    constexpr std::uint32_t kWords = sizeof(OfflinePrepared) / sizeof(uint4);
    const std::uint32_t count = min(kThreads, b.count - first) * kWords;
    for (std::uint32_t k = threadIdx.x; k < count; k += kThreads) {
        reinterpret_cast<uint4*>(b.prepared + first)[k] =
            reinterpret_cast<const uint4*>(prepared)[k];
    }
}

}  // namespace

std::size_t offline_prepared_size_bytes() noexcept {
    return sizeof(OfflinePrepared);
}

cudaError_t launch_prepare_offline(const OfflineBuffers& buffers, cudaStream_t stream) noexcept {
    if (buffers.count == 0) {
        return cudaErrorInvalidValue;
    }
    prepare_offline_kernel<<<(buffers.count + kThreads - 1) / kThreads, kThreads, 0, stream>>>(
        buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
