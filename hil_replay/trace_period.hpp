// SPDX-License-Identifier: Apache-2.0
// The sample period a trace was recorded with, before the receiver is told to expect one.
#pragma once

#include <cstdint>

#include "hil_replay/trace_reader.hpp"

namespace axg {

/// Median gap between the first SYNC frames of a trace, us. Reads the trace forward: open it anew
/// to replay it. A receiver whose can.sample_us differs by more than 1 % from this refuses the
/// trace (jumps, the sender's clock).
/// @return 0 when the trace holds fewer than three SYNC frames (format signals has none)
[[nodiscard]] std::uint32_t trace_period_us(TraceReader& trace, std::uint32_t sync_id);

}  // namespace axg
