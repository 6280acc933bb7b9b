// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cuda/engine/device_traversal.cuh"
#include "cuda/offline/offline_data.hpp"

namespace axg::cuda {

/// A query between the two kernels of a batch.
struct alignas(16) OfflinePrepared {
    PreparedQuery q;
    std::uint32_t sequence;   // of the batch that prepared it; 0: its item was of another one
    std::uint32_t is_usable;  // 0: refused
};

}  // namespace axg::cuda
