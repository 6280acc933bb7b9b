// SPDX-License-Identifier: Apache-2.0
// On what a time was measured: the kind of processor, never a machine's name.
#pragma once

#include <string>

namespace axg::chart {

/// "one core of an AMD EPYC, avx512 with 16 lanes"; what the system does not say is left out.
[[nodiscard]] std::string format_processor();

}  // namespace axg::chart
