// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/stop_cause_json.hpp"

#include <nlohmann/json.hpp>

#include "firmware_if/cli/limit_text.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json limit_json(const LimitFact& fact, const Machine& machine) {
    const Axis& axis = machine.axes[fact.axis];
    Json out{{"kind", to_text(fact.kind)},
             {"axis", axis.name},
             {"measured", in_axis_units(axis, fact.measured)}};
    if (fact.declared > 0) {  // of a range none is
        out["declared"] = in_axis_units(axis, fact.declared);
    }
    out["unit"] = unit_of(axis, figure_of(fact.kind));
    return out;
}

}  // namespace

void add_stop_cause(const Machine& machine, StopReason reason, std::uint32_t pair,
                    ReceiverFault fault, const LimitFact& limit, nlohmann::ordered_json& out) {
    if (pair != kNoIndex) {
        out["pair"] = pair_name(machine, pair);
    }
    if (reason == StopReason::input) {
        out["fault"] = fault_row(fault).name;
    }
    if (reason == StopReason::left_limits) {
        out["limit"] = limit_json(limit, machine);
    }
}

}  // namespace axg
