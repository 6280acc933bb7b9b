// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves, one warp per pair: moves both leaves once, drops the triangles whose tight boxes
// are apart and gathers the remaining pairs of triangles. Then the warps of a block share the pairs
// of its four pairs of leaves, 32 at a time: the certified test, one thread per pair. A pair that
// float cannot decide is listed for the recheck, unless the query is float-only. The source of the
// axis data of a triangle, and whether axis loops are unrolled, changes no bit.
#pragma once

#if __has_include(<nv/target>)
#include <cuda_pipeline.h>
#define AXG_ASYNC_COPY 1
#else  // a toolkit without CCCL's headers, as PyPI's: lines are copied through registers
#define AXG_ASYNC_COPY 0
#endif

#include <type_traits>

#include "core/collision/lanes_rolled.hpp"
#include "cuda/engine/clip_leaves.cuh"
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 4;

/// One warp's tile.
struct Tile : MovedPair {
    PairEntry at;
    std::uint32_t count;    // of the pairs; 0 if they are not to be tested
    std::uint32_t handled;  // pairs of leaves
    std::uint32_t rows;     // of the batch, as last read by this warp
};

/// Axis data of both leaves of a tile, one array a number: two edges, normal, squares, area, reach.
constexpr unsigned kAxisNumbers = 14;
struct AxisTile {
    float a[kAxisNumbers][kNodeWidth], b[kAxisNumbers][kNodeWidth];
};

/// A warp's next pair of leaves, which loads while the warp tests this one.
struct NextPair {
    TreeNode node_a, node_b;
    TreeLeaf leaf_a, leaf_b;
};

template <AxisData kData>
struct Shared {
    static constexpr bool kStored = kData != AxisData::computed;
    static constexpr bool kPrefetched = kData == AxisData::prefetched;
    Tile tiles[kWarps];
    std::conditional_t<kStored, AxisTile[kWarps], std::byte> axes;
    alignas(kPrefetched ? alignof(NextPair)
                        : 16) std::conditional_t<kPrefetched, NextPair[kWarps], std::byte> next;
    std::uint32_t count;  // pairs of leaves of the batch
    bool is_lost;         // the batch exceeded its rows, as last seen by this block
};

/// Counts the pairs found. Returns whether they may be tested: neither the query, nor its group,
/// nor the batch exceeds its limit.
__device__ bool fits_budget(const DeviceBuffers& buffers, std::uint32_t query, std::uint32_t count,
                            std::uint32_t group) {
    std::uint32_t before = 0;
    bool fits = true;
    if (lane_of_thread() == 0) {
        before = atomicAdd(&buffers.tallies[query].triangle_pairs, count);
    } else if (lane_of_thread() == 1) {
        before = atomicAdd(&buffers.counters->triangle_pairs, count);
    } else if (lane_of_thread() == 2 && buffers.limits.is_stage) {
        fits = charge(buffers.groups[group], kTrianglePairsPlace, charged_pairs(count),
                      kLossOfTriangles);
    }
    const DeviceLimits& limits = buffers.limits;
    return ballot(!fits) == 0 &&
           __shfl_sync(kAllLanes, before, 0) + count <= limits.triangle_pairs &&
           __shfl_sync(kAllLanes, before, 1) + count <= buffers.counters->budget.triangle_pairs;
}

/// Stores the axis data of one triangle in a column, or loads them from it.
__device__ __forceinline__ void store_axes(const float (&v)[9][kNodeWidth], unsigned place,
                                           float (&to)[kAxisNumbers][kNodeWidth]) {
    sat::V3<float> corner[3];
    for (int i = 0; i < 3; ++i) {
        corner[i] = {v[3 * i][place], v[3 * i + 1][place], v[3 * i + 2][place]};
    }
    const sat::TriangleAxes<float> t = sat::axes_of_triangle(corner);
    const float numbers[kAxisNumbers] = {
        t.edge[0].x, t.edge[0].y, t.edge[0].z,  t.edge[1].x,  t.edge[1].y,  t.edge[1].z, t.normal.x,
        t.normal.y,  t.normal.z,  t.squares[0], t.squares[1], t.squares[2], t.area,      t.reach};
    for (unsigned i = 0; i < kAxisNumbers; ++i) {
        to[i][place] = numbers[i];
    }
}
__device__ __forceinline__ sat::TriangleAxes<float> load_axes(
    const float (&from)[kAxisNumbers][kNodeWidth], unsigned place) {
    float x[kAxisNumbers];
    for (unsigned i = 0; i < kAxisNumbers; ++i) {
        x[i] = from[i][place];
    }
    return {{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}},
            {x[6], x[7], x[8]},
            {x[9], x[10], x[11]},
            x[12],
            x[13]};
}

