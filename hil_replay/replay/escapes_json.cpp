// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/escapes_json.hpp"

#include <nlohmann/json.hpp>

#include "hil_replay/replay/format_escapes.hpp"

namespace axg {

nlohmann::ordered_json escapes_json(const Machine& machine, const Escapes& escapes) {
    auto out = nlohmann::ordered_json::array();
    for (const EscapeJog& jog : escapes.list()) {
        const bool rotary = machine.axes[jog.axis].kind == AxisKind::rotary;
        out.push_back({{"axis", machine.axes[jog.axis].name},
                       {"direction", jog.is_negative ? "-" : "+"},
                       {rotary ? "step_deg" : "step_mm", step_in_file_units(machine, jog)},
                       {"clearance_mm", jog.clearance_mm}});
    }
    return out;
}

}  // namespace axg
