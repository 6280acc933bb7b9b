// SPDX-License-Identifier: Apache-2.0
// The seed paper's test: blocks of 32 x 32 threads, one thread per pair of triangles, with the
// paper's techniques as switches of one template. No bound of the roundings: for comparison only.
#include "core/base/assert.hpp"
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

constexpr unsigned kSide = kNodeWidth, kThreads = kSide * kSide, kAllLanes = 0xffffffffU;

/// A block's tile: the triangles of both groups in b's frame, and the numbers of those to test.
struct Tile {
    Triangle a[kSide], b[kSide];
    std::uint8_t kept[2][kSide];
    unsigned kept_count[2];
};

struct Groups {
    SubBox a, b;
};

__device__ unsigned group_pairs(const TestArguments& q) {
    return q.list != nullptr ? q.counters->listed : q.a.tile_count * q.b.tile_count;
}

__device__ Groups groups_at(const TestArguments& q, unsigned item) {
    if (q.list != nullptr) {
        const GroupPair at = q.list[item];
        return {q.a.boxes[at.a], q.b.boxes[at.b]};
    }
    return {q.a.tiles[item / q.b.tile_count], q.b.tiles[item % q.b.tile_count]};
}

/// Prefetch: this thread's vertex of the next pair of groups, still in its body's frame. The first
/// 96 threads load a's vertices, the next 96 b's.
__device__ Vec3f fetched(const TestArguments& q, unsigned item, unsigned count) {
    const unsigned t = threadIdx.y * kSide + threadIdx.x;
    if (item >= count || t >= 6 * kSide) {
        return {};
    }
    const Groups g = groups_at(q, item);
    const bool of_a = t < 3 * kSide;
    const SubBox& box = of_a ? g.a : g.b;
    const unsigned vertex = of_a ? t : t - 3 * kSide;
    const Triangle* const from = (of_a ? q.a.triangles : q.b.triangles) + box.first;
    return vertex < 3 * box.count ? reinterpret_cast<const Vec3f*>(from)[vertex] : Vec3f{};
}

__device__ void put(const TestArguments& q, const Vec3f& vertex, Tile& tile) {
    const unsigned t = threadIdx.y * kSide + threadIdx.x;
    if (t < 3 * kSide) {
        reinterpret_cast<Vec3f*>(tile.a)[t] = moved(q.a_in_b, vertex);
    } else if (t < 6 * kSide) {
        reinterpret_cast<Vec3f*>(tile.b)[t - 3 * kSide] = vertex;
    }
}

/// Coalesced: adjacent threads read adjacent floats, nine times.
__device__ Triangle from_planes(const DeviceBody& body, unsigned at) {
    const auto vertex = [&body, at](unsigned k) {
        const float* const x = body.planes + std::size_t{3} * k * body.triangle_count + at;
        return Vec3f{x[0], x[body.triangle_count], x[std::size_t{2} * body.triangle_count]};
    };
    return {vertex(0), vertex(1), vertex(2)};
}

template <bool kPrefetch>
__device__ Triangle triangle_of_a(const TestArguments& q, const Tile& tile, const SubBox& box,
                                  unsigned i) {
    return kPrefetch ? tile.a[i] : moved(q.a_in_b, q.a.triangles[box.first + i]);
}
template <bool kPrefetch>
__device__ Triangle triangle_of_b(const TestArguments& q, const Tile& tile, const SubBox& box,
                                  unsigned j) {
    return kPrefetch ? tile.b[j] : q.b.triangles[box.first + j];
}

/// Interchange: warp 0 tests a's triangles against b's box, warp 1 b's triangles against a's box.
template <bool kPrefetch>
__device__ void keep_near(const TestArguments& q, const Groups& g, Tile& tile) {
    const unsigned warp = threadIdx.y, lane = threadIdx.x;
    if (warp >= 2) {
        return;
    }
    bool near = false;
    if (warp == 0 && lane < g.a.count) {
        near = !triangle_apart(triangle_of_a<kPrefetch>(q, tile, g.a, lane), g.b);
    } else if (warp == 1 && lane < g.b.count) {
        near = !triangle_apart(moved(q.b_in_a, triangle_of_b<kPrefetch>(q, tile, g.b, lane)), g.a);
    }
    const unsigned bits = __ballot_sync(kAllLanes, near);
    if (near) {
        const int rank = __popc(bits & ((1U << lane) - 1U));
        tile.kept[warp][rank] = static_cast<std::uint8_t>(lane);
    }
    if (lane == 0) {
        tile.kept_count[warp] = static_cast<unsigned>(__popc(bits));
    }
}

/// Whether the pair counts as touching.
template <bool kUnroll, bool kCarry>
__device__ bool touches(const Triangle& a, const Triangle& b, std::uint8_t* carried) {
    const EdgedPair s = edged(a, b);
    if constexpr (kCarry) {
        const unsigned last = *carried;
        if (last != kNoAxis && apart_along_axis(s, last)) {
            return false;
        }
        const unsigned axis = separating_axis<kUnroll>(s);
        *carried = static_cast<std::uint8_t>(axis);
        return axis == kNoAxis;
    }
    return separating_axis<kUnroll>(s) == kNoAxis;
}

