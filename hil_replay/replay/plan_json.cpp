// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/plan_json.hpp"

#include <nlohmann/json.hpp>

namespace axg {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json plan_json(const CyclePlan& plan) {
    auto stages = Json::array();
    for (std::uint32_t stage = 0; stage < plan.stages; ++stage) {
        const WorkLists& lists = plan.lists[stage];
        stages.push_back({{"queries", plan.queries[stage]},
                          {"node_pairs", lists.node_pairs},
                          {"leaf_pairs", lists.leaf_pairs},
                          {"box_rows", lists.box_rows},
                          {"triangle_pairs", lists.triangle_pairs},
                          {"rechecks", lists.rechecks}});
    }
    return {{"form", plan.form == TreeForm::whole ? "whole" : "leaves"},
            {"depth_max", plan.depth_max},
            {"stages", std::move(stages)}};
}

}  // namespace axg
