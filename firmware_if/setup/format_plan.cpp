// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/format_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace axg {

std::string format_lists(const WorkLists& lists) {
    std::string text;
    for (const WorkListName& one : kWorkLists) {
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", one.name, lists.*one.list);
    }
    return text;
}

std::string format_plan(const CyclePlan& plan) {
    const WorkLists lists = lists_of(plan);
    std::string text = fmt::format("{} stages, {} queries after the first; lists:", plan.stages,
                                   queries_of(plan) - plan.queries[0]);
    for (const WorkListName& one : kWorkLists) {
        std::string name = one.name;
        std::replace(name.begin(), name.end(), '_', ' ');
        text += fmt::format("{} {} {}", &one == &kWorkLists[0] ? "" : ",", lists.*one.list, name);
    }
    return text;
}

std::string format_plan_key(const CyclePlan& plan) {
    return fmt::format("cycle: {{stages: {}, queries: {}, lists: {{{}}}}}", plan.stages,
                       plan.queries[plan.stages - 1], format_lists(lists_of(plan)));
}

}  // namespace axg
