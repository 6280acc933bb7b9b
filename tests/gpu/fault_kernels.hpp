// SPDX-License-Identifier: Apache-2.0
// Kernels that break a GPU on purpose.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

namespace axg::test {

/// Runs until *stop (pinned memory) is not 0.
cudaError_t launch_endless(const std::uint32_t* stop, cudaStream_t stream) noexcept;
/// Ends in a trap: the device is lost to this process.
cudaError_t launch_trap(cudaStream_t stream) noexcept;

}  // namespace axg::test
