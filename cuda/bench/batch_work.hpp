// SPDX-License-Identifier: Apache-2.0
// What the last batch of an engine came to, read from the device. For cuda/ and its tests alone.
#pragma once

#include <string>

#include "core/worst_case/worst_case_batch.hpp"
#include "cuda/engine/engine_parts.hpp"

namespace axg::cuda {

/// Pairs of nodes and leaves that were handled, rows that were tested, pairs of triangles that were
/// counted, tested or not, and rechecks that were done. `fault` is set where the device fails.
[[nodiscard]] BatchWork last_work(const CudaEngine::Parts& parts, std::string& fault);

}  // namespace axg::cuda
