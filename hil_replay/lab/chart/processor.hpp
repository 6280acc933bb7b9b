// SPDX-License-Identifier: Apache-2.0
// The processor model behind a measured time, never a machine's name.
#pragma once

#include <string>

namespace axg::chart {

/// "one core of an AMD EPYC, avx512 with 16 lanes", without parts that the system does not report.
[[nodiscard]] std::string format_processor();

}  // namespace axg::chart
