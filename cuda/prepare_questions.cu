// SPDX-License-Identifier: Apache-2.0
// First kernel of a batch: questions from pinned memory, their constants, zeroed counters, and one
// pair of roots a question.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64;  // questions a block
static_assert(sizeof(Question) % 16 == 0);

/// Whether the engine can answer at all; if so, `ready` holds what it takes.
__device__ bool get_ready(const DeviceBuffers& b, const Question& q, Ready& ready) {
    if (q.mesh_a >= b.limits.meshes || q.mesh_b >= b.limits.meshes || !usable(q)) {
        return false;
    }
    ready.a = b.trees[q.mesh_a];
    ready.b = b.trees[q.mesh_b];
    if (ready.a.node_count == 0 || ready.b.node_count == 0) {
        return false;
    }
    ready.pose = q.pose;
    ready.inverse = inverse(q.pose);
    ready.ask = q.ask;
    ready.r_mm = q.r_mm;
    ready.wants_list = q.list.size() != 0;
    set_constants(ready.c, q, ready.a.reach_mm, ready.b.reach_mm);
    return true;
}

__device__ void start(const DeviceBuffers& b, std::uint32_t index, const Question& q,
                      std::uint32_t sequence) {
    Tally tally{};
    tally.sequence = sequence;
    tally.refused = get_ready(b, q, b.ready[index]) ? 0 : 1;
    // Nothing is nearer than 0 mm: a clearance up to there is known without a look.
    const bool has_work = tally.refused == 0 && (q.ask != Ask::clearance || q.r_mm > 0);
    tally.pairs_at[0] = has_work ? 1 : 0;
    tally.bound_mm = q.r_mm;
    tally.least_float = 0x7f800000U;
    tally.least_first = tally.least_second = __builtin_bit_cast(unsigned long long, q.r_mm);
    tally.nearest = ~0ULL;
    b.tallies[index] = tally;
    b.level[0][index] = {has_work ? index : kNoQuestion, 0, 0, 0};
}

__global__ void __launch_bounds__(kThreads)
    prepare_questions_kernel(const __grid_constant__ DeviceBuffers b) {
    // Through shared memory, so that the bus sees whole lines.
    constexpr unsigned kWords = kThreads * sizeof(Question) / sizeof(uint4);
    __shared__ uint4 words[kWords];
    const std::uint32_t sequence = b.head->sequence, count = min(b.head->count, b.limits.questions);
    const std::uint32_t first = blockIdx.x * kThreads;
    if (first < count) {
        const std::uint32_t here = min(kThreads, count - first);
        const uint4* const from = reinterpret_cast<const uint4*>(b.questions + first);
        for (unsigned i = threadIdx.x; i < here * (sizeof(Question) / sizeof(uint4));
             i += kThreads) {
            words[i] = from[i];
        }
        __syncthreads();
        if (threadIdx.x < here) {
            start(b, first + threadIdx.x, reinterpret_cast<const Question*>(words)[threadIdx.x],
                  sequence);
        }
    }
    if (blockIdx.x == 0 && threadIdx.x == 0) {
        Progress progress{};
        progress.sequence = sequence;
        progress.count = count;
        progress.listed[0] = count;
        *b.progress = progress;
    }
}

}  // namespace

std::size_t ready_size_bytes() noexcept {
    return sizeof(Ready);
}

cudaError_t launch_prepare_questions(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = (buffers.limits.questions + kThreads - 1) / kThreads;
    prepare_questions_kernel<<<blocks, kThreads, 0, launch.stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
