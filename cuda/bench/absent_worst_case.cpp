// SPDX-License-Identifier: Apache-2.0
// Replaces the measurement of worst-case batches in a build without a CUDA compiler.
#include "cuda/bench/measure_worst_case.hpp"

namespace axg {

std::optional<WorstCaseMeasurement> measure_worst_case(const CudaOptions&, const WorstCaseCycle&,
                                                       std::string& fault) {
    fault = kNoCudaInThisBuild;
    return std::nullopt;
}

}  // namespace axg
