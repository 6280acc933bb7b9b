// SPDX-License-Identifier: Apache-2.0
// The engine's part of `axguard check`: its memory, and which pairs touch, or are one inside the
// other, at poses of the whole travel.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/text/quote_text.hpp"
#include "core/certificate/pair_queries.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPoses = 256;  // of the travel, the zero pose first

/// A pair at the sampled poses, margin 0.
struct Sampled {
    std::uint32_t touching = 0;   // poses at which the surfaces are not proven apart
    std::uint32_t contained = 0;  // those at which they are, and one body is inside the other
    std::uint32_t not_known = 0;  // those at which containment is not proven
    Containment first = Containment::not_proven;  // at the first pose with one inside the other
    bool starts_inside = false;                   // that is the zero pose
};

void count_pose(const QueryResult& surfaces, const ContainmentResult& contained, std::uint32_t pose,
                Sampled& out) {
    if (surfaces.proof != Proof::far) {
        ++out.touching;
    } else if (contained.containment == Containment::not_proven) {
        ++out.not_known;
    } else if (contained.containment != Containment::none) {
        out.starts_inside = out.starts_inside || pose == 0;
        out.first = out.contained++ == 0 ? contained.containment : out.first;
    }
}

std::vector<Sampled> sample_pairs(Machine machine, const std::vector<Pair>& pairs,
                                  CpuEngine& engine, const ContainmentTest& containment_test) {
    std::vector<Sampled> found(pairs.size());
    const auto pair_queries = std::make_unique<PairQueries>();
    std::vector<QueryResult> results(kPairsMax);
    std::vector<ContainmentResult> contained(kPairsMax);
    for (std::size_t first = 0; first < pairs.size(); first += kPairsMax) {
        const std::size_t count = std::min<std::size_t>(kPairsMax, pairs.size() - first);
        machine.pairs.assign(pairs.begin() + static_cast<std::ptrdiff_t>(first),
                             pairs.begin() + static_cast<std::ptrdiff_t>(first + count));
        for (std::uint32_t pose = 0; pose < kPoses; ++pose) {
            make_contact_queries(machine, sampled_position(machine, pose), *pair_queries);
            const std::uint32_t query_count =
                pair_queries->status == SnapshotStatus::ok ? pair_queries->count : 0;
            const std::span<const Query> queries{pair_queries->queries.data(), query_count};
            engine.run(queries, {results.data(), query_count});
            containment_test.run(queries, {results.data(), query_count},
                                 {contained.data(), query_count});
            for (std::uint32_t i = 0; i < query_count; ++i) {
                count_pose(results[i], contained[i], pose, found[first + pair_queries->pair[i]]);
            }
        }
    }
    return found;
}

std::string name_of(const Machine& machine, const Pair& pair) {
    return escaped(machine.bodies[pair.a].name) + '-' + escaped(machine.bodies[pair.b].name);
}

/// "cutter inside frame".
std::string nesting_of(const Machine& machine, const Pair& pair, const Sampled& sampled) {
    const bool a_in_b = sampled.first == Containment::a_in_b;
    return escaped(machine.bodies[a_in_b ? pair.a : pair.b].name) + " inside " +
           escaped(machine.bodies[a_in_b ? pair.b : pair.a].name);
}

void print_sampled(const CheckReport& report, const Pair& pair, const Sampled& sampled) {
    const Machine& machine = report.loaded.machine;
    const auto line = [&](std::uint32_t poses, const std::string& what) {
        if (poses != 0) {
            fmt::print(report.words, "  {:<24} {:>3} of {}{}{}\n", name_of(machine, pair), poses,
                       kPoses, what, poses == kPoses ? "  permanent" : "");
        }
    };
    line(sampled.touching, "");
    line(sampled.contained, "  " + nesting_of(machine, pair, sampled));
    line(sampled.not_known, "  containment unknown");
}

