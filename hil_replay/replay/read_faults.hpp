// SPDX-License-Identifier: Apache-2.0
// Reads faults of the simulated wire: "lost=0.01,killed=2.5".
#pragma once

#include <string>
#include <string_view>

#include "hil_replay/board/can_bus.hpp"

namespace axg {

/// Shares from 0 to 1, instants in s after the first sample. Empty on success, else what is wrong.
[[nodiscard]] std::string read_faults(std::string_view text, BusFaults& faults);

}  // namespace axg
