// SPDX-License-Identifier: Apache-2.0
// The certified test of every pair of triangles of up to eight pairs of bodies in one launch: all
// seventeen axes from shared products for each, no box, no early exit. A warp tests eight triangles
// of a against 32 of b, one lane per triangle of b. Lists the pairs that remain undecided.
#include "core/collision/shared_axes.hpp"
#include "cuda/engine/launch_kernel.cuh"
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

constexpr unsigned kWarp = 32, kWarps = 4, kThreads = kWarps * kWarp;
constexpr unsigned kChunk = 8;  // triangles of a that share an origin

/// Nine coordinates per triangle, padded to three loads of 16 bytes.
struct alignas(16) Chunk {
    float v[kChunk][12];
};

/// One warp's work.
struct Work {
    unsigned query, first_a, first_b;
};

__host__ __device__ unsigned rounded_up(unsigned count, unsigned by) {
    return (count + by - 1) / by;
}

__device__ Work work_at(const ProveArguments& q, unsigned item) {
    unsigned query = 0;
    while (query + 1 < q.count && item >= q.first_item[query + 1]) {
        ++query;
    }
    const unsigned at = item - q.first_item[query];
    const unsigned tiles = rounded_up(q.b[query].triangle_count, kWarp);
    return {query, at / tiles * kChunk, at % tiles * kWarp};
}

/// Moves a chunk: 24 lanes move one vertex each.
__device__ void move_chunk(const CertifiedPose& pose, const DeviceBody& a, unsigned first,
                           const Vec3f& origin, Chunk& chunk) {
    const unsigned lane = threadIdx.x % kWarp, place = lane / 3;
    if (place < kChunk) {
        const Triangle& t = a.triangles[min(first + place, a.triangle_count - 1)];
        const Vec3f vertex = reinterpret_cast<const Vec3f*>(&t)[lane % 3];
        const sat::V3<float> moved = moved_vertex(pose.pose, vertex, origin);
        float* const to = &chunk.v[place][lane % 3 * 3];
        to[0] = moved.x, to[1] = moved.y, to[2] = moved.z;
    }
    __syncwarp();
}

__global__ void __launch_bounds__(kThreads)
    prove_pairs_kernel(const __grid_constant__ ProveArguments q) {
    cuda::wait_for_kernel_before();
    __shared__ Chunk chunks[kWarps];
    const unsigned warp = threadIdx.x / kWarp, item = blockIdx.x * kWarps + warp;
    if (item >= q.items) {
        return;
    }
    const Work work = work_at(q, item);
    const DeviceBody &a = q.a[work.query], &b = q.b[work.query];
    const CertifiedPose& pose = q.pose[work.query];
    const Vec3f origin = origin_of(pose.pose, a.triangles[work.first_a]);
    move_chunk(pose, a, work.first_a, origin, chunks[warp]);
    const unsigned place_b = work.first_b + threadIdx.x % kWarp;
    const Triangle other = b.triangles[min(place_b, b.triangle_count - 1)];
    const sat::V3<float> vb[3] = {less_origin(other.a, origin), less_origin(other.b, origin),
                                  less_origin(other.c, origin)};
    unsigned left = 0;
    for (unsigned i = 0; i < kChunk; ++i) {
        const float* const v = chunks[warp].v[i];
        const sat::V3<float> va[3] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
        const bool apart = sat::separated_shared<false, false>(va, vb, pose.d32, 0.0F);
        left |= apart ? 0U : 1U << i;
    }
    const unsigned used = min(kChunk, a.triangle_count - work.first_a);
    left &= place_b < b.triangle_count ? (1U << used) - 1U : 0U;
    if (left != 0) {
        const auto found = static_cast<unsigned>(__popc(left));
        atomicAdd(&q.counters[work.query].left, found);
        unsigned slot = atomicAdd(&q.counters->listed, found);
        for (; left != 0; left &= left - 1) {
            const auto i = static_cast<unsigned>(__ffs(static_cast<int>(left))) - 1;
            q.left[slot++] = {work.query, work.first_a + i, place_b, 0};
        }
    }
}

}  // namespace

std::uint32_t prove_items(const DeviceBody& a, const DeviceBody& b) noexcept {
    return rounded_up(a.triangle_count, kChunk) * rounded_up(b.triangle_count, kWarp);
}

cudaError_t launch_prove_pairs(const ProveArguments& arguments, cudaStream_t stream) noexcept {
    prove_pairs_kernel<<<rounded_up(arguments.items, kWarps), kThreads, 0, stream>>>(arguments);
    return cudaGetLastError();
}

KernelFacts facts_of_prove() {
    return facts_of(reinterpret_cast<const void*>(&prove_pairs_kernel), "certified, every pair");
}

}  // namespace axg::paper
