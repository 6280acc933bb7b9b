// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves with computed axis data and without unrolled axis loops.
#include "cuda/bench/leaf_kernels.hpp"
#include "cuda/engine/test_leaves.cuh"

namespace axg::cuda {

int launch_leaves_rolled(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_leaves<AxisData::computed, lanes::RolledFloat>(buffers, launch);
}

}  // namespace axg::cuda
