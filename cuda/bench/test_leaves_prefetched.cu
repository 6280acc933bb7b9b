// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves with the axis data in shared memory, while the next pair loads (asynchronous
// copies since compute capability 8.0).
#include "cuda/bench/leaf_kernels.hpp"
#include "cuda/engine/test_leaves.cuh"

namespace axg::cuda {

int launch_leaves_prefetched(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_leaves<AxisData::prefetched>(buffers, launch);
}

}  // namespace axg::cuda
