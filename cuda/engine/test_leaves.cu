// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves as every engine takes them, unless it is made with another kernel.
#include "cuda/engine/test_leaves.cuh"

namespace axg::cuda {

cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_leaves<AxisData::computed>(buffers, launch);
}

}  // namespace axg::cuda