void warn_of(CheckReport& report, const Pair& pair, const Sampled& sampled) {
    const Machine& machine = report.loaded.machine;
    const std::string name = name_of(machine, pair);
    if (sampled.touching + sampled.contained == kPoses) {
        report.warnings.push_back(
            fmt::format("{}: in contact{} at every sampled position, so that no permit is "
                        "possible. Exclude the pair with a reason, or correct a placement.",
                        name, sampled.contained != 0 ? " or one inside the other" : ""));
    } else if (sampled.starts_inside) {
        report.warnings.push_back(
            fmt::format("{}: {} at the zero pose. Exclude the pair with a reason if this is "
                        "intended; otherwise correct a placement.",
                        name, nesting_of(machine, pair, sampled)));
    }
}

void report_contacts(CheckReport& report, CpuEngine& engine,
                     const ContainmentTest& containment_test) {
    const Machine& machine = report.loaded.machine;
    std::vector<Pair> pairs = machine.pairs;
    for (Pair& pair : pairs) {
        pair.margin_mm = 0;
    }
    const std::vector<Sampled> sampled = sample_pairs(machine, pairs, engine, containment_test);
    fmt::print(report.words,
               "\npairs checked that are in contact, or one body inside the other, at {} positions "
               "of the travel "
               "(the zero pose first)\n",
               kPoses);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        report.facts.contacts.push_back({.name = name_of(machine, pairs[i]),
                                         .positions = kPoses,
                                         .touching = sampled[i].touching,
                                         .contained = sampled[i].contained,
                                         .not_known = sampled[i].not_known});
        print_sampled(report, pairs[i], sampled[i]);
        warn_of(report, pairs[i], sampled[i]);
    }
}

/// Reports whether the requested engine, other than the CPU's, may run on this device.
void report_choice(CheckReport& report, CpuEngine& engine) {
    const Machine& machine = report.loaded.machine;
    CycleDemand demand = cycle_demand(machine, true);
    const ChosenEngine chosen = choose_engine_and_plan(report.loaded, engine, report.engine, demand,
                                                       report.multiprocessors);
    report.exit_code = exit_code_of(chosen.refusal);
    if (!chosen.words.empty()) {
        EngineFacts& facts = *report.facts.engine;
        facts.choice = chosen.gpu ? "cuda" : "cpu";
        facts.gpu = chosen.gpu_name();
        facts.choice_words = chosen.words;
        fmt::print(report.words, "{}\n", chosen.words);
    }
}

}  // namespace

void report_engine(CheckReport& report) {
    std::optional<CpuEngine> engine = make_engine(report.loaded);
    if (!engine) {
        report.warnings.emplace_back(kNoLaneSet);
        return;
    }
    const std::optional<ContainmentTest> containment_test =
        make_containment_test(report.loaded, *engine);
    if (!containment_test) {
        report.warnings.emplace_back(kNoMemoryForContainment);
        return;
    }
    const MemoryPlan& memory = engine->memory();
    const std::size_t total_bytes = memory.total_bytes() + containment_test->size_bytes();
    const Capacities& capacities = report.loaded.machine.capacities;
    report.facts.engine = {.lanes = std::string(engine->lanes()),
                           .trees_bytes = memory.trees_bytes,
                           .lists_bytes = memory.lists_bytes,
                           .solids_bytes = containment_test->size_bytes()};
    fmt::print(report.words,
               "\nengine cpu, {} lanes: {} bytes reserved at start (trees {}, lists {}, "
               "containment test {})\ncapacities of a query: {} node pairs, {} triangle pairs, {} "
               "rechecks; beyond these it is not proven\n",
               engine->lanes(), total_bytes, memory.trees_bytes, memory.lists_bytes,
               containment_test->size_bytes(), capacities.node_pairs, capacities.triangle_pairs,
               capacities.rechecks);
    report_choice(report, *engine);
    report_contacts(report, *engine, *containment_test);
    report_exclusions(report);
}

}  // namespace axg
