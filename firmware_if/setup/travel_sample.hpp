// SPDX-License-Identifier: Apache-2.0
// Axis positions spread over a machine's travel, the zero pose first: the same on every processor.
#pragma once

#include <cstdint>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

[[nodiscard]] AxisSnapshot sampled_position(const Machine& machine, std::uint32_t index);

}  // namespace axg