template <bool kInterchange, bool kPrefetch, bool kUnroll, bool kCarry>
__global__ void __launch_bounds__(kThreads)
    test_pairs_kernel(const __grid_constant__ TestArguments q) {
    // As bytes: clang refuses a shared variable whose members have initial values.
    alignas(Tile) __shared__ unsigned char space[sizeof(Tile)];
    Tile& tile = *reinterpret_cast<Tile*>(space);
    const unsigned count = group_pairs(q), t = threadIdx.y * kSide + threadIdx.x;
    unsigned tested = 0;
    Vec3f next{};
    if constexpr (kPrefetch) {
        next = fetched(q, blockIdx.x, count);
    }
    for (unsigned item = blockIdx.x; item < count; item += gridDim.x) {
        const Groups g = groups_at(q, item);
        if constexpr (kPrefetch) {
            put(q, next, tile);
            next = fetched(q, item + gridDim.x, count);  // arrives while this one is tested
            __syncthreads();
        }
        unsigned i = threadIdx.y, j = threadIdx.x;
        bool is_pair = i < g.a.count && j < g.b.count;
        if constexpr (kInterchange) {
            keep_near<kPrefetch>(q, g, tile);
            __syncthreads();
            const unsigned kept_b = tile.kept_count[1], pairs = tile.kept_count[0] * kept_b;
            is_pair = t < pairs;
            i = is_pair ? tile.kept[0][t / kept_b] : 0;
            j = is_pair ? tile.kept[1][t % kept_b] : 0;
            tested += pairs;
        } else {
            tested += g.a.count * g.b.count;
        }
        bool hit = false;
        if (is_pair) {
            const std::size_t at = std::size_t{g.a.first + i} * q.b.triangle_count + g.b.first + j;
            hit =
                touches<kUnroll, kCarry>(triangle_of_a<kPrefetch>(q, tile, g.a, i),
                                         triangle_of_b<kPrefetch>(q, tile, g.b, j), q.carried + at);
        }
        const unsigned hits = __ballot_sync(kAllLanes, hit);
        if (threadIdx.x == 0 && hits != 0) {
            atomicAdd(&q.counters->touching, static_cast<unsigned>(__popc(hits)));
        }
        if constexpr (kInterchange || kPrefetch) {
            __syncthreads();  // the next pair of groups overwrites the tile
        }
    }
    if (t == 0 && tested != 0) {
        atomicAdd(&q.counters->tested, tested);
    }
}

/// The kernel without any technique except the order in memory.
__global__ void __launch_bounds__(kThreads)
    test_coalesced_kernel(const __grid_constant__ TestArguments q) {
    const unsigned count = group_pairs(q), t = threadIdx.y * kSide + threadIdx.x;
    unsigned tested = 0;
    for (unsigned item = blockIdx.x; item < count; item += gridDim.x) {
        const Groups g = groups_at(q, item);
        const unsigned i = threadIdx.y, j = threadIdx.x;
        tested += g.a.count * g.b.count;
        bool hit = false;
        if (i < g.a.count && j < g.b.count) {
            hit = touches<false, false>(moved(q.a_in_b, from_planes(q.a, g.a.first + i)),
                                        from_planes(q.b, g.b.first + j), nullptr);
        }
        const unsigned hits = __ballot_sync(kAllLanes, hit);
        if (threadIdx.x == 0 && hits != 0) {
            atomicAdd(&q.counters->touching, static_cast<unsigned>(__popc(hits)));
        }
    }
    if (t == 0 && tested != 0) {
        atomicAdd(&q.counters->tested, tested);
    }
}

using Kernel = void (*)(TestArguments);

template <unsigned kBits>
constexpr Kernel kernel_of() {
    return &test_pairs_kernel<(kBits & 1U) != 0, (kBits & 2U) != 0, (kBits & 4U) != 0,
                              (kBits & 8U) != 0>;
}

/// The kernel without techniques, with one, with all or with all but one; null: not compiled.
Kernel kernel_for(const Techniques& t) {
    const unsigned bits = (t.interchange ? 1U : 0U) | (t.prefetch ? 2U : 0U) |
                          (t.unroll ? 4U : 0U) | (t.carry ? 8U : 0U);
    constexpr Kernel kAlone[] = {kernel_of<0>(), kernel_of<1>(), kernel_of<2>(),
                                 nullptr,        kernel_of<4>(), nullptr,
                                 nullptr,        kernel_of<7>(), kernel_of<8>()};
    constexpr Kernel kButOne[] = {kernel_of<11>(), nullptr, kernel_of<13>(), kernel_of<14>(),
                                  kernel_of<15>()};
    if (t.coalesced) {
        return bits == 0 ? &test_coalesced_kernel : nullptr;
    }
    return bits <= 8 ? kAlone[bits] : bits >= 11 ? kButOne[bits - 11] : nullptr;
}

}  // namespace

cudaError_t launch_test_pairs(const Techniques& techniques, const TestArguments& arguments,
                              unsigned blocks, cudaStream_t stream) noexcept {
    AXG_ASSERT(kernel_for(techniques) != nullptr);
    kernel_for(techniques)<<<blocks, dim3(kSide, kSide), 0, stream>>>(arguments);
    return cudaGetLastError();
}

unsigned blocks_of_test(const Techniques& techniques) noexcept {
    int blocks = 0;
    if (kernel_for(techniques) == nullptr) {
        return 0;
    }
    const cudaError_t error = cudaOccupancyMaxActiveBlocksPerMultiprocessor(
        &blocks, kernel_for(techniques), static_cast<int>(kThreads), 0);
    return error == cudaSuccess ? static_cast<unsigned>(blocks) : 0;
}

KernelFacts facts_of_test(const Techniques& techniques) {
    const auto mark = [](bool is_on, const char* name) { return is_on ? name : std::string(); };
    return facts_of(reinterpret_cast<const void*>(kernel_for(techniques)),
                    "test" + mark(techniques.interchange, " interchange") +
                        mark(techniques.unroll, " unroll") +
                        mark(techniques.prefetch, " prefetch") + mark(techniques.carry, " carry"));
}

}  // namespace axg::paper
