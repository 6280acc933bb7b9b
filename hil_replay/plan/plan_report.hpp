// SPDX-License-Identifier: Apache-2.0
// `axguard check --plan`: the table of models, the figure, the lines to paste, and the cost of more
// speed or more accuracy.
#pragma once

#include <string>

#include "hil_replay/check/check_report.hpp"

namespace axg {

struct ModelChoiceOptions {
    std::uint32_t positions = 1000, passes = 3;
    std::string trace;  // measured too; empty: none
    std::string out;    // folder for the tables and the figure; empty: none
};

/// Measures, prints, fills CheckFacts::plan, and writes the requested files. Reports failures on
/// stderr and in `report.exit_code`.
void report_plan(CheckReport& report, const ModelChoiceOptions& options);

}  // namespace axg
