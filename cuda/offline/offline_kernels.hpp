// SPDX-License-Identifier: Apache-2.0
// One wrapper per kernel of an offline batch. Grids depend on the batch: no cycle waits for them.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>

#include "cuda/offline/offline_data.hpp"

namespace axg::cuda {

/// Bytes of one OfflinePrepared, which only device code defines.
[[nodiscard]] std::size_t offline_prepared_size_bytes() noexcept;

/// Makes poses and constants: a thread a query.
cudaError_t launch_prepare_offline(const OfflineBuffers& buffers, cudaStream_t stream) noexcept;
/// Answers: a warp a query. Further blocks sum up the trees' memory.
cudaError_t launch_answer_offline(const OfflineBuffers& buffers, cudaStream_t stream) noexcept;

}  // namespace axg::cuda
