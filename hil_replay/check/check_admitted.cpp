// SPDX-License-Identifier: Apache-2.0
// The plan of the machine file beside the one that the guard's computer has time for.
#include <fmt/format.h>

#include "config/text/quote_text.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/machine/cycle_plan.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {

void report_admitted(CheckReport& report, const std::string& file) {
    std::string fault;
    const auto admitted = read_admitted_plan(file, report.loaded, fault);
    if (!admitted) {
        fmt::print(stderr, "{}\n", fault);
        report.exit_code = kExitInput;
        return;
    }
    const Machine& machine = report.loaded.machine;
    const CyclePlan own = default_plan(machine, stop_tasks(machine));
    const bool has_file_plan = is_within(own, admitted->plan);
    report.facts.admitted = {*admitted, has_file_plan};
    fmt::print(report.words,
               "\nplan of the guard's computer, {}, {}, {}, {} on {}\n  {}\nplan of the machine "
               "file\n  {}\n",
               escaped(admitted->host), escaped(admitted->engine),
               fmt::format("longest cycle {:.0f} us", admitted->longest_us),
               admitted->is_fit ? "fit" : "not fit", escaped(admitted->date),
               format_plan(admitted->plan), format_plan(own));
    if (has_file_plan) {
        fmt::print(report.words, "  it fits: no list of the guard's plan is shorter\n");
    } else {
        report.warnings.push_back(fmt::format(
            "plan: the guard's computer has shorter lists than the machine file: a sample that "
            "replay proves here may stop there. Replay with --plan-of {}, or state it: {}",
            escaped(file, 4096), format_plan_key(admitted->plan)));
    }
    if (!admitted->is_fit) {
        report.warnings.push_back(
            fmt::format("plan: {}: the guard's computer is not fit to run the guard. Run axguardd "
                        "admit there, and correct what it names",
                        escaped(file, 4096)));
    }
}

}  // namespace axg
