// SPDX-License-Identifier: Apache-2.0
// Computes the effect of the promises of a machine file in stoppable mode: how long an axis may
// still move freely, and its reach.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/base/sincos.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/reach/jog.hpp"
#include "firmware_if/guard/live_refusal.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

/// The reach, from the reported position, of an axis at standstill in all stored samples.
double reach_at_rest(const Machine& machine, std::uint32_t axis, const SampleErrors& errors,
                     std::uint32_t samples) {
    MotionHistory history;
    AxisSnapshot snapshot;
    for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
        snapshot.sample = i + 1;
        note_snapshot(history, snapshot, 1);
    }
    const Axis& promised = machine.axes[axis];
    const AxisRange now = range_of(history, axis, promised, errors);
    return stop_reach(stop_limits(machine, axis), now, free_seconds(machine, samples)).high;
}

/// The reach of an axis that has been at full speed for long.
double reach_at_speed(const Machine& machine, std::uint32_t axis, std::uint32_t samples) {
    const Axis& promised = machine.axes[axis];
    const double full = promised.speed_max;
    return forward_reach(stop_limits(machine, axis), full, full, free_seconds(machine, samples));
}

/// The longest stretch of a look-ahead path that has to be sent for such a permit: every axis at
/// its full speed.
double stretch_s(const Machine& machine, std::uint32_t samples) {
    double deceleration = 0, jerk = 0;
    for (const Axis& axis : machine.axes) {
        deceleration = std::max(deceleration, axis.speed_max / axis.stopping_min);
        jerk = std::max(jerk, axis.speed_max / axis.jerk_max);
    }
    return free_seconds(machine, samples) + path_braking_s(deceleration, jerk);
}

std::string format_samples(PermitSamples samples) {
    return samples.least == samples.most ? fmt::format("{}", samples.least)
                                         : fmt::format("{} to {}", samples.least, samples.most);
}

/// "3 to 12 samples of permit, 2 ms board reaction", and the age of a position where it has one.
std::string horizon_parts(const Machine& machine) {
    const std::uint32_t age_us = machine.can.latched_age.most_us;
    return fmt::format("{} samples of permit, {:.4g} ms board reaction{}",
                       format_samples(machine.can.permit_samples),
                       machine.guard.board_reaction_s * 1e3,
                       age_us == 0 ? "" : fmt::format(", {:.4g} ms age", age_us * 1e-3));
}

/// With the shortest permit, and the longest where that is another.
std::string horizons(const Machine& machine) {
    const PermitSamples samples = machine.can.permit_samples;
    const double least_ms = free_seconds(machine, samples.least) * 1e3;
    return samples.least == samples.most ? fmt::format("{:.4g} ms", least_ms)
                                         : fmt::format("{:.4g} to {:.4g} ms", least_ms,
                                                       free_seconds(machine, samples.most) * 1e3);
}

void report_path(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const double look_ahead_s = machine.can.look_ahead_samples * machine.can.sample_us * 1e-6;
    const PermitSamples samples = machine.can.permit_samples;
    const double needed_s = stretch_s(machine, samples.least);
    const double longest_s = stretch_s(machine, samples.most);
    report.facts.look_ahead_s = look_ahead_s;
    report.facts.look_ahead_needed_s = needed_s;
    report.facts.look_ahead_longest_s = longest_s;
    fmt::print(
        report.words,
        "\nstoppable mode: a stop begins at most {} after a sample ({}) and keeps to the path; "
        "look-ahead {:.4g} ms, needed for a stop "
        "from full speed {:.4g} ms{}\n",
        horizons(machine), horizon_parts(machine), look_ahead_s * 1e3, needed_s * 1e3,
        look_ahead_s < needed_s ? ". Such a stop is not proven: increase can.ahead.samples"
        : look_ahead_s < longest_s
            ? fmt::format(", with permits of {} samples {:.4g} ms. These are not proven at full "
                          "speed: increase can.ahead.samples",
                          samples.most, longest_s * 1e3)
            : "");
}

/// How far a jog gets beyond its last sample.
void report_jog(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    std::string text;
    for (const Axis& axis : machine.axes) {
        const bool rotary = axis.kind == AxisKind::rotary;
        const char* name = rotary ? "deg" : "mm";
        const double reach = jog_reach(jog_limits(machine.guard.jog, axis),
                                       free_seconds(machine, machine.can.permit_samples.least)) *
                             (rotary ? 180.0 / kPi : 1.0);
        report.facts.jog_reaches.push_back(reach);
        text += fmt::format("{} {} {:.3g} {}", text.empty() ? "" : ",", axis.name, reach, name);
    }
    fmt::print(report.words, "  jog of one axis, distance from a sample to standstill:{}\n", text);
}

void report_obeyed_by(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const std::string refusal = obeyed_by_refusal(machine);
    fmt::print(report.words, "\npermits: obeyed by the {} (guard.obeyed_by){}\n",
               to_text(machine.guard.obeyed_by),
               refusal.empty() ? ", which stops when the last permit ends" : "");
    for (const std::string& why : live_refusals(machine)) {
        report.warnings.push_back("axguardd run rejects this machine: " + why);
    }
}

/// Reports the promises that the machine file does not state, and the cost of a wrong default.
void report_promises(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    report.facts.unstated = unstated_promises(machine);
    fmt::print(report.words, "\npromises not stated: {}{}\n", report.facts.unstated.size(),
               report.facts.unstated.empty()
                   ? ""
                   : fmt::format(" (a stop from rapid, with {} samples of permit)",
                                 machine.can.permit_samples.least));
    for (const UnstatedPromise& promise : report.facts.unstated) {
        fmt::print(report.words, "  {}\n", format_promise(machine, promise));
    }
}

}  // namespace

void report_guard(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const std::array<double, kAxesMax> units = axis_units(machine);
    report_obeyed_by(report);
    report_promises(report);
    if (machine.guard.promise == StopPromise::path_keeping) {
        report_path(report);
        if (machine.guard.jog.is_promised) {
            report_jog(report);
        }
        return;
    }
    fmt::print(report.words,
               "\nstoppable mode: free motion for {} after a sample ({}), then each axis brakes "
               "independently\n",
               horizons(machine), horizon_parts(machine));
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const bool rotary = axis.kind == AxisKind::rotary;
        const double unit = rotary ? 180.0 / kPi : 1.0;
        const char* name = rotary ? "deg" : "mm";
        const PermitSamples samples = machine.can.permit_samples;
        const auto reach_of = [&](std::uint32_t n) {
            return AxisReach{
                .at_full_speed = reach_at_speed(machine, i, n) * unit,
                .at_rest =
                    reach_at_rest(machine, i, sample_errors(machine, i, units[i]), n) * unit};
        };
        const AxisReach least = reach_of(samples.least), most = reach_of(samples.most);
        report.facts.reaches.push_back(least);
        fmt::print(report.words,
                   "  {:<4} stopping envelope: {:.4g} {} at full speed, {:.3g} {} at rest",
                   axis.name, least.at_full_speed, name, least.at_rest, name);
        if (tries_longer(samples)) {
            fmt::print(report.words, "; with {} samples {:.4g} and {:.3g} {}", samples.most,
                       most.at_full_speed, most.at_rest, name);
        }
        fmt::print(report.words, "\n");
    }
    if (machine.guard.jog.is_promised) {
        report_jog(report);
    }
}

}  // namespace axg
