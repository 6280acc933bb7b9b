// SPDX-License-Identifier: Apache-2.0
// A trace of a board that sends no session, with the session frames that such a board would send: a
// guard permits nothing without them.
#pragma once

#include <cstdint>
#include <memory>

#include "core/machine/can_layout.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// Adds a session frame behind the first SYNC frames of `trace` and then every 100 ms: one nonce,
/// laps counted by SYNC. Precondition: has_sample_counter(can), and `trace` is not null.
[[nodiscard]] std::unique_ptr<TraceReader> with_session(std::unique_ptr<TraceReader> trace,
                                                        const CanLayout& can);

}  // namespace axg
