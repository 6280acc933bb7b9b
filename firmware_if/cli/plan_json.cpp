// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/plan_json.hpp"

#include <nlohmann/json.hpp>

namespace axg {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kEntriesMax = 1U << 26;  // of a list, and queries of a stage

/// False: no such number, or one above `most`.
bool take(const Json& value, const char* name, std::uint32_t most, std::uint32_t& out) {
    const auto found = value.is_object() ? value.find(name) : value.end();
    if (!value.is_object() || found == value.end() || !found->is_number_unsigned() ||
        found->get<std::uint64_t>() > most) {
        return false;
    }
    out = found->get<std::uint32_t>();
    return true;
}

bool take_stage(const Json& value, std::uint32_t stage, CyclePlan& plan) {
    bool is_sound = take(value, "queries", kEntriesMax, plan.queries[stage]);
    for (const WorkListName& one : kWorkLists) {
        is_sound = is_sound && take(value, one.name, kEntriesMax, plan.lists[stage].*one.list);
    }
    return is_sound;
}

}  // namespace

Json lists_json(const WorkLists& lists) {
    Json out;
    for (const WorkListName& one : kWorkLists) {
        out[one.name] = lists.*one.list;
    }
    return out;
}

Json plan_json(const CyclePlan& plan) {
    auto stages = Json::array();
    for (std::uint32_t stage = 0; stage < plan.stages; ++stage) {
        Json one{{"queries", plan.queries[stage]}};
        one.update(lists_json(plan.lists[stage]));
        stages.push_back(std::move(one));
    }
    return {{"form", plan.form == TreeForm::whole ? "whole" : "leaves"},
            {"depth_max", plan.depth_max},
            {"stages", std::move(stages)}};
}

std::optional<CyclePlan> plan_from_json(const Json& value) {
    CyclePlan plan;
    if (!take(value, "depth_max", kStageDepthMax, plan.depth_max) || !value.contains("stages") ||
        !value.contains("form")) {
        return std::nullopt;
    }
    const Json &stages = value["stages"], &form = value["form"];
    if (!stages.is_array() || stages.empty() || stages.size() > kStagesMax ||
        (form != "whole" && form != "leaves")) {
        return std::nullopt;
    }
    plan.form = form == "whole" ? TreeForm::whole : TreeForm::leaves;
    plan.stages = static_cast<std::uint32_t>(stages.size());
    for (std::uint32_t stage = 0; stage < plan.stages; ++stage) {
        if (!take_stage(stages[stage], stage, plan)) {
            return std::nullopt;
        }
    }
    return plan;
}

}  // namespace axg
