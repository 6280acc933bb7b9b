// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/format_plan.hpp"

#include <fmt/format.h>

namespace axg {

std::string format_plan(const CyclePlan& plan) {
    const WorkLists lists = lists_of(plan);
    return fmt::format(
        "{} stages, {} queries after the first; lists: {} node pairs, {} leaf pairs, {} box rows, "
        "{} triangle pairs, {} rechecks",
        plan.stages, queries_of(plan) - plan.queries[0], lists.node_pairs, lists.leaf_pairs,
        lists.box_rows, lists.triangle_pairs, lists.rechecks);
}

std::string format_plan_key(const CyclePlan& plan) {
    const WorkLists lists = lists_of(plan);
    return fmt::format(
        "cycle: {{stages: {}, queries: {}, lists: {{node_pairs: {}, leaf_pairs: {}, box_rows: {}, "
        "triangle_pairs: {}, rechecks: {}}}}}",
        plan.stages, plan.queries[plan.stages - 1], lists.node_pairs, lists.leaf_pairs,
        lists.box_rows, lists.triangle_pairs, lists.rechecks);
}

}  // namespace axg
