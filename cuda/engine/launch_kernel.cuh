// SPDX-License-Identifier: Apache-2.0
// Launches a kernel of a batch, and lets it wait for the kernel before it. If the device allows it
// (compute capability 9.0), a kernel is set up while the one before it still runs. Each kernel
// first waits for the one before it, so it never reads data before they are written.
#pragma once

#include <cuda_runtime.h>

#include "cuda/engine/kernels.hpp"

namespace axg::cuda {

/// First statement of every kernel of a batch, in every thread: allows the setup of the next kernel
/// and waits until the writes of all kernels before this one are visible.
__device__ __forceinline__ void wait_for_kernel_before() {
#if __CUDA_ARCH__ >= 900
    cudaTriggerProgrammaticLaunchCompletion();
    cudaGridDependencySynchronize();
#endif
}

template <class... Parameters, class... Arguments>
cudaError_t launch_kernel(void (*kernel)(Parameters...), unsigned blocks, unsigned threads,
                          const Launch& launch, const Arguments&... arguments) noexcept {
    cudaLaunchAttribute attribute{};
    attribute.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    attribute.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(threads);
    config.stream = launch.stream;
    config.attrs = &attribute;
    config.numAttrs = launch.overlaps ? 1 : 0;
    return cudaLaunchKernelEx(&config, kernel, arguments...);
}

}  // namespace axg::cuda
