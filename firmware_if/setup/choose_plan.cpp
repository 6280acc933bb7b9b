// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/choose_plan.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/certificate/stop_certificate.hpp"

namespace axg {
namespace {

// From the floor to four times the default. A ladder and not any number: two starts on one machine
// mostly agree.
constexpr std::array<std::uint32_t, 11> kLeafPairs{kLeafPairsMin, 96,  128,  192,  256, 384,
                                                   512,           768, 1024, 1536, 2048};
constexpr std::uint32_t kLeafPairsForThree = 512;  // with fewer, three stages prove less than two

// What is chosen has to pass the admission a moment later, on another thread.
constexpr double kChosenShare = 0.95;

/// Whatever its length is measured at: layouts that were longest on every machine so far.
CycleMeasureOptions quick_options(const CyclePlan& plan, std::uint32_t tasks) {
    CycleMeasureOptions options;
    options.conditions = {CacheCondition::code_cold};
    for (const CycleLayout layout : {CycleLayout::rows, CycleLayout::sparse}) {
        for (CycleShape shape : cycle_shapes(plan, tasks)) {
            shape.layout = layout;
            options.shapes.push_back(shape);
        }
    }
    return options;
}

class Ladder {
  public:
    Ladder(const LoadedMachine& loaded, double room_us)
        : loaded_(loaded), tasks_(stop_tasks(loaded.machine)), room_us_(room_us) {}

    [[nodiscard]] CyclePlan plan(std::uint32_t stages, std::size_t rung) const {
        return plan_at({.stages = stages, .leaf_pairs = kLeafPairs[rung]}, tasks_);
    }
    /// The highest rung that fits; the lowest where none does. Empty: not measured.
    std::optional<CycleMeasurement> climb(std::uint32_t stages, std::string& fault) const {
        std::size_t low = 0, high = kLeafPairs.size();
        std::optional<CycleMeasurement> best = measure(stages, 0, fault);
        while (best && best->longest_us() <= room_us_ && high - low > 1) {
            const std::size_t middle = (low + high) / 2;
            std::optional<CycleMeasurement> next = measure(stages, middle, fault);
            if (!next) {
                return std::nullopt;
            }
            const bool fits = next->longest_us() <= room_us_;
            (fits ? low : high) = middle;
            if (fits) {
                best = std::move(next);
            }
        }
        return best;
    }

  private:
    std::optional<CycleMeasurement> measure(std::uint32_t stages, std::size_t rung,
                                            std::string& fault) const {
        const CyclePlan wanted = plan(stages, rung);
        return measure_cycle(loaded_, wanted, quick_options(wanted, tasks_), fault);
    }

    const LoadedMachine& loaded_;
    std::uint32_t tasks_;
    double room_us_;
};

ChosenPlan judged(const CycleMeasurement& measured, double room_us) {
    ChosenPlan out;
    out.plan = measured.plan;
    out.longest_us = measured.longest_us();
    out.posing_us = measured.posing.wall_us;
    out.room_us = room_us;
    out.is_fit = out.longest_us <= room_us;
    out.least_deadline_us = static_cast<std::int64_t>(std::ceil(out.longest_us / kEngineShare));
    out.words = fmt::format("{}: the longest cycle took {:.0f} us, {:.0f} are its share",
                            to_text(out.plan), out.longest_us, room_us);
    if (!out.is_fit) {
        out.words += fmt::format("; raise deadline_us to {} or more", out.least_deadline_us);
    }
    return out;
}

}  // namespace

CyclePlan plan_at(const PlanScale& scale, std::uint32_t tasks) noexcept {
    const WorkLists lists{.node_pairs = scale.leaf_pairs,
                          .leaf_pairs = scale.leaf_pairs,
                          .box_rows = 4 * scale.leaf_pairs,
                          .triangle_pairs = 8 * scale.leaf_pairs,
                          .rechecks = 0};
    return plan_of(scale.stages, tasks, kPlanQueries, lists);
}

WorkLists lists_in(const CyclePlan& plan) noexcept {
    WorkLists sum;
    for (std::uint32_t i = 0; i < plan.stages; ++i) {
        sum.node_pairs += plan.lists[i].node_pairs;
        sum.leaf_pairs += plan.lists[i].leaf_pairs;
        sum.box_rows += plan.lists[i].box_rows;
        sum.triangle_pairs += plan.lists[i].triangle_pairs;
        sum.rechecks += plan.lists[i].rechecks;
    }
    return sum;
}

std::string to_text(const CyclePlan& plan) {
    const WorkLists sum = lists_in(plan);
    std::string queries = fmt::format("{}", plan.queries[0]);
    for (std::uint32_t i = 1; i < plan.stages; ++i) {
        queries += fmt::format(" + {}", plan.queries[i]);
    }
    return fmt::format(
        "{} stages, {} queries, {} node pairs, {} leaf pairs, {} box rows, {} triangle pairs, {} "
        "rechecks",
        plan.stages, queries, sum.node_pairs, sum.leaf_pairs, sum.box_rows, sum.triangle_pairs,
        sum.rechecks);
}

std::optional<ChosenPlan> choose_plan(const LoadedMachine& loaded,
                                      const std::optional<CyclePlan>& pinned, std::string& fault) {
    const double room_us = time_limits(loaded.machine).engine_us;
    if (pinned) {
        const auto measured = measure_cycle(
            loaded, *pinned, quick_options(*pinned, stop_tasks(loaded.machine)), fault);
        return measured ? std::optional(judged(*measured, room_us)) : std::nullopt;
    }
    const Ladder ladder(loaded, kChosenShare * room_us);
    const std::optional<CycleMeasurement> two = ladder.climb(2, fault);
    if (!two) {
        return std::nullopt;
    }
    const bool may_be_three =
        lists_in(two->plan).leaf_pairs >= kLeafPairsForThree && two->longest_us() <= room_us;
    const std::optional<CycleMeasurement> three =
        may_be_three ? ladder.climb(3, fault) : std::nullopt;
    const bool is_three = three && three->longest_us() <= room_us &&
                          lists_in(three->plan).leaf_pairs >= kLeafPairsForThree;
    return judged(is_three ? *three : *two, room_us);
}

}  // namespace axg
