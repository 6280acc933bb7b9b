// SPDX-License-Identifier: Apache-2.0
// The engine's part of `axguard check`: what it reserves, and which pairs touch wherever the
// machine stands.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "config/quote_text.hpp"
#include "core/pair_plan.hpp"
#include "core/sincos.hpp"
#include "hil_replay/check_report.hpp"
#include "hil_replay/guard_engine.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kPoses = 256;  // of the travel, the zero pose first

/// Part of a Halton sequence (Halton 1960): even cover of the travel, the same on every machine.
double radical_inverse(std::uint32_t index, std::uint32_t base) {
    double value = 0, digit = 1;
    for (; index != 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

AxisPicture sampled_pose(const Machine& machine, std::uint32_t index) {
    constexpr std::array<std::uint32_t, kAxesMax> kPrimes{2,  3,  5,  7,  11, 13, 17, 19,
                                                          23, 29, 31, 37, 41, 43, 47, 53};
    AxisPicture picture;
    picture.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double low = axis.unlimited ? 0 : axis.min;
        const double high = axis.unlimited ? 2 * kPi : axis.max;
        picture.position[i] = index == 0 ? std::clamp(0.0, low, high)
                                         : low + (high - low) * radical_inverse(index, kPrimes[i]);
    }
    return picture;
}

/// At how many of the sampled poses each pair is not proven apart, margin 0.
std::vector<std::uint32_t> count_contacts(Machine machine, const std::vector<Pair>& pairs,
                                          CpuEngine& engine) {
    std::vector<std::uint32_t> touching(pairs.size());
    const auto plan = std::make_unique<PairPlan>();
    std::vector<Answer> answers(kPairsMax);
    for (std::size_t first = 0; first < pairs.size(); first += kPairsMax) {
        const std::size_t count = std::min<std::size_t>(kPairsMax, pairs.size() - first);
        machine.pairs.assign(pairs.begin() + static_cast<std::ptrdiff_t>(first),
                             pairs.begin() + static_cast<std::ptrdiff_t>(first + count));
        for (std::uint32_t pose = 0; pose < kPoses; ++pose) {
            plan_contact(machine, sampled_pose(machine, pose), *plan);
            const std::uint32_t asked = plan->status == PlanStatus::ok ? plan->count : 0;
            engine.ask({plan->questions.data(), asked}, {answers.data(), asked});
            for (std::uint32_t i = 0; i < asked; ++i) {
                touching[first + plan->pair[i]] += answers[i].proof == Proof::far ? 0 : 1;
            }
        }
    }
    return touching;
}

std::string name_of(const Machine& machine, const Pair& pair) {
    return escaped(machine.bodies[pair.a].name) + '-' + escaped(machine.bodies[pair.b].name);
}

void report_contacts(CheckReport& report, CpuEngine& engine) {
    const Machine& machine = report.loaded.machine;
    std::vector<Pair> pairs = machine.pairs;
    for (Pair& pair : pairs) {
        pair.margin_mm = 0;
    }
    for (const Exclusion& exclusion : machine.exclusions) {
        pairs.push_back({.a = exclusion.a, .b = exclusion.b, .margin_mm = 0});
    }
    const std::vector<std::uint32_t> touching = count_contacts(machine, pairs, engine);
    Json& list = report.document["contacts"] = Json::array();
    fmt::print(report.words,
               "\ncontact at {} positions spread over the travel, the zero pose first\n", kPoses);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const bool is_checked = i < machine.pairs.size();
        list.push_back({{"pair", name_of(machine, pairs[i])},
                        {"checked", is_checked},
                        {"positions", kPoses},
                        {"in_contact", touching[i]}});
        if (touching[i] == 0) {
            continue;
        }
        fmt::print(report.words, "  {:<24} {:>3} of {}{}{}\n", name_of(machine, pairs[i]),
                   touching[i], kPoses, is_checked ? "" : "  not checked",
                   touching[i] == kPoses ? "  permanent" : "");
        if (is_checked && touching[i] == kPoses) {
            report.warnings.push_back(fmt::format(
                "{}: in contact at every position looked at: the machine would never get a "
                "permit; exclude the pair with a reason, or mend a placement",
                name_of(machine, pairs[i])));
        }
    }
}

}  // namespace

void report_engine(CheckReport& report) {
    std::optional<CpuEngine> engine = make_engine(report.loaded);
    if (!engine) {
        report.warnings.emplace_back(kNoLaneSet);
        return;
    }
    const MemoryPlan& memory = engine->memory();
    const Capacities& capacities = report.loaded.machine.capacities;
    report.document["engine"] = {{"name", "cpu"},
                                 {"lanes", engine->lanes()},
                                 {"trees_bytes", memory.trees_bytes},
                                 {"lists_bytes", memory.lists_bytes},
                                 {"node_pairs", capacities.node_pairs},
                                 {"triangle_pairs", capacities.triangle_pairs},
                                 {"rechecks", capacities.rechecks}};
    fmt::print(report.words,
               "\nengine cpu, {} lanes: {} bytes reserved at start (trees {}, lists {})\n"
               "capacities a question: {} pairs of nodes, {} pairs of triangles, {} rechecks; more "
               "is not proven\n",
               engine->lanes(), memory.total_bytes(), memory.trees_bytes, memory.lists_bytes,
               capacities.node_pairs, capacities.triangle_pairs, capacities.rechecks);
    report_contacts(report, *engine);
}

}  // namespace axg
