// SPDX-License-Identifier: Apache-2.0
// Clearance: computes an upper bound of each distance before any pair is listed. One block per
// query descends to the pair of leaves whose boxes are nearest. The distance of the surfaces cannot
// exceed that of the nearest edges of their triangles, so farther pairs are never listed. The bound
// is fixed before the traversal begins, so the lists do not depend on the order of work.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 8, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 2;

struct Shared {
    float a[9][kNodeWidth], b[9][kNodeWidth];
    unsigned long long keys[kWarps];
    float squares[kWarps];
};

/// Bounds sort as their bits do. If bounds are equal (most boxes near contact overlap), the key of
/// the pair with the nearest centres is least.
__device__ unsigned long long key_of(float low, const Moved& m, const ChildBox& box, unsigned i,
                                     unsigned j) {
    const float d[3] = {m.c[0] - box.c[0], m.c[1] - box.c[1], m.c[2] - box.c[2]};
    const float square = lanes::fma(d[0], d[0], lanes::fma(d[1], d[1], d[2] * d[2]));
    return static_cast<unsigned long long>(__float_as_uint(low)) << 32U |
           (__float_as_uint(square) & ~0x3ffU) | i << 5U | j;
}

__device__ unsigned long long least_key(unsigned long long key, Shared& shared) {
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        key = min(key, __shfl_xor_sync(kAllLanes, key, step));
    }
    if (lane_of_thread() == 0) {
        shared.keys[threadIdx.x / kWarp] = key;
    }
    __syncthreads();
    for (const unsigned long long other : shared.keys) {
        key = min(key, other);
    }
    __syncthreads();
    return key;
}

/// The pair of children with the least bound.
__device__ PairEntry nearest_children(const PreparedQuery& q, const PairEntry& at, Shared& shared) {
    const TreeNode& a = q.a.nodes[at.a];
    const TreeNode& b = q.b.nodes[at.b];
    const bool leaf_a = is_leaf(a), leaf_b = is_leaf(b);
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    unsigned long long key = ~0ULL;
    if (leaf_a || leaf_b) {
        const TreeNode& node = leaf_a ? b : a;
        const Aabb& kept = leaf_a ? a.box : b.box;
        const Frame& frame = leaf_a ? q.c.a_in_b : q.c.b_in_a;
        if (lane < node.count) {
            const Moved moved = moved_box(frame, kept.c, kept.h);
            const ChildBox box = child_box(node, lane);
            key = key_of(low_bound(frame, moved, box), moved, box, lane, lane);
        }
    } else if (lane < b.count) {
        const ChildBox box = child_box(b, lane);
        for (unsigned i = warp; i < a.count; i += kWarps) {
            const ChildBox own = child_box(a, i);
            const Moved moved = moved_box(q.c.a_in_b, own.c, own.h);
            key = min(key, key_of(low_bound(q.c.a_in_b, moved, box), moved, box, i, lane));
        }
    }
    key = least_key(key, shared);
    const auto i = static_cast<std::uint32_t>(key >> 5U & 31U);
    const auto j = static_cast<std::uint32_t>(key & 31U);
    return {at.query, leaf_a ? at.a : a.first_child + i, leaf_b ? at.b : b.first_child + j, 0};
}

/// Squared length of the shortest segment found between edges of the two triangles.
__device__ float edge_square(const sat::TrianglePair<float>& p) {
    const sat::PairAxes<float> x = sat::axes_of(p);
    float least = __uint_as_float(0x7f800000U);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const auto d = sat::between_segments(p.a[i], x.ea[i], p.b[j], x.eb[j]);
            least = fminf(least, sat::dot3(d, d));
        }
    }
    return least;
}

/// An upper bound of the distance of two leaves. Segments end on the triangles except for
/// roundings, which the frame's slack covers many times (docs/theory/accuracy.md, section 5).
__device__ double leaf_bound(const PreparedQuery& q, const PairEntry& at, Shared& shared) {
    const TreeNode& a = q.a.nodes[at.a];
    const TreeNode& b = q.b.nodes[at.b];
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    if (warp == 0) {
        const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
        const MovedCentres to = move_centres<false>(q, a.box.c, nullptr, own.c);
        float v[9];
        move_triangle(q.c.a_in_b, a.box.c, to.a, q.a.leaves[a.leaf], lane, v);
        for (int k = 0; k < 9; ++k) {
            shared.a[k][lane] = v[k];
            shared.b[k][lane] = q.b.leaves[b.leaf].v[k][lane] - own.c[k % 3];
        }
    }
    __syncthreads();
    float square = __uint_as_float(0x7f800000U);
    if (lane < b.count) {
        for (unsigned i = warp; i < a.count; i += kWarps) {
            square = fminf(square, edge_square(float_pair(shared.a, i, shared.b, lane, q.c.d32)));
        }
    }
    square = warp_least(square);
    if (lane == 0) {
        shared.squares[warp] = square;
    }
    __syncthreads();
    for (const float other : shared.squares) {
        square = fminf(square, other);
    }
    return static_cast<double>(sqrtf(square)) * (1.0 + 0x1p-20) + q.c.a_in_b.slack;
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    seed_upper_bounds_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Shared shared;
    for (std::uint32_t query = blockIdx.x; query < b.counters->count; query += gridDim.x) {
        const PreparedQuery& q = b.prepared[query];
        Tally& tally = b.tallies[query];
        if (tally.refused != 0 || q.kind != QueryKind::clearance) {
            continue;
        }
        PairEntry at{query, 0, 0, 0};
        for (std::uint32_t tree_level = 0; tree_level < b.limits.tree_levels; ++tree_level) {
            if (!is_leaf(q.a.nodes[at.a]) || !is_leaf(q.b.nodes[at.b])) {
                at = nearest_children(q, at, shared);
            }
        }
        const double bound = leaf_bound(q, at, shared);
        if (threadIdx.x == 0 && bound < tally.bound_mm) {
            tally.bound_mm = bound;
        }
        __syncthreads();
    }
}

}  // namespace

cudaError_t launch_seed_upper_bounds(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(seed_upper_bounds_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
