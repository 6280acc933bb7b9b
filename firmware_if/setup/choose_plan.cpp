// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/choose_plan.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/certificate/stop_certificate.hpp"
#include "core/machine/cycle_plan.hpp"
#include "firmware_if/setup/format_plan.hpp"

namespace axg {
namespace {

/// Lengths in forty-eighths of the lists that the machine file states.
struct PlanStep {
    std::uint32_t nodes, leaves, rows, triangles;
};
// Few steps and not any number: two starts on one machine mostly agree.
constexpr std::array<PlanStep, kPlanSteps> kSteps{{{16, 10, 14, 11},
                                                   {32, 20, 28, 16},
                                                   {48, 48, 48, 32},
                                                   {48, 48, 48, 48},
                                                   {48, 58, 56, 96},
                                                   {96, 116, 112, 144},
                                                   {192, 232, 224, 288}}};

// The chosen plan has to pass the admission a moment later, on another thread.
constexpr double kChosenShare = 0.95;

CycleMeasureOptions quick_options(const CyclePlan& plan, const Machine& machine) {
    CycleMeasureOptions options;
    options.conditions = {CacheCondition::code_cold};
    options.shapes =
        longest_shapes(plan, stop_tasks(machine), tries_longer(machine.can.permit_samples));
    return options;
}

std::optional<CycleMeasurement> measure(const LoadedMachine& loaded, const CyclePlan& plan,
                                        std::string& fault) {
    return measure_cycle(loaded, plan, quick_options(plan, loaded.machine), fault);
}

ChosenPlan judged(const CycleMeasurement& measured, double room_us) {
    ChosenPlan out;
    out.plan = measured.plan;
    out.longest_us = measured.longest_us();
    out.posing_us = measured.posing.wall_us;
    out.room_us = room_us;
    out.is_fit = out.longest_us <= room_us;
    out.least_deadline_us = static_cast<std::int64_t>(std::ceil(out.longest_us / kEngineShare));
    out.words = fmt::format("{}: longest cycle {:.0f} us, limit {:.0f} us", format_plan(out.plan),
                            out.longest_us, room_us);
    if (!out.is_fit) {
        out.words += fmt::format(". Raise deadline_us to {} or more", out.least_deadline_us);
    }
    return out;
}

}  // namespace

CyclePlan plan_at(const Machine& machine, std::uint32_t tasks, std::uint32_t step) {
    const PlanStep& part = kSteps[step];
    const auto of = [](std::uint32_t list, std::uint32_t parts) {
        return static_cast<std::uint32_t>(std::uint64_t{list} * parts / 48);
    };
    const CycleRules& rules = machine.cycle;
    return plan_of(rules.stages, tasks, rules.queries,
                   {.node_pairs = of(rules.lists.node_pairs, part.nodes),
                    .leaf_pairs = of(rules.lists.leaf_pairs, part.leaves),
                    .box_rows = of(rules.lists.box_rows, part.rows),
                    .triangle_pairs = of(rules.lists.triangle_pairs, part.triangles),
                    .rechecks = of(rules.lists.rechecks, part.triangles)});
}

std::optional<ChosenPlan> judge_plan(const LoadedMachine& loaded, const CyclePlan& plan,
                                     std::string& fault) {
    const std::optional<CycleMeasurement> measured = measure(loaded, plan, fault);
    return measured ? std::optional(judged(*measured, time_limits(loaded.machine).engine_us))
                    : std::nullopt;
}

std::optional<ChosenPlan> choose_plan(const LoadedMachine& loaded, std::string& fault) {
    const Machine& machine = loaded.machine;
    const std::uint32_t tasks = stop_tasks(machine);
    if (machine.cycle.is_pinned) {
        return judge_plan(loaded, cycle_plan(machine, tasks), fault);
    }
    const double room_us = time_limits(machine).engine_us, wanted_us = kChosenShare * room_us;
    std::uint32_t low = 0, high = kPlanSteps;  // the highest step that fits, or the lowest
    std::optional<CycleMeasurement> best = measure(loaded, plan_at(machine, tasks, 0), fault);
    while (best && best->longest_us() <= wanted_us && high - low > 1) {
        const std::uint32_t middle = (low + high) / 2;
        std::optional<CycleMeasurement> next =
            measure(loaded, plan_at(machine, tasks, middle), fault);
        if (!next) {
            return std::nullopt;
        }
        const bool fits = next->longest_us() <= wanted_us;
        (fits ? low : high) = middle;
        if (fits) {
            best = std::move(next);
        }
    }
    return best ? std::optional(judged(*best, room_us)) : std::nullopt;
}

}  // namespace axg
