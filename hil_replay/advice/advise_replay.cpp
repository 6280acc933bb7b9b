// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/advise_replay.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "config/machine/program_settings.hpp"
#include "core/base/sincos.hpp"
#include "hil_replay/advice/advise_drive.hpp"
#include "hil_replay/advice/gain.hpp"

namespace axg {
namespace {

constexpr double kSamePlace = 1;  // mm or degrees

/// Whether a driven stop is that of the trace: of the same pair, in the same place.
bool is_same_stop(const Machine& machine, const StopEvent& stop, const RunEnd& driven) {
    bool is_near = driven.is_stopped && driven.pair == stop.pair;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double unit = machine.axes[i].kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
        is_near =
            is_near &&
            std::fabs(driven.snapshot.position[i] - stop.snapshot.position[i]) * unit <= kSamePlace;
    }
    return is_near;
}

/// The guard's verdict on a sample depends on the 16 strides before it, so a guard that begins with
/// the last seconds stops at the same sample; whether it does is run first. The settings limit no
/// figure below what the whole trace shows: no earlier sample breaks a limit of theirs.
/// @param left_mm  out: the distance that the stop of the trace leaves
std::optional<Advice> advise_by_trace(const ReplayAdvice& advice, double& left_mm) {
    const StopEvent& stop = advice.stop;
    const std::int64_t before_us = std::llround(advice.seconds * 1e6);
    const TraceRun run{advice.engine,
                       advice.containment_test,
                       advice.trace,
                       advice.options,
                       advice.lacks_session,
                       stop.time_us - before_us,
                       stop.time_us + std::llround(kAdviceAfterS * 1e6)};
    const std::optional<RunEnd> first = run_trace(advice.loaded, run);
    if (!first || first->snapshot.arrived_us != stop.snapshot.arrived_us ||
        first->pair != stop.pair) {
        return std::nullopt;
    }
    left_mm = first->left_mm;
    Advice out;
    out.is_of_trace = true;
    for (const Setting& setting :
         settings_of_trace(advice.loaded.machine, stop.unproven, advice.seen)) {
        std::optional<LoadedMachine> changed = with_setting(advice.loaded, setting.lines);
        if (!changed) {
            continue;
        }
        changed->machine.can = advice.loaded.machine.can;  // period and frames of the trace
        if (const std::optional<RunEnd> again = run_trace(*changed, run)) {
            note_end(setting, false, *first, *again, out);
        }
    }
    return out;
}

/// @param left_mm  of the trace's stop: no gain counts from farther away
void advise_by_board(const ReplayAdvice& advice, double left_mm, Advice& out) {
    const std::optional<LoadedMachine> loaded = with_setting(advice.loaded, {});
    std::error_code error;
    std::string text;
    GcodeOptions options;
    if (!loaded || !std::filesystem::is_regular_file(advice.gcode.program, error) ||
        !make_gcode_options(advice.gcode, loaded->machine,
                            program_settings(loaded->source, loaded->machine), options) ||
        !read_program_text(advice.gcode.program, text)) {
        return;
    }
    const GcodeResult reading = read_gcode(text, loaded->machine, options);
    if (!reading.faults.empty()) {
        return;
    }
    BoardRun run{advice.engine, advice.containment_test, reading.program, options.start};
    run.time_us_max = std::llround(advice.seconds * 1e6);
    std::optional<RunEnd> first = run_board(*loaded, run);
    if (first && is_same_stop(loaded->machine, advice.stop, *first)) {
        first->left_mm = std::min(first->left_mm, left_mm);
        advise_drive({*loaded, run, *first, advice.stop.unproven}, out);
    }
}

}  // namespace

std::optional<Advice> advise_replay(const ReplayAdvice& advice) {
    std::error_code error;
    if (!is_advisable(advice.stop.reason, advice.stop.unproven) ||
        !std::filesystem::is_regular_file(advice.trace, error)) {
        return std::nullopt;
    }
    double left_mm = 0;
    std::optional<Advice> out = advise_by_trace(advice, left_mm);
    if (out) {
        if (!advice.gcode.program.empty()) {
            advise_by_board(advice, left_mm, *out);
        }
        sort_settings(*out);
    }
    return out;
}

}  // namespace axg
