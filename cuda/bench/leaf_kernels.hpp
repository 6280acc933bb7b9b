// SPDX-License-Identifier: Apache-2.0
// Other kernels for pairs of leaves than the engine's own, to be measured beside it: the same bits,
// another way to the axis data. No CUDA type shows here.
#pragma once

#include <span>
#include <string>

#include "cuda/engine/cuda_engine.hpp"

namespace axg {

struct LeafKernel {
    const char* name;
    cuda::LaunchLeaves launch;  // null: the engine's own
};

/// computed (the engine's own), cached, prefetched, and rolled: computed, with its axis loops left
/// as loops. What they are: AxisData in cuda/engine/kernels.hpp. Empty in a build without CUDA.
[[nodiscard]] std::span<const LeafKernel> leaf_kernels() noexcept;

namespace cuda {

int launch_leaves_cached(const DeviceBuffers& buffers, const Launch& launch) noexcept;
int launch_leaves_prefetched(const DeviceBuffers& buffers, const Launch& launch) noexcept;
int launch_leaves_rolled(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace cuda

}  // namespace axg