/// Starts a copy of whole lines of 16 bytes by all lanes of a warp.
__device__ __forceinline__ void start_copy(void* to, const void* from, unsigned bytes) {
    for (unsigned at = lane_of_thread() * 16; at < bytes; at += kWarp * 16) {
        char* const line = static_cast<char*>(to) + at;
        const char* const source = static_cast<const char*>(from) + at;
#if AXG_ASYNC_COPY
        __pipeline_memcpy_async(line, source, 16);
#else
        *reinterpret_cast<uint4*>(line) = *reinterpret_cast<const uint4*>(source);
#endif
    }
}

/// Starts to read the i-th pair of leaves of the batch. Called by whole warps.
__device__ void prefetch(const DeviceBuffers& b, std::uint32_t i, std::uint32_t count,
                         NextPair& next) {
    static_assert(sizeof(TreeNode) % 16 == 0 && sizeof(TreeLeaf::v) % 16 == 0);
    if (i < count) {
        const PairEntry at = b.leaves[i];
        const PreparedQuery& q = b.prepared[at.query];
        const TreeNode &node_a = q.a.nodes[at.a], &node_b = q.b.nodes[at.b];
        start_copy(&next.node_a, &node_a, sizeof node_a);
        start_copy(&next.node_b, &node_b, sizeof node_b);
        start_copy(next.leaf_a.v, q.a.leaves[node_a.leaf].v, sizeof next.leaf_a.v);
        start_copy(next.leaf_b.v, q.b.leaves[node_b.leaf].v, sizeof next.leaf_b.v);
    }
#if AXG_ASYNC_COPY
    __pipeline_commit();
#endif
}

/// Gathers the pairs of triangles of one pair of leaves. Called by whole warps; returns the batch's
/// rows of boxes so far to the first lane.
/// @param next  the pair if it was prefetched, else null
__device__ std::uint32_t gather(const DeviceBuffers& buffers, Tile& tile, const NextPair* next) {
    const PreparedQuery& q = buffers.prepared[tile.at.query];
    const TreeNode& a = next != nullptr ? next->node_a : q.a.nodes[tile.at.a];
    const TreeNode& b = next != nullptr ? next->node_b : q.b.nodes[tile.at.b];
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    const Leaves l{a,
                   b,
                   next != nullptr ? next->leaf_a : q.a.leaves[a.leaf],
                   next != nullptr ? next->leaf_b : q.b.leaves[b.leaf],
                   {own.c[0], own.c[1], own.c[2]}};
    const ClippedLeaf clipped = move_leaves(q, l, tile);
    std::uint32_t rows = 0;
    const auto more = static_cast<std::uint32_t>(__popc(clipped.bits_b));
    if (lane_of_thread() == 0 && more != 0) {
        rows = atomicAdd(&buffers.counters->box_rows, more) + more;
    } else if (lane_of_thread() == 1 && more != 0 && buffers.limits.is_stage) {
        charge(buffers.groups[q.group], kBoxRowsPlace, more, kLossOfClipping);
    }
    const std::uint32_t count = clip(q, l, clipped, tile);
    if (count != 0 && fits_budget(buffers, tile.at.query, count, q.group) &&
        lane_of_thread() == 0) {
        tile.count = count;
    }
    return rows;
}

/// Whether the triangles are certified apart. Sets `edges_square` if they are not.
template <bool kMargin, class Lane>
__device__ __forceinline__ bool test_pair(const sat::PairLimits<Lane>& limits,
                                          const LaneVertices<Lane>& v,
                                          const sat::StoredAxes<float>* stored,
                                          Lane* edges_square) {
    if constexpr (std::is_same_v<Lane, float>) {
        if (stored != nullptr) {
            const sat::EdgePair<float> p{{stored->a.edge[0], stored->a.edge[1]},
                                         {stored->b.edge[0], stored->b.edge[1]},
                                         sat::sub(v.b[0], v.a[0])};
            return sat::separated_edges<kMargin, true>(p, v.a[0], *stored, limits.d,
                                                       limits.r_square) ||
                   sat::apart_by_itself<kMargin>(false, v.a, v.b, limits, edges_square);
        }
    }
    return sat::apart<kMargin>(v.a, v.b, limits, edges_square);
}

