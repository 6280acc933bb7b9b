// SPDX-License-Identifier: Apache-2.0
// A guard without geometry: every coherent snapshot is certified. For tests and times of the board.
#pragma once

#include "core/machine/machine.hpp"
#include "hil_replay/board/closed_loop.hpp"

namespace axg {

/// @param response_us  from the last frame of a sample to the permit
[[nodiscard]] GuardNode make_permit_guard(const Machine& machine, std::int64_t response_us);

}  // namespace axg
