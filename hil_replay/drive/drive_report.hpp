// SPDX-License-Identifier: Apache-2.0
// Report of a drive as text and JSON: why it stopped, where each axis rests, and how far from
// contact.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/guard/escape.hpp"
#include "hil_replay/board/live_loop.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/drive/jog_out.hpp"
#include "hil_replay/drive/path_judge.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {

/// Part of the report for a drive on a bus.
struct BusReport {
    std::string interface;
    LiveWireReport wire;
};

struct DriveReport {
    const Machine& machine;
    Engine engine;  // queried for the clearances at rest
    const DriveResult& result;
    const std::string& program;
    const std::string& mode;
    std::uint64_t seed;
    bool has_cap = false;  // the guard sent a speed cap
    double free_s = 0;     // time of the program without obeying it; 0: no comparison
    std::optional<PathContact> contact{};  // on the true path
    Escapes escapes{};                     // from the rest position after a stop
    std::optional<JogOut> jogs{};          // after the stop
    std::optional<BusReport> bus{};        // the guard was another program; `mode` is unused
    std::optional<StopWhy> why{};          // of the guard's stop, or of the missing first permit
    ProgramLines lines{};                  // by the board's clock
};
/// Time at which the program was interrupted: the sample that the guard stopped for, else
/// BoardStopRecord::asked_us.
[[nodiscard]] std::int64_t stopped_at_us(const DriveResult& result) noexcept;

void print_drive(const DriveReport& report, Detail detail, std::FILE* words);
[[nodiscard]] std::string describe_drive(const DriveReport& report);
/// Stops of the guard in the format of a page (RunPage::stops).
[[nodiscard]] std::string describe_stops(const DriveReport& report);

struct PairAtRest {
    std::uint32_t pair = kNoIndex;
    double clearance_mm = 0;  // certified lower bound
    bool is_touching = false;
};
/// Returns every pair within 50 mm at the rest position, nearest first.
[[nodiscard]] std::vector<PairAtRest> pairs_at_rest(const DriveReport& report);
[[nodiscard]] double in_file_units(const Axis& axis, double value);
[[nodiscard]] double motion_s(const DriveResult& result);

}  // namespace axg
