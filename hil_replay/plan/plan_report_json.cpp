// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/plan_report_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "firmware_if/cli/plan_json.hpp"
#include "hil_replay/plan/model_choice.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json describe(const CycleTimes& times) {
    return {{"cycles", times.cycles},
            {"p50", times.p50_us},
            {"p99", times.p99_us},
            {"max", times.max_us}};
}

Json describe(const ChosenPlan& chosen) {
    Json stages = Json::array();
    for (std::uint32_t i = 0; i < chosen.plan.stages; ++i) {
        Json shown{{"queries", chosen.plan.queries[i]}};
        shown.update(lists_json(chosen.plan.lists[i]));
        stages.push_back(std::move(shown));
    }
    return {{"stages", std::move(stages)},   {"longest_us", chosen.longest_us},
            {"posing_us", chosen.posing_us}, {"share_us", chosen.room_us},
            {"is_fit", chosen.is_fit},       {"least_deadline_us", chosen.least_deadline_us}};
}

Json describe(const ModelCandidate& model) {
    const ModelMeasurement& m = model.measured;
    return {{"simplify_mm", model.simplify_mm},
            {"triangles", model.triangles},
            {"inflation_mm", model.inflation_mm},
            {"meshes", model.simplified},
            {"memory_bytes", m.memory_bytes},
            {"contact_us", describe(m.contact)},
            {"rest_us", describe(m.rest)},
            {"trace_us", describe(m.trace)},
            {"longest_us", m.longest_us},
            {"queries_most", m.work.queries},
            {"node_pairs_most", m.work.node_pairs},
            {"triangle_pairs_most", m.work.triangle_pairs},
            {"rechecks_most", m.work.rechecks},
            {"over_capacity", m.work.over_capacity},
            {"contact_lost", model.contact_lost},
            {"rest_lost", model.rest_lost},
            {"trace_lost", model.trace_lost},
            {"earlier_mm", {{"p50", model.earlier_mm_p50}, {"max", model.earlier_mm_max}}}};
}

}  // namespace

std::string describe_plan(const ModelChoiceOptions& options, std::int64_t deadline_us,
                          const ModelChoice& choice, const std::optional<ChosenPlan>& cycle) {
    const ModelMeasurement& first = choice.models.front().measured;
    Json out{{"device", first.device},
             {"positions", options.positions},
             {"approaches", first.verdicts.stop_share.size()},
             {"passes", options.passes},
             {"deadline_us", deadline_us},
             {"models", Json::array()},
             {"chosen", choice.chosen},
             {"capacities",
              {{"node_pairs", choice.capacities.node_pairs},
               {"triangle_pairs", choice.capacities.triangle_pairs},
               {"rechecks", choice.capacities.rechecks}}},
             {"cycle_queries", choice.queries},
             {"confirmed", describe(choice.confirmed)}};
    if (cycle) {
        out["cycle"] = describe(*cycle);
    }
    for (const ModelCandidate& model : choice.models) {
        out["models"].push_back(describe(model));
    }
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace axg