/// The certified test of one pair of triangles.
/// @param axes  of the tile; null: computed here
template <class Lane>
__device__ __forceinline__ void test(const DeviceBuffers& buffers, const Tile& tile,
                                     const AxisTile* axes, unsigned i) {
    const PreparedQuery& q = buffers.prepared[tile.at.query];
    const sat::PairLimits<Lane> limits{{tile.d}, {q.c.margin}, {q.c.r_square}};
    const unsigned place_a = tile.pairs[i] >> 5U, place_b = tile.pairs[i] & 31U;
    const LaneVertices<Lane> v = in_lane<Lane>(vertices_of(tile.a, place_a, tile.b, place_b));
    sat::StoredAxes<float> stored;
    if (axes != nullptr) {
        stored = {load_axes(axes->a, place_a), load_axes(axes->b, place_b)};
    }
    const sat::StoredAxes<float>* const data = axes != nullptr ? &stored : nullptr;
    Lane edges_square = lanes::Traits<Lane>::of(0);
    const bool apart = q.c.has_margin ? test_pair<true>(limits, v, data, &edges_square)
                                      : test_pair<false>(limits, v, data, &edges_square);
    if (apart) {
        return;
    }
    // Reads again which query and which triangles: in registers during the whole test they are too
    // many for compute capability 11.0.
    const PreparedQuery& again =
        buffers.prepared[*static_cast<const volatile std::uint32_t*>(&tile.at.query)];
    const unsigned places = *static_cast<const volatile std::uint16_t*>(&tile.pairs[i]);
    const bool is_near =
        again.c.has_margin && sat::certified_within(sat::scaled_pair(v.a, v.b, Lane{tile.d}),
                                                    edges_square, Lane{again.near_mm});
    const bool is_farther = again.kind == QueryKind::farther;
    if (buffers.limits.is_stage && !(again.is_float_only && is_farther)) {
        // Charges a pair certified within the margin too: the CPU rechecks pairs up to the first
        // that touches, never more than are charged here.
        charge(buffers.groups[again.group], kRechecksPlace, 1, kLossOfRechecks);
    }
    if ((is_near || again.is_float_only) && is_farther) {
        // The result is settled. Later kernels read it after this kernel has counted all pairs, so
        // the work does not depend on the order.
        atomicOr(&buffers.tallies[tile.at.query].near, 1U);
        return;
    }
    const std::uint32_t slot = atomicAdd(&buffers.tallies[tile.at.query].rechecks, 1U);
    if (slot < buffers.limits.rechecks) {
        const std::size_t row = std::size_t{tile.at.query} * buffers.limits.rechecks;
        buffers.rechecks[row + slot] = {tile.at.a,
                                        tile.at.b,
                                        static_cast<std::uint8_t>(places >> 5U),
                                        static_cast<std::uint8_t>(places & 31U),
                                        static_cast<std::uint16_t>(is_near ? 1 : 0),
                                        0};
    } else if (buffers.limits.is_stage) {
        atomicMin(&buffers.groups[again.group].lost, kLossOfRechecks);
    }
}

/// Tests the pairs in the block's tiles; each warp tests 32 at a time.
template <AxisData kData, class Lane>
__device__ void test_rooms(const DeviceBuffers& buffers, const Shared<kData>& shared) {
    const unsigned warp = threadIdx.x / kWarp;
    unsigned dealt = 0;
#pragma unroll 1
    for (const Tile& tile : shared.tiles) {
        const AxisTile* axes = nullptr;
        if constexpr (Shared<kData>::kStored) {
            axes = &shared.axes[&tile - shared.tiles];
        }
        const unsigned shares = (tile.count + kWarp - 1) / kWarp;
#pragma unroll 1
        for (unsigned n = (warp + kWarps - dealt) % kWarps; n < shares; n += kWarps) {
            const unsigned i = n * kWarp + lane_of_thread();
            if (i < tile.count) {
                test<Lane>(buffers, tile, axes, i);
            }
        }
        dealt = (dealt + shares) % kWarps;
    }
}

