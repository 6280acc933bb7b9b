// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/live_engines.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "firmware_if/setup/guard_engine.hpp"

namespace axg {

namespace {

ChosenEngine none(std::string_view words) {
    return {.words = std::string(words), .refusal = EngineRefusal::unfit};
}

/// The plan with which the GPU was admitted.
ChosenPlan plan_of_gpu(const ChosenEngine& chosen, const CycleDemand& demand) {
    return {.plan = *demand.plan,
            .is_fit = true,
            .longest_us = chosen.longest_us,
            .room_us = demand.times.engine_us,
            .words = format_plan(*demand.plan)};
}

std::optional<ChosenPlan> plan_for(const LoadedMachine& loaded) {
    std::string fault;
    std::optional<ChosenPlan> plan = choose_plan(loaded, fault);
    if (!plan) {
        fmt::print(stderr, "axguardd: no cycle plan: {}\n", fault);
    }
    return plan;
}

ChosenEngine choose(const LoadedMachine& loaded, const std::string& word, bool is_stoppable,
                    CpuEngine& cpu, std::optional<ChosenPlan>& plan) {
    CycleDemand demand = cycle_demand(loaded.machine, is_stoppable);
    ChosenEngine chosen =
        choose_engine_and_plan(loaded, cpu, engine_choice(word, loaded.machine), demand);
    if (is_stoppable && chosen.refusal == EngineRefusal::none) {
        plan = chosen.gpu ? plan_of_gpu(chosen, demand) : plan_for(loaded);
    }
    return chosen;
}

}  // namespace

LiveEngines::LiveEngines(const LoadedMachine& loaded, const std::string& word, bool is_stoppable)
    : cpu(make_engine(loaded)),
      containment_test(cpu ? make_containment_test(loaded, *cpu) : std::nullopt),
      chosen(!cpu                ? none(kNoLaneSet)
             : !containment_test ? none(kNoMemoryForContainment)
                                 : choose(loaded, word, is_stoppable, *cpu, plan)) {}

int log_engines(const LiveEngines& engines) {
    if (!engines.chosen.words.empty()) {
        fmt::print(stderr, "axguardd: {}\n", engines.chosen.words);
    }
    if (engines.plan) {
        fmt::print(stderr,
                   "axguardd: cycle plan: {}\naxguardd: to fix it in the machine file: {}\n",
                   engines.plan->words, format_plan_key(engines.plan->plan));
    }
    return exit_code_of(engines.chosen.refusal);
}

}  // namespace axg
