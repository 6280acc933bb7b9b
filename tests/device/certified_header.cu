// SPDX-License-Identifier: Apache-2.0
// The certified test as device code: that nvcc reads the same header as g++ and clang++, in float
// and double, with every option on, and needs no local memory for it.
#include "core/collision/closest_direction.hpp"
#include "core/collision/tri_sat.hpp"

template <class T>
__device__ axg::sat::TrianglePair<T> read_pair(const T* v) {
    axg::sat::TrianglePair<T> p;
    for (int i = 0; i < 3; ++i) {
        p.a[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
        p.b[i] = {v[3 * i + 9], v[3 * i + 10], v[3 * i + 11]};
    }
    p.scale = {v[18], v[19], v[20]};
    return p;
}

__global__ void judge_float(const float* pairs, float margin, int* apart, float* distance) {
    const auto p = read_pair(pairs + 21 * threadIdx.x);
    const auto closest = axg::sat::closest_direction(p, axg::sat::axes_of(p));
    apart[threadIdx.x] = axg::sat::separated_17<true>(p, margin) ||
                         axg::sat::separates<true>(p, closest.direction, margin);
    distance[threadIdx.x] = axg::sat::certified_distance(p, closest.direction);
}

__global__ void judge_double(const double* pairs, int* apart) {
    const auto p = read_pair(pairs + 21 * threadIdx.x);
    apart[threadIdx.x] = axg::sat::separated_17_wide<false>(p, axg::sat::axes_of(p), 0.0);
}