/// Whether this warp's pair of leaves, the i-th of the batch, is to be tested. Counts it.
__device__ bool take(const DeviceBuffers& b, std::uint32_t i, std::uint32_t count, Tile& tile) {
    if (i >= count) {
        return false;
    }
    const PairEntry at = b.leaves[i];
    if (b.prepared[at.query].kind == QueryKind::clearance) {
        return false;  // measure_leaves handles those
    }
    if (lane_of_thread() == 0) {
        tile.at = at;
        ++tile.handled;
    }
    __syncwarp();  // the other lanes read tile.at, and a vote does not order memory
    // Other warps may lose the group meanwhile: all lanes of this warp have to agree.
    return ballot(is_lost(b, b.prepared[at.query], kLossOfClipping)) == 0 &&
           !is_over(b.tallies[at.query], kTreeLevelsMax - 1, b.limits.node_pairs);
}

/// Fills this warp's tile from its pair of leaves, and stores the axis data of the triangles.
template <AxisData kData>
__device__ void fill_tile(const DeviceBuffers& b, Shared<kData>& shared, unsigned warp) {
    Tile& tile = shared.tiles[warp];
    const NextPair* next = nullptr;
    if constexpr (Shared<kData>::kPrefetched) {
        next = &shared.next[warp];
    }
    const std::uint32_t rows = gather(b, tile, next);
    if (lane_of_thread() == 0) {
        tile.rows = rows;
    }
    if constexpr (Shared<kData>::kStored) {
        __syncwarp();
        if (tile.count != 0) {
            store_axes(tile.a, lane_of_thread(), shared.axes[warp].a);
            store_axes(tile.b, lane_of_thread(), shared.axes[warp].b);
        }
    }
}

template <AxisData kData, class Lane>
__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    test_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Shared<kData> shared;
    const unsigned warp = threadIdx.x / kWarp;
    Tile& tile = shared.tiles[warp];
    if (lane_of_thread() == 0) {
        tile.handled = 0;
        tile.rows = 0;
    }
    if (threadIdx.x == 0) {
        shared.is_lost = false;
        shared.count = min(b.counters->leaf_listed, b.counters->budget.leaf_pairs);
    }
    __syncthreads();
    if constexpr (Shared<kData>::kPrefetched) {
        prefetch(b, blockIdx.x + warp * gridDim.x, shared.count, shared.next[warp]);
    }
    // Every block gets one pair before any block gets a second.
    for (std::uint32_t base = blockIdx.x; base < shared.count; base += kWarps * gridDim.x) {
        if (lane_of_thread() == 0) {
            tile.count = 0;
        }
        __syncthreads();
        // Rows beyond the limit: the whole batch is not proven, so this may skip pairs.
        const bool is_lost = shared.is_lost;
        const std::uint32_t i = base + warp * gridDim.x;
        if constexpr (Shared<kData>::kPrefetched) {
#if AXG_ASYNC_COPY
            __pipeline_wait_prior(0);
#endif
            __syncwarp();
        }
        if (take(b, i, shared.count, tile) && !is_lost) {
            fill_tile(b, shared, warp);
        }
        if constexpr (Shared<kData>::kPrefetched) {
            __syncwarp();  // no lane reads this pair any more
            prefetch(b, i + kWarps * gridDim.x, shared.count, shared.next[warp]);
        }
        __syncthreads();
        if (threadIdx.x == 0) {
            for (const Tile& other : shared.tiles) {
                shared.is_lost = shared.is_lost || other.rows > b.counters->budget.box_rows;
            }
        }
        test_rooms<kData, Lane>(b, shared);
        __syncthreads();
    }
    if (lane_of_thread() == 0 && tile.handled != 0) {
        atomicAdd(&b.counters->leaf_handled, tile.handled);
    }
}

}  // namespace

/// Launches the kernel over these axis data.
/// @tparam Lane  float: axis loops unrolled; lanes::RolledFloat: loops
template <AxisData kData, class Lane = float>
cudaError_t launch_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(test_leaves_kernel<kData, Lane>, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
