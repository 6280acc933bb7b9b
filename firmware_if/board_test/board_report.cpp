// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/board_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/limit_text.hpp"

namespace axg {

namespace {

/// Rounds down to three digits: the board must meet a stated limit.
double rounded_down(double value) noexcept {
    if (value <= 0) {
        return 0;
    }
    const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
    return std::floor(value / unit) * unit;
}

/// In the machine file's units: mm, deg. Leaves out a figure that no stop depended on, because the
/// test did not measure it.
struct MeasuredAxis {
    std::uint32_t number = 0;
    std::string stopping, jerk;  // empty: not stated
};

struct MeasuredKeys {
    std::string reaction_ms, jitter_us;
    std::vector<MeasuredAxis> axes;
};

MeasuredAxis measured_axis(const Axis& axis, std::uint32_t number, std::span<const AxisStop> stops,
                           double reaction_s) {
    StopFigures figures{reaction_s, axis.stopping_min, axis.jerk_max};
    const std::optional<double> deceleration = fitted_deceleration(stops, number, figures);
    figures.deceleration = deceleration.value_or(figures.deceleration);
    const std::optional<double> jerk = fitted_jerk(stops, number, figures);
    const auto shown = [&axis](const std::optional<double>& value) {
        return value ? fmt::format("{:.6g}", rounded_down(in_axis_units(axis, *value))) : "";
    };
    return {number, shown(deceleration), shown(jerk)};
}

/// Empty: no stop was judged.
std::optional<MeasuredKeys> measured_keys(const Machine& machine, const BoardTestResult& result) {
    if (result.stops.empty()) {
        return std::nullopt;
    }
    // Rounded up to 0.1 ms; then each figure is found with the ones before it.
    const double reaction_s = std::ceil(result.reaction_s * 1e4) * 1e-4;
    // Positions show a stop later by their age. The test cannot separate reaction and age, so it
    // subtracts the least stated age.
    const double board_ms =
        std::max(0.0, reaction_s * 1e3 - machine.can.latched_age.least_us * 1e-3);
    MeasuredKeys out{fmt::format("{:.1f}", std::ceil(board_ms * 10 - 1e-9) / 10),
                     fmt::format("{:.0f}", std::ceil(result.sync.jitter_us_max)),
                     {}};
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const bool is_tested = std::any_of(result.stops.begin(), result.stops.end(),
                                           [i](const AxisStop& stop) { return stop.axis == i; });
        if (is_tested) {
            out.axes.push_back(measured_axis(machine.axes[i], i, result.stops, reaction_s));
        }
    }
    return out;
}

std::string less_age(ValueAge age) {
    return age.least_us == 0 ? std::string()
                             : fmt::format(", less {} us of can.latched_age_us", age.least_us);
}

std::string axis_keys(const Axis& axis, const MeasuredAxis& measured) {
    const char* const unit = axis.kind == AxisKind::rotary ? "deg" : "mm";
    std::string keys;
    if (!measured.stopping.empty()) {
        keys = fmt::format("stopping_{}_s2: {}", unit, measured.stopping);
    }
    if (!measured.jerk.empty()) {
        keys += fmt::format("{}jerk_{}_s3: {}", keys.empty() ? "" : ", ", unit, measured.jerk);
    }
    const bool has_all =
        !measured.stopping.empty() && (!measured.jerk.empty() || !has_jerk_limit(axis));
    return fmt::format("  {}: {{{}}}{}\n", axis.name, keys,
                       has_all ? "" : "  # larger values not reached: test with a faster feed");
}

/// As config reads it; rad for a rotary axis.
void take_limit(const Axis& axis, const std::string& text, double& limit) {
    if (!text.empty()) {
        const double value = std::stod(text);
        limit = axis.kind == AxisKind::rotary ? value * kPi / 180.0 : value;
    }
}

}  // namespace

const char* to_text(Outcome outcome) noexcept {
    switch (outcome) {
        case Outcome::not_tested:
            return "not tested";
        case Outcome::passed:
            return "pass";
        case Outcome::failed:
            return "FAIL";
        case Outcome::unclear:
            return "unclear";
    }
    return "unknown";
}

BoardTestCounts counts_of(const BoardTestResult& result) noexcept {
    BoardTestCounts out;
    for (const BoardFinding& finding : result.findings) {
        out.passed += finding.outcome == Outcome::passed ? 1U : 0U;
        out.failed += finding.outcome == Outcome::failed ? 1U : 0U;
        out.unclear += finding.outcome == Outcome::unclear ? 1U : 0U;
        out.not_tested += finding.outcome == Outcome::not_tested ? 1U : 0U;
    }
    return out;
}

std::string report_text(const BoardTestResult& result) {
    std::string out;
    auto to = std::back_inserter(out);
    int number = 0;
    for (const BoardFinding& finding : result.findings) {
        fmt::format_to(to, "{:>2} {:<16} {:<10} rule {}: {}{}{}", ++number, finding.name,
                       to_text(finding.outcome), finding.rule, finding.demands,
                       finding.demands.empty() ? "" : ": ", finding.found);
        if (finding.at_us != 0) {
            fmt::format_to(to, " (frame at {:.6f} s)", static_cast<double>(finding.at_us) * 1e-6);
        }
        out += '\n';
        if (finding.outcome == Outcome::failed) {
            fmt::format_to(to, "{:<30} -> {}\n", "", finding.mend);
        }
    }
    return out;
}

std::string machine_keys(const Machine& machine, const BoardTestResult& result) {
    const std::optional<MeasuredKeys> keys = measured_keys(machine, result);
    if (!keys) {
        return {};
    }
    std::string out = fmt::format(
        "# axguardd board-test: figures that {} judged stops fit, all of them together.\n"
        "# Not tested stops may take longer: add what the firmware's design adds. The\n"
        "# jitter has that of the bus and of this computer in it. The period was {:.1f} us.\n"
        "# board_reaction_ms is one figure for the reaction and the age of the positions{}.\n"
        "guard:\n  board_reaction_ms: {}\n  latch_jitter_us: {}\naxes:\n",
        result.stops.size(), result.sync.mean_us, less_age(machine.can.latched_age),
        keys->reaction_ms, keys->jitter_us);
    for (const MeasuredAxis& axis : keys->axes) {
        out += axis_keys(machine.axes[axis.number], axis);
    }
    return out;
}

Machine with_measured_keys(const Machine& machine, const BoardTestResult& result) {
    Machine out = machine;
    if (const std::optional<MeasuredKeys> keys = measured_keys(machine, result)) {
        out.guard.board_reaction_s = std::stod(keys->reaction_ms) / 1e3;
        out.guard.latch_jitter_s = std::stod(keys->jitter_us) / 1e6;
        for (const MeasuredAxis& measured : keys->axes) {
            Axis& axis = out.axes[measured.number];
            take_limit(axis, measured.stopping, axis.stopping_min);
            take_limit(axis, measured.jerk, axis.jerk_max);
        }
    }
    return out;
}

}  // namespace axg
