// SPDX-License-Identifier: Apache-2.0
// The test in double by a whole warp: one lane per axis or feature. A cycle waits for a single
// pair, so its latency matters, not its work. Tries the same vectors as
// core/collision/double_test.hpp and the same candidates as core/collision/closest_direction.hpp,
// so the results are equal to the bit.
#pragma once

#include "cuda/engine/device_traversal.cuh"

namespace axg::cuda {

/// One warp's vectors; each lane reads them by an index of its own.
struct PairVectors {
    // Vertices of a, of b; edges of a, of b; normals of a, of b.
    sat::V3<double> at[14];
};

/// A pair and its vectors, the same in every lane; `vectors` is the warp's own shared memory.
struct WarpPair {
    sat::TrianglePair<double> p;
    sat::PairAxes<double> x;
    const PairVectors& vectors;
};

__device__ __forceinline__ WarpPair warp_pair(const sat::TrianglePair<double>& p,
                                              PairVectors& vectors) {
    const sat::PairAxes<double> x = sat::axes_of(p);
    __syncwarp();
    if (lane_of_thread() == 0) {
        for (int i = 0; i < 3; ++i) {
            vectors.at[i] = p.a[i];
            vectors.at[3 + i] = p.b[i];
            vectors.at[6 + i] = x.ea[i];
            vectors.at[9 + i] = x.eb[i];
        }
        vectors.at[12] = x.na;
        vectors.at[13] = x.nb;
    }
    __syncwarp();
    return {p, x, vectors};
}

/// The seventeen axes: edges crossed with edges, edges with their own normals, the normals.
template <bool kMargin>
__device__ __forceinline__ bool warp_separated(const WarpPair& w, double margin) {
    const unsigned lane = lane_of_thread();
    unsigned first = 9, second = 10;  // b's normal: lane 16, and every lane beyond
    if (lane < 9) {
        first = 6 + lane / 3, second = 9 + lane % 3;
    } else if (lane < 15) {
        first = 6 + (lane - 9), second = lane < 12 ? 12 : 13;
    } else if (lane == 15) {
        first = 6, second = 7;
    }
    const auto axis = sat::cross3(w.vectors.at[first], w.vectors.at[second]);
    return ballot(sat::separates<kMargin>(w.p, axis, margin)) != 0;
}

/// The closest direction of nine pairs of edges and six pairs of vertex and face, one lane each.
/// The order of core/collision/closest_direction.hpp decides between equal ones.
__device__ __forceinline__ sat::V3<double> warp_closest(const WarpPair& w) {
    const unsigned lane = lane_of_thread();
    const sat::V3<double>* const v = w.vectors.at;
    sat::Closest<double> own;
    own.direction = sat::sub(w.p.b[0], w.p.a[0]);
    own.square = __longlong_as_double(0x7ff0000000000000LL);
    if (lane < 9) {
        const unsigned i = lane / 3, j = lane % 3;
        const auto d = sat::between_segments(v[i], v[6 + i], v[3 + j], v[9 + j]);
        sat::keep_closer(own, d, true);
    } else if (lane < 15) {
        const unsigned i = (lane - 9) / 2, side = (lane - 9) % 2;
        const sat::V3<double>& normal = v[12 + side];
        sat::try_face(own, v + 3 * side, v + 6 + 3 * side, normal, sat::dot3(normal, normal),
                      v[3 - 3 * side + i], side == 0);
    } else if (lane == 15) {
        own.square = sat::dot3(own.direction, own.direction);
    }
    unsigned order = lane == 15 ? 0 : lane + 1, winner = lane;
    double least = own.square;
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        const double square = __shfl_xor_sync(kAllLanes, least, step);
        const unsigned other = __shfl_xor_sync(kAllLanes, order, step);
        const unsigned from = __shfl_xor_sync(kAllLanes, winner, step);
        if (square < least || (square == least && other < order)) {
            least = square, order = other, winner = from;
        }
    }
    return {__shfl_sync(kAllLanes, own.direction.x, winner),
            __shfl_sync(kAllLanes, own.direction.y, winner),
            __shfl_sync(kAllLanes, own.direction.z, winner)};
}

template <bool kMargin>
__device__ __forceinline__ bool warp_apart(const WarpPair& w, double margin) {
    if (warp_separated<kMargin>(w, margin)) {
        return true;
    }
    if (!kMargin && !sat::thin(w.x.na, w.x.ea[0], w.x.ea[1]) &&
        !sat::thin(w.x.nb, w.x.eb[0], w.x.eb[1])) {
        return false;  // the seventeen axes are complete
    }
    return sat::separates<kMargin>(w.p, warp_closest(w), margin);
}

/// Deals the entries of all queries out to all warps of the grid, one at a time. `count_of` returns
/// the number of a query's entries; whole warps call `take` for each entry. Skips a query with more
/// entries than the queries dealt before it left of `budget`. One thread of the grid calls `note`
/// once per query with entries: whether they were dealt. Every thread of a block calls this;
/// `counts` is shared memory of kBatchQueriesMax words.
template <class CountOf, class Note, class Take>
__device__ __forceinline__ void deal(std::uint32_t queries, std::uint32_t budget,
                                     std::uint32_t* counts, const CountOf& count_of,
                                     const Note& note, const Take& take) {
    const unsigned warps = blockDim.x / kWarp, all_warps = gridDim.x * warps;
    const unsigned own = (threadIdx.x / kWarp) * gridDim.x + blockIdx.x;
    std::uint32_t dealt = 0;  // entries of the queries before, modulo all warps
    const unsigned whole = (queries + kWarp - 1) / kWarp * kWarp;
    for (unsigned i = threadIdx.x; i < whole; i += blockDim.x) {
        counts[i] = i < queries ? count_of(i) : 0;
    }
    __syncthreads();
    for (unsigned group = 0; group < whole; group += kWarp) {
        std::uint32_t bits = ballot(counts[group + lane_of_thread()] != 0);
        for (; bits != 0; bits &= bits - 1) {
            const unsigned i = group + lowest(bits);
            const std::uint32_t count = counts[i];
            const bool fits = count <= budget;
            if (blockIdx.x == 0 && threadIdx.x == 0) {
                note(i, fits);
            }
            if (!fits) {
                continue;
            }
            for (std::uint32_t e = (own + all_warps - dealt) % all_warps; e < count;
                 e += all_warps) {
                take(i, e);
            }
            dealt = (dealt + count) % all_warps;
            budget -= count;
        }
    }
}

}  // namespace axg::cuda
