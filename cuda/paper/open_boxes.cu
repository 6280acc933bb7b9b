// SPDX-License-Identifier: Apache-2.0
// The seed paper's two levels of boxes, breadth first: one thread per pair of sub-boxes. Without a
// bound of the roundings: for comparison only.
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

constexpr unsigned kThreads = 256;

__global__ void __launch_bounds__(kThreads)
    open_boxes_kernel(const __grid_constant__ OpenArguments q) {
    if (boxes_apart(q.a_in_b, q.a.whole, q.b.whole)) {
        return;
    }
    const unsigned i = blockIdx.x * kThreads + threadIdx.x;
    const GroupPair at{i / q.b.box_count, i % q.b.box_count};
    if (at.a < q.a.box_count && !boxes_apart(q.a_in_b, q.a.boxes[at.a], q.b.boxes[at.b])) {
        q.list[atomicAdd(&q.counters->listed, 1U)] = at;
    }
}

}  // namespace

cudaError_t launch_open_boxes(const OpenArguments& arguments, cudaStream_t stream) noexcept {
    const unsigned pairs = arguments.a.box_count * arguments.b.box_count;
    open_boxes_kernel<<<(pairs + kThreads - 1) / kThreads, kThreads, 0, stream>>>(arguments);
    return cudaGetLastError();
}

KernelFacts facts_of_open() {
    return facts_of(reinterpret_cast<const void*>(&open_boxes_kernel), "boxes");
}

}  // namespace axg::paper
