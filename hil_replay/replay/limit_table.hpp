// SPDX-License-Identifier: Apache-2.0
// Declared limits, limits measured in a trace, and values for the machine file.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "core/machine/machine.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

/// One limit of an axis.
struct LimitRow {
    const char* name;
    LimitFigure figure;
    double declared;  // mm or rad
    const LimitPeak& peak;
};
[[nodiscard]] std::array<LimitRow, 3> limit_rows(const Axis& axis, const AxisLimitSurvey& seen);

/// A key of the machine file, its value in the key's unit; 0: the trace does not show it.
struct ProposedKey {
    std::string key;
    double value;
    bool is_none = false;  // jerk: the acceleration is full at once
};
[[nodiscard]] std::array<ProposedKey, 4> proposed_keys(const Axis& axis,
                                                       const ProposedLimits& proposed);
[[nodiscard]] ProposedLimits proposed_limits(const Machine& machine, const LimitSurvey& survey,
                                             std::size_t axis);

void print_limits(const Machine& machine, const LimitSurvey& survey, std::FILE* words);
/// Lines for the section `axes` of the machine file, each with what it rests on.
/// @param evidence  the trace, and how many samples it has
void print_proposed_limits(const Machine& machine, const LimitSurvey& survey,
                           const std::string& evidence, std::FILE* words);

}  // namespace axg
