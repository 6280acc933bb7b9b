// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/plan_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "hil_replay/plan/draw_figures.hpp"
#include "hil_replay/plan/model_choice.hpp"
#include "hil_replay/plan/plan_lost.hpp"
#include "hil_replay/plan/plan_report_json.hpp"

namespace axg {
namespace {

std::string title_of(const ModelCandidate& model) {
    return model.simplify_mm == 0 ? "whole" : fmt::format("{:g} mm", model.simplify_mm);
}

std::string yaml_of(const Capacities& c) {
    return fmt::format("capacities: {{node_pairs: {}, triangle_pairs: {}, rechecks: {}}}",
                       c.node_pairs, c.triangle_pairs, c.rechecks);
}

void print_table(const ModelChoice& choice, std::FILE* to) {
    fmt::print(to,
               "  {:<9} {:>9} {:>10} {:>9}   {:^23}   {:^23} {:>6} {:>6} {:>6} {:>9}\n"
               "  {:<9} {:>9} {:>10} {:>9}   {:^23}   {:^23} {:>6} {:>6} {:>6} {:>9}\n",
               "model", "triangles", "inflation", "memory", "contact mode, us", "stoppable, us",
               "lost:", "", "", "earlier", "", "", "mm", "MiB", "p50 / p99 / slowest",
               "p50 / p99 / slowest", "poses", "rest", "trace", "mm (most)");
    for (const ModelCandidate& model : choice.models) {
        const ModelMeasurement& m = model.measured;
        const CycleTimes& stoppable = m.trace.cycles != 0 ? m.trace : m.rest;
        fmt::print(to,
                   "{} {:<9} {:>9} {:>10.3f} {:>9.2f}   {:>7.1f} {:>7.1f} {:>7.1f}   {:>7.1f} "
                   "{:>7.1f} {:>7.1f} {:>6} {:>6} {:>6} {:>4.2f} ({:.2f})\n",
                   &model == &choice.models[choice.chosen] ? ">" : " ", title_of(model),
                   model.triangles, model.inflation_mm,
                   static_cast<double>(m.memory_bytes) / (1U << 20U), m.contact.p50_us,
                   m.contact.p99_us, m.contact.max_us, stoppable.p50_us, stoppable.p99_us,
                   stoppable.max_us, model.contact_lost, model.rest_lost, model.trace_lost,
                   model.earlier_mm_p50, model.earlier_mm_max);
    }
}

void print_lost(const CheckReport& report, const ModelChoice& choice) {
    for (const ModelCandidate& model : choice.models) {
        if (model.lost() != 0) {
            fmt::print(report.words, "  lost, {}: {}\n", title_of(model),
                       format_lost(report.loaded.machine, model));
        }
    }
}

/// The cost of another model, as one sentence.
std::string format_difference(const ModelCandidate& chosen, const ModelCandidate& other) {
    return fmt::format(
        "{}: p99 {:.1f} us instead of {:.1f}, slowest {:.1f} instead of {:.1f}, {:.1f} MiB instead "
        "of {:.1f}; {} results lost, stops {:.2f} mm earlier (median; {:.2f} at most)",
        title_of(other), p99_us(other.measured), p99_us(chosen.measured),
        slowest_us(other.measured), slowest_us(chosen.measured),
        static_cast<double>(other.measured.memory_bytes) / (1U << 20U),
        static_cast<double>(chosen.measured.memory_bytes) / (1U << 20U), other.lost(),
        other.earlier_mm_p50, other.earlier_mm_max);
}

void print_summary(CheckReport& report, const ModelChoice& choice) {
    const ModelCandidate& chosen = choice.models[choice.chosen];
    const double slowest = slowest_us(choice.confirmed.measured);
    const double room = room_us(report.loaded.machine);
    std::string why = "the whole surfaces: coarser ones lose results or save little";
    if (chosen.lost() != 0) {
        why = title_of(chosen) + ": no model without loss meets the deadline";
    } else if (choice.chosen != 0) {
        why = title_of(chosen) + ", the coarsest that loses no result";
    }
    fmt::print(report.words, "\n  chosen: {}\n", why);
    std::string fits = fmt::format(
        "with the lines below, its slowest cycle took {:.1f} us, limit {:.0f} us", slowest, room);
    if (!does_fit(choice, report.loaded.machine)) {
        fits +=
            ": too slow. Raise deadline_us, state fewer cycle.queries, or use a coarser model at "
            "the cost below";
        report.warnings.push_back("plan: " + fits);
    }
    fmt::print(report.words, "  {}\n", fits);
    const std::size_t coarser = next_coarser(choice.models, choice.chosen);
    if (coarser < choice.models.size()) {
        fmt::print(report.words, "  more speed: {}\n",
                   format_difference(chosen, choice.models[coarser]));
    } else {
        fmt::print(report.words,
                   "  more speed: no coarser model saves time or memory; state fewer "
                   "cycle.queries, or a larger horizon\n");
    }
    if (choice.chosen != 0) {
        fmt::print(report.words, "  more accuracy: {}\n",
                   format_difference(chosen, choice.models.front()));
    }
}

void print_lines(CheckReport& report, const ModelChoice& choice) {
    const ModelCandidate& chosen = choice.models[choice.chosen];
    std::string keys;
    for (const std::string& key : chosen.simplified) {
        keys += (keys.empty() ? "" : ", ") + escaped(key);
    }
    fmt::print(report.words, "\n  lines for the machine file\n");
    if (!keys.empty()) {
        fmt::print(report.words, "    simplify_mm: {:g}    # in the mesh of {}\n",
                   chosen.simplify_mm, keys);
    }
    fmt::print(report.words, "    {}    # a query used at most {}, {} and {}; batch is unchanged\n",
               yaml_of(choice.capacities), chosen.measured.work.node_pairs,
               chosen.measured.work.triangle_pairs, chosen.measured.work.rechecks);
    if (choice.queries != report.loaded.machine.cycle.queries) {
        fmt::print(report.words, "    cycle: {{queries: {}}}    # more exceed {} us\n",
                   choice.queries, report.loaded.machine.deadline_us);
    }
    fmt::print(report.words, "  {} results of the whole surfaces are lost with them\n",
               choice.confirmed.lost());
}

/// The lists that a cycle on the CPU has time for, as the machine file states them.
std::optional<ChosenPlan> print_cycle(CheckReport& report) {
    std::string fault;
    std::optional<ChosenPlan> chosen = choose_plan(report.loaded, fault);
    if (!chosen) {
        report.warnings.push_back("plan: no lists of a cycle: " + fault);
        return chosen;
    }
    fmt::print(report.words,
               "\n  lists of a cycle on the CPU: {}\n  to fix them in the machine file\n    {}\n",
               chosen->words, format_plan_key(chosen->plan));
    if (!chosen->is_fit) {
        report.warnings.push_back("plan: " + chosen->words);
    }
    return chosen;
}

std::string csv_of(const ModelChoice& choice) {
    std::string text =
        "simplify_mm,triangles,inflation_mm,memory_bytes,contact_p50_us,contact_p99_us,"
        "contact_max_us,rest_p50_us,rest_p99_us,rest_max_us,trace_p50_us,trace_p99_us,"
        "trace_max_us,longest_us,contact_lost,rest_lost,trace_lost,earlier_mm_p50,"
        "earlier_mm_max\n";
    for (const ModelCandidate& model : choice.models) {
        const ModelMeasurement& m = model.measured;
        text += fmt::format("{:g},{},{:.4f},{}", model.simplify_mm, model.triangles,
                            model.inflation_mm, m.memory_bytes);
        for (const CycleTimes* times : {&m.contact, &m.rest, &m.trace}) {
            text +=
                fmt::format(",{:.2f},{:.2f},{:.2f}", times->p50_us, times->p99_us, times->max_us);
        }
        text += fmt::format(",{:.1f},{},{},{},{:.4f},{:.4f}\n", m.longest_us, model.contact_lost,
                            model.rest_lost, model.trace_lost, model.earlier_mm_p50,
                            model.earlier_mm_max);
    }
    return text;
}

bool write_files(const CheckReport& report, const ModelChoice& choice, const std::string& folder,
                 const std::string& scene) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        fmt::print(stderr, "{}: {}. Pass another folder with --output FOLDER.\n",
                   escaped(folder, 4096), error.message());
        return false;
    }
    if (!write_whole_file(folder + "/plan.csv", csv_of(choice), stderr) ||
        !write_whole_file(folder + "/lost.csv", csv_of_lost(report.loaded.machine, choice.models),
                          stderr) ||
        !write_whole_file(folder + "/conditions.csv",
                          conditions_table({{"machine", escaped(report.loaded.machine.name)},
                                            {"device", choice.models.front().measured.device},
                                            {"scene", scene}}),
                          stderr)) {
        return false;
    }
    return draw_figures("plan/draw_plan.py", folder) != Drawn::failed;
}

}  // namespace

