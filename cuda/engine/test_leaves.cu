// SPDX-License-Identifier: Apache-2.0
// The kernel for pairs of leaves that an engine uses unless its options name another one.
#include "cuda/engine/test_leaves.cuh"

namespace axg::cuda {

cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_leaves<AxisData::computed>(buffers, launch);
}

}  // namespace axg::cuda
