// SPDX-License-Identifier: Apache-2.0
// Properties of a trace that configure the receiver: the sample period, whether the axis frames are
// flexible (simulate --fd, --sample-us), and whether the board sends its session.
#pragma once

#include <cstdint>
#include <string>

#include "core/machine/machine.hpp"
#include "firmware_if/receiver/period_watch.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// Median gap between the first SYNC frames of a trace, us. Skips a frame that repeats the counter
/// of the one before. Reads the trace forward: open it anew to replay it. A receiver whose
/// can.sample_us differs by more than 1 % from this refuses the trace (jumps, the sender's clock).
/// @return 0 when the trace holds fewer than three SYNC frames (format signals has none)
[[nodiscard]] std::uint32_t trace_period_us(TraceReader& trace, std::uint32_t sync_id);

/// The machine file's period against the trace's, as a live guard measures it.
struct TracePeriod {
    std::uint32_t declared_us = 0;
    PeriodVerdict verdict = PeriodVerdict::unknown;
    std::int64_t measured_ns = 0;  // 0: unknown
};
/// Judges the first SYNC frames of a trace, up to the first window that refutes the period. Reads
/// the trace forward, as trace_period_us does.
[[nodiscard]] TracePeriod judge_trace_period(TraceReader& trace, const Machine& machine);

/// Whether the frames on `axis_id` are flexible ones: judged by the first of them among the first
/// thousand frames of the trace. Reads it forward, as trace_period_us does.
[[nodiscard]] bool has_flexible_axes(TraceReader& trace, std::uint32_t axis_id);

/// Whether a board in the trace sends its session on this id: it may begin late. Reads the trace up
/// to that frame, as trace_period_us does.
[[nodiscard]] bool has_session_frames(TraceReader& trace, std::uint32_t session_id);

struct TraceShape {
    std::string fault{};  // empty, or why the trace cannot be read
    TracePeriod period{};
    bool lacks_session = false;  // the machine's boards send one, see AddedSession
};
/// Sets period and frame format in `machine` from the trace: simulate --sample-us and --fd may
/// differ from the machine file. Prints the changes on stderr, whether a live guard would refuse
/// the period, and whether the trace lacks the session.
[[nodiscard]] TraceShape take_trace_shape(const std::string& path, const TraceOptions& options,
                                          Machine& machine);

}  // namespace axg
