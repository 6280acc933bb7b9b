// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/limit_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace axg {

std::array<LimitRow, 3> limit_rows(const Axis& axis, const AxisLimitSurvey& seen) {
    return {{{"speed", LimitFigure::speed, axis.speed_max, seen.speed},
             {"acceleration", LimitFigure::acceleration, axis.acceleration_max, seen.acceleration},
             {"jerk", LimitFigure::jerk, axis.jerk_max, seen.jerk}}};
}

std::array<ProposedKey, 4> proposed_keys(const Axis& axis, const ProposedLimits& proposed) {
    const std::string unit = axis.kind == AxisKind::rotary ? "deg" : "mm";
    return {{{axis.kind == AxisKind::rotary ? "speed_deg_s" : "speed_mm_min", proposed.speed},
             {"acceleration_" + unit + "_s2", proposed.acceleration},
             {"jerk_" + unit + "_s3", proposed.jerk, proposed.is_jerk_unlimited},
             {"stopping_" + unit + "_s2", proposed.stopping}}};
}

ProposedLimits proposed_limits(const Machine& machine, const LimitSurvey& survey,
                               std::size_t axis) {
    const double period_s = machine.can.sample_us * 1e-6;
    return proposed_limits(machine.axes[axis], survey.axes()[axis],
                           history_stride(period_s) * period_s);
}

void print_limits(const Machine& machine, const LimitSurvey& survey, std::FILE* words) {
    fmt::print(words, "\n{:5} {:13} {:>11} {:>11} {:7} {:>13} {:>14}\n", "axis", "limit",
               "declared", "measured", "", "at, s", "samples above");
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        for (const LimitRow& row : limit_rows(axis, survey.axes()[i])) {
            const bool is_none = row.figure == LimitFigure::jerk && !has_jerk_limit(axis);
            fmt::print(words, "{:5} {:13} {:>11} {:>11.5g} {:7} {:>13.6f} {:>14}\n", axis.name,
                       row.name,
                       is_none ? "none" : fmt::format("{:.5g}", in_axis_units(axis, row.declared)),
                       in_axis_units(axis, row.peak.measured), unit_of(axis, row.figure),
                       static_cast<double>(row.peak.time_us) * 1e-6, row.peak.samples_above);
        }
    }
    fmt::print(words, "measured: the smallest value that explains the positions in free motion\n");
}

void print_proposed_limits(const Machine& machine, const LimitSurvey& survey,
                           const std::string& evidence, std::FILE* words) {
    fmt::print(words, "\nproposed for the machine file, 10 % above the measured values:\n");
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const ProposedLimits proposed = proposed_limits(machine, survey, i);
        std::string known, unknown;
        for (const ProposedKey& key : proposed_keys(axis, proposed)) {
            if (key.value > 0) {
                known += fmt::format("{}{}: {}", known.empty() ? "" : ", ", key.key,
                                     key.is_none ? "none" : fmt::format("{:.6g}", key.value));
            } else {
                unknown += (unknown.empty() ? "" : ", ") + key.key;
            }
        }
        const double most = in_axis_units(axis, std::max(survey.axes()[i].acceleration.measured,
                                                         survey.axes()[i].seen_acceleration));
        const std::string measured =
            proposed.acceleration > 0
                ? fmt::format("  # {}: at most {:.6g} {}, times {:.3g}", evidence, most,
                              unit_of(axis, LimitFigure::acceleration),
                              proposed.acceleration / most)
                : "";
        fmt::print(words, "  {}: {{{}}}{}{}{}\n", axis.name, known, measured,
                   unknown.empty() ? "" : "  # not in this trace: ", unknown);
    }
}

}  // namespace axg