void report_plan(CheckReport& report, const ModelChoiceOptions& options) {
    ModelChoice choice;
    std::string fault;
    const bool on_gpu = report.engine == EngineChoice::cuda;
    const ModelScene scene{.positions = options.positions,
                           .trace = options.trace,
                           .passes = options.passes,
                           .multiprocessors = report.multiprocessors,
                           .approaches = {}};
    if (!make_model_choice(report.loaded, scene, on_gpu, choice, fault)) {
        fmt::print(stderr, "axguard check: {}\n", fault);
        report.exit_code = kExitInput;
        return;
    }
    const ModelMeasurement& first = choice.models.front().measured;
    const std::string looked_at = fmt::format(
        "{} positions spread over the travel, {} approaches to a stop{}; each time the least of "
        "{} passes; {}",
        options.positions, first.verdicts.stop_share.size(),
        first.trace.cycles == 0 ? "" : fmt::format(", {} samples of a trace", first.trace.cycles),
        options.passes, first.device);
    fmt::print(report.words, "\nplan: models of this machine, on {}\n", looked_at);
    print_table(choice, report.words);
    print_lost(report, choice);
    print_summary(report, choice);
    print_lines(report, choice);
    const std::optional<ChosenPlan> cycle = on_gpu ? std::nullopt : print_cycle(report);
    report.facts.plan = describe_plan(options, report.loaded.machine.deadline_us, choice, cycle);
    if (!options.out.empty() && !write_files(report, choice, options.out, looked_at)) {
        report.exit_code = kExitInput;
    }
}

}  // namespace axg
