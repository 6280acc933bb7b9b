// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/trace_period.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

namespace {

bool is_sync(const CanFrame& frame, std::uint32_t sync_id) noexcept {
    return frame.id == sync_id && !frame.extended && !frame.remote && !frame.error && !frame.fd;
}

/// Periods between two SYNCs: by their counters, or by the time where they have none.
std::int64_t steps_between(const CanFrame& a, const CanFrame& b, const CanLayout& can) noexcept {
    if (can.sync_counter_max == 0) {
        const std::int64_t period_us = can.sample_us;
        return (b.time_us - a.time_us + period_us / 2) / period_us;
    }
    return (b.data[0] + can.sync_counter_max - a.data[0]) % can.sync_counter_max;
}

}  // namespace

TracePeriod judge_trace_period(TraceReader& trace, const Machine& machine) {
    const CanLayout& can = machine.can;
    TracePeriod out{.declared_us = can.sample_us};
    PeriodWatch watch{.terms = sync_terms(machine)};
    std::optional<CanFrame> last;
    CanFrame frame;
    while (out.verdict != PeriodVerdict::wrong && trace.next(frame)) {
        const bool is_measured = is_sync(frame, can.sync_id) && has_sync(wire_of(can));
        const std::int64_t steps = is_measured && last ? steps_between(*last, frame, can) : 1;
        if (!is_measured || steps == 0) {
            continue;  // sent twice: the earlier stamp stays
        }
        if (steps > can.counter_delta_max) {
            restart(watch);  // the board began anew
        }
        last = frame;
        const PeriodVerdict judged = judge_stamp(watch, steps, frame.time_us);
        if (judged != PeriodVerdict::unknown) {
            out.verdict = judged;
            out.measured_ns = watch.measured_ns;
        }
    }
    return out;
}

std::uint32_t trace_period_us(TraceReader& trace, std::uint32_t sync_id) {
    constexpr std::size_t kGaps = 63;  // enough for a median that jitter and a loss do not move
    std::array<std::int64_t, kGaps> gaps{};
    std::size_t count = 0;
    std::optional<CanFrame> last;
    CanFrame frame;
    while (count < kGaps && trace.next(frame)) {
        if (!is_sync(frame, sync_id)) {
            continue;
        }
        const bool has_counter = frame.length_bytes != 0;
        if (last && has_counter && frame.length_bytes == last->length_bytes &&
            frame.data[0] == last->data[0]) {
            continue;  // sent twice: it opens no period
        }
        if (last) {
            gaps[count++] = frame.time_us - last->time_us;
        }
        last = frame;
    }
    if (count < 2) {
        return 0;
    }
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(gaps.begin(), middle, gaps.begin() + static_cast<std::ptrdiff_t>(count));
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(*middle, 0, 1'000'000'000));
}

bool has_flexible_axes(TraceReader& trace, std::uint32_t axis_id) {
    CanFrame frame;
    for (int i = 0; i < 1000 && trace.next(frame); ++i) {
        if (frame.id == axis_id && !frame.extended && !frame.remote && !frame.error) {
            return frame.fd;
        }
    }
    return false;
}

bool has_session_frames(TraceReader& trace, std::uint32_t session_id) {
    CanFrame frame;
    while (trace.next(frame)) {
        Session session;
        if (decode_session(session_id, frame, session) == FrameStatus::ok) {
            return true;
        }
    }
    return false;
}

TraceShape take_trace_shape(const std::string& path, const TraceOptions& options,
                            Machine& machine) {
    TraceShape shape;
    std::string error;
    std::unique_ptr<TraceReader> trace = open_trace(path, options, error);
    if (!trace) {
        shape.fault = error;
        return shape;
    }
    CanLayout& can = machine.can;
    shape.period = judge_trace_period(*trace, machine);
    if (shape.period.verdict == PeriodVerdict::wrong) {
        fmt::print(stderr,
                   "{}: a live guard refuses this period: sync_period, measured {:.3f} us, "
                   "declared {} us. Correct can.sample_us, or the board's period.\n",
                   path, static_cast<double>(shape.period.measured_ns) / 1000, can.sample_us);
    }
    trace = open_trace(path, options, error);
    const std::uint32_t period_us = trace ? trace_period_us(*trace, can.sync_id) : 0;
    if (period_us != 0 && period_us != can.sample_us) {
        fmt::print(stderr, "{}: sample period {} us, in the machine file {}; using {}\n", path,
                   period_us, can.sample_us, period_us);
        const std::uint64_t samples = (can.stale_after_us + can.sample_us - 1) / can.sample_us;
        can.stale_after_us = static_cast<std::uint32_t>(samples * period_us);
        can.heartbeat_timeout_us = std::max(can.heartbeat_timeout_us, 3 * period_us);
        can.sample_us = period_us;
    }
    trace = open_trace(path, options, error);
    if (trace && can.format == CanFormat::classical && has_flexible_axes(*trace, can.axis_ids[0])) {
        fmt::print(stderr, "{}: CAN FD frames, in the machine file classical; using fd\n", path);
        can.format = CanFormat::fd;
    }
    trace = open_trace(path, options, error);
    shape.lacks_session =
        trace && has_sample_counter(can) && !has_session_frames(*trace, can.session_in_id);
    if (shape.lacks_session) {
        fmt::print(
            stderr,
            "{}: no session frame 0x{:03X}, and a live guard permits nothing without; judged as "
            "if the board sent it\n",
            path, can.session_in_id);
    }
    return shape;
}

}  // namespace axg
