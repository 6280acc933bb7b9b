// SPDX-License-Identifier: Apache-2.0
// Kernels that break a GPU on purpose: one that does not end, one that traps.
#include "tests/gpu/fault_kernels.hpp"

namespace axg::test {
namespace {

__global__ void endless_kernel(const volatile std::uint32_t* stop) {
    while (*stop == 0) {
    }
}

__global__ void trap_kernel() {
    __trap();
}

}  // namespace

cudaError_t launch_endless(const std::uint32_t* stop, cudaStream_t stream) noexcept {
    endless_kernel<<<1, 1, 0, stream>>>(stop);
    return cudaGetLastError();
}

cudaError_t launch_trap(cudaStream_t stream) noexcept {
    trap_kernel<<<1, 1, 0, stream>>>();
    return cudaGetLastError();
}

}  // namespace axg::test
