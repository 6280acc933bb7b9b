// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/watched_trace.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/text/quote_text.hpp"
#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {
namespace {

double seconds(std::int64_t time_us) {
    return static_cast<double>(time_us) * 1e-6;
}

std::string span_of(const TraceContent& trace) {
    return fmt::format("{:.3f} to {:.3f} s", seconds(trace.first_us), seconds(trace.last_us));
}

/// "a.log", "a.log, b.log".
std::string names_of(const std::vector<TraceContent>& traces) {
    std::string out;
    for (const TraceContent& trace : traces) {
        out += (out.empty() ? "" : ", ") + escaped(trace.name, 200);
    }
    return out;
}

std::uint64_t sum(const std::vector<TraceContent>& traces, std::uint64_t TraceContent::*count) {
    std::uint64_t out = 0;
    for (const TraceContent& trace : traces) {
        out += trace.*count;
    }
    return out;
}

}  // namespace

std::optional<TraceContent> read_content(const Machine& machine, const std::string& path,
                                         std::string& fault) {
    const std::unique_ptr<TraceReader> trace = open_trace(path, {.lenient = true}, fault);
    if (!trace) {
        return std::nullopt;
    }
    const AxisFrameSet set = make_frame_set(machine);
    TraceContent out;
    out.name = path;
    CanFrame frame;
    while (trace->next(frame)) {
        out.first_us = out.frames == 0 ? frame.time_us : out.first_us;
        out.last_us = frame.time_us;
        ++out.frames;
        if (frame.error || frame.remote) {
            continue;
        }
        const bool is_of_guard = !frame.extended && frame.id != machine.can.sync_id &&
                                 is_guard_id(machine.can, frame.id);
        out.of_guard += is_of_guard ? 1U : 0U;
        out.of_board += slot_of(set, frame) < set.frame_count ? 1U : 0U;
    }
    out.skipped = trace->skipped();
    out.first_skipped = trace->first_skipped();
    out.fault = trace->error();
    return out;
}

std::string fault_of_traces(const std::vector<TraceContent>& traces) {
    if (sum(traces, &TraceContent::of_board) + sum(traces, &TraceContent::of_guard) == 0) {
        const std::string& cause =
            traces.front().fault.empty() ? traces.front().first_skipped : traces.front().fault;
        return fmt::format(
            "{}: no frame of the board or the guard (found {} frames, expected the identifiers of "
            "the machine file). {}Compare them: axguard inspect {}",
            names_of(traces), sum(traces, &TraceContent::frames), cause.empty() ? "" : cause + " ",
            escaped(traces.front().name, 200));
    }
    for (const TraceContent& a : traces) {
        for (const TraceContent& b : traces) {
            if (a.last_us < b.first_us) {
                return fmt::format(
                    "{}: no time in common with {} (found {}, and {}). Record both by one clock.",
                    escaped(a.name, 200), escaped(b.name, 200), span_of(a), span_of(b));
            }
        }
    }
    return {};
}

std::vector<std::string> notes_about(const std::vector<TraceContent>& traces,
                                     const Machine& machine, const std::string& machine_file) {
    std::vector<std::string> out;
    const std::string names = names_of(traces);
    if (sum(traces, &TraceContent::of_guard) == 0) {
        out.push_back(fmt::format(
            "{}: no frame of the guard, such as its permit 0x{:03X}. Record with the guard on the "
            "bus. To see what it would have sent: axguard replay {} {} --frames-out guard.log, "
            "then add --trace guard.log.",
            names, machine.can.permit_id, escaped(machine_file, 200),
            escaped(traces.front().name, 200)));
    }
    if (sum(traces, &TraceContent::of_board) == 0) {
        out.push_back(
            fmt::format("{}: no position of the board. Add the board's trace of the same time by a "
                        "second --trace.",
                        names));
    }
    for (const TraceContent& trace : traces) {
        if (trace.skipped != 0) {
            out.push_back(fmt::format("{} lines left out; the first: {}", trace.skipped,
                                      trace.first_skipped));
        }
    }
    return out;
}

}  // namespace axg
