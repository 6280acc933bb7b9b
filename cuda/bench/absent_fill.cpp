// SPDX-License-Identifier: Apache-2.0
// What a build without a CUDA compiler has in place of the measurement of full batches.
#include "cuda/bench/measure_fill.hpp"

namespace axg {

std::optional<FillMeasurement> measure_fill(const Capacities&, const CudaOptions&, const FillCycle&,
                                            std::string& fault) {
    fault = kNoCudaInThisBuild;
    return std::nullopt;
}

}  // namespace axg
