// SPDX-License-Identifier: Apache-2.0
// A part of a trace through the guard once more, with other values of the machine file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/distance_need.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// End of a motion. No pair: it did not stop for one.
struct RunEnd {
    bool is_stopped = false;
    bool is_complete = false;  // it began, and neither trace nor frames had a fault
    std::uint32_t pair = kNoIndex;
    double left_mm = 0;         // of that pair, certified, at the sample of the stop
    AxisSnapshot snapshot{};    // the sample of the stop
    std::int64_t ended_us = 0;  // arrival of the last frame, or the board's last sample
};

/// The distance that is left for a pair in that position, mm: as the report of a stop states it.
[[nodiscard]] double distance_left(const Machine& machine, const Engine& engine,
                                   const AxisSnapshot& snapshot, std::uint32_t pair,
                                   const UnprovenPair& unproven);

struct TraceRun {
    Engine engine;
    const ContainmentTest& containment_test;  // of the surfaces of the machine
    const std::string& path;
    const TraceOptions& options;
    bool lacks_session;                      // AddedSession
    std::int64_t from_us = 0, until_us = 0;  // of the trace
};
/// The first stop of a guard that begins at `from_us`.
/// @return  empty: the trace was not opened, or memory ran out
[[nodiscard]] std::optional<RunEnd> run_trace(const LoadedMachine& loaded, const TraceRun& run);

}  // namespace axg
