// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves; the axis data of a triangle are computed once, in shared memory.
#include "cuda/bench/leaf_kernels.hpp"
#include "cuda/engine/test_leaves.cuh"

namespace axg::cuda {

int launch_leaves_cached(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_leaves<AxisData::cached>(buffers, launch);
}

}  // namespace axg::cuda
