// SPDX-License-Identifier: Apache-2.0
// Kernels for pairs of leaves to compare with the engine's own: they give the same bits from
// another source of the axis data. This header has no CUDA types.
#pragma once

#include <span>
#include <string>

#include "cuda/engine/cuda_engine.hpp"

namespace axg {

struct LeafKernel {
    const char* name;
    cuda::LaunchLeaves launch;  // null: the engine's own
};

/// computed (the engine's own), cached, prefetched, and rolled (computed without unrolled axis
/// loops). AxisData in cuda/engine/kernels.hpp defines the first three. Empty without CUDA.
[[nodiscard]] std::span<const LeafKernel> leaf_kernels() noexcept;

namespace cuda {

int launch_leaves_cached(const DeviceBuffers& buffers, const Launch& launch) noexcept;
int launch_leaves_prefetched(const DeviceBuffers& buffers, const Launch& launch) noexcept;
int launch_leaves_rolled(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace cuda

}  // namespace axg
