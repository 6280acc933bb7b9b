// SPDX-License-Identifier: Apache-2.0
// The work of an engine's last batch, read from the device. Only for cuda/ and its tests.
#pragma once

#include <string>

#include "core/worst_case/worst_case_batch.hpp"
#include "cuda/engine/engine_parts.hpp"

namespace axg::cuda {

/// Returns the handled pairs of nodes and leaves, the tested rows, the counted pairs of triangles,
/// tested or not, and the rechecks done. Sets `fault` if the device fails.
[[nodiscard]] BatchWork last_work(const CudaEngine::Parts& parts, std::string& fault);

}  // namespace axg::cuda
