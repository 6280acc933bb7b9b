// SPDX-License-Identifier: Apache-2.0
// `axguard check --plan`: the table of models, the figure, the lines to paste, and what more speed
// or more accuracy would cost.
#pragma once

#include <string>

#include "hil_replay/check/check_report.hpp"

namespace axg {

struct ModelChoiceOptions {
    std::uint32_t positions = 1000, passes = 3;
    std::string trace;  // looked at too; empty: none
    std::string out;    // folder for plan.csv, lost.csv, plan.gp and the picture; empty: none
};

/// Measures, prints, fills CheckFacts::plan, and writes what was asked for. What hinders goes to
/// stderr, and into `report.exit_code`.
void report_plan(CheckReport& report, const ModelChoiceOptions& options);

}  // namespace axg
