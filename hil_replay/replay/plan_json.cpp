// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/plan_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace axg {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json plan_json(const CyclePlan& plan) {
    auto stages = Json::array();
    for (std::uint32_t stage = 0; stage < plan.stages; ++stage) {
        const WorkLists& lists = plan.lists[stage];
        Json shown{{"queries", plan.queries[stage]}};
        for (const WorkListName& one : kWorkLists) {
            shown[one.name] = lists.*one.list;
        }
        stages.push_back(std::move(shown));
    }
    return {{"form", plan.form == TreeForm::whole ? "whole" : "leaves"},
            {"depth_max", plan.depth_max},
            {"stages", std::move(stages)}};
}

}  // namespace axg
