// SPDX-License-Identifier: Apache-2.0
// The state of an axg_guard, as its status socket and its metrics show it.
#pragma once

#include <cstdint>

#include "firmware_if/c_interface/guard_object.hpp"
#include "firmware_if/live/live_view.hpp"

namespace axg {

/// By the clock of this host, which the readers have: the guard's may be that of a simulation.
/// @param now_us  by the guard's clock
[[nodiscard]] LiveView live_view_of(const axg_guard& guard, std::int64_t now_us) noexcept;

}  // namespace axg
