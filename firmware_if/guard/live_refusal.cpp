// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/live_refusal.hpp"

#include <utility>

#include "firmware_if/guard/standstill_watch.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"

namespace axg {

std::vector<std::string> live_refusals(const Machine& machine) {
    std::vector<std::string> out;
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        out.push_back("guard.obeyed_by: " + refusal);
    }
    if (std::string refusal = standstill_refusal(machine); !refusal.empty()) {
        out.push_back(std::move(refusal));
    }
    if (machine.guard.reports_limits) {
        out.emplace_back(
            "guard.limits_broken: report does not stop an axis that exceeds a limit of the proof. "
            "A live guard needs stop.");
    }
    return out;
}

std::vector<std::string> live_warnings(const Machine& machine) {
    std::vector<std::string> out;
    if (machine.can.hashes_in_id == 0) {
        out.emplace_back(
            "can.hashes: none: a board configured for another machine is not detected. Use "
            "required if the board can answer.");
    }
    return out;
}

}  // namespace axg
