// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/limits_json.hpp"

#include <nlohmann/json.hpp>

#include "firmware_if/cli/limit_text.hpp"
#include "hil_replay/replay/limit_table.hpp"

namespace axg {

using Json = nlohmann::ordered_json;

nlohmann::ordered_json limits_json(const Machine& machine, const LimitSurvey& survey) {
    auto out = Json::object();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        auto& one = out[axis.name] = Json::object();
        for (const LimitRow& row : limit_rows(axis, survey.axes()[i])) {
            one[row.name] = {{"declared", row.figure == LimitFigure::jerk && !has_jerk_limit(axis)
                                              ? Json(nullptr)
                                              : Json(in_axis_units(axis, row.declared))},
                             {"measured", in_axis_units(axis, row.peak.measured)},
                             {"unit", unit_of(axis, row.figure)},
                             {"time_us", row.peak.time_us},
                             {"samples_above", row.peak.samples_above}};
        }
    }
    return out;
}

nlohmann::ordered_json proposed_limits_json(const Machine& machine, const LimitSurvey& survey) {
    auto out = Json::object();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const ProposedLimits proposed = proposed_limits(machine, survey, i);
        auto& one = out[axis.name] = Json::object();
        for (const ProposedKey& key : proposed_keys(axis, proposed)) {
            one[key.key] = key.is_none     ? Json("none")
                           : key.value > 0 ? Json(key.value)
                                           : Json(nullptr);
        }
    }
    return out;
}

}  // namespace axg
