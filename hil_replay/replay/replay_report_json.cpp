// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/cli/plan_json.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/replay/limits_json.hpp"
#include "hil_replay/replay/pairs_at_stop.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/replay_report.hpp"
#include "hil_replay/replay/stop_cause_json.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

double us(std::int64_t ns) {
    return static_cast<double>(ns) * 1e-3;
}

Json axes_json(const Machine& machine, const AxisSnapshot& snapshot) {
    auto axes = Json::object();
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {  // none: no complete sample before
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        axes[machine.axes[i].name + (rotary ? "_deg" : "_mm")] =
            snapshot.position[i] * (rotary ? 180.0 / kPi : 1.0);
    }
    return axes;
}

/// Period of the machine file, against which a live guard measures, and that of the trace, which
/// the replay uses.
Json period_json(const ReplayReport& report) {
    const TracePeriod& period = report.period;
    Json out{{"declared_us", period.declared_us},
             {"taken_us", report.loaded.machine.can.sample_us},
             {"shown", period.verdict == PeriodVerdict::right   ? "right"
                       : period.verdict == PeriodVerdict::wrong ? "wrong"
                                                                : "unknown"}};
    if (period.measured_ns != 0) {
        out["measured_us"] = static_cast<double>(period.measured_ns) / 1000;
    }
    return out;
}

Json stop_json(const ReplayReport& report, const StopEvent& stop) {
    const Machine& machine = report.loaded.machine;
    Json out{{"time_us", stop.time_us},
             {"sample", stop.snapshot.sample},
             {"samples", stop.samples},
             {"reason", reason_text(stop)}};
    add_stop_cause(machine, stop.reason, stop.pair, stop.fault, stop.limit, out);
    if (stop.fault == ReceiverFault::sync_period) {
        out["measured_us"] = static_cast<double>(stop.measured_period_ns) / 1000;
    }
    add_program_line(report.lines, stop.snapshot.arrived_us, out);
    out["axes"] = axes_json(machine, stop.snapshot);
    if (is_about_distance(stop.reason)) {
        auto& pairs = out["pairs"] = Json::array();
        for (const PairAtStop& pair : pairs_at(report, stop)) {
            Json triangles = Json::array();
            for (const TriangleIds& t : pair.triangles) {
                triangles.push_back({t.a, t.b});
            }
            pairs.push_back({{"pair", pair_name(machine, pair.pair)},
                             {"clearance_mm", pair.clearance_mm},
                             {"margin_mm", pair.margin_mm},
                             {"touching", pair.touching},
                             {"touching_cut_short", pair.is_cut_short},
                             {"triangles", std::move(triangles)}});
            if (pair.nearest.a != kNoIndex && pair.nearest.b != kNoIndex) {
                pairs.back()["nearest"] = {pair.nearest.a, pair.nearest.b};
            }
            if (is_contained(pair)) {
                pairs.back()["inside"] = nested_names(machine, pair).first;
            }
        }
        out["escapes"] = escapes_json(machine, escapes_at(report, stop));
    }
    if (const auto why = report.whys.find(&stop); why != report.whys.end()) {
        out["why"] = why_json(machine, why->second);
    }
    return out;
}

Json time_json(const TimeHistogram& time) {
    return {{"count", time.count()},
            {"avg_us", time.mean_ns() * 1e-3},
            {"min_us", us(time.least_ns())},
            {"max_us", us(time.most_ns())},
            {"p99_us", us(time.at_share_ns(0.99))}};
}

Json proofs_json(const ReplayReport& report) {
    const ProofStatistics& proofs = report.run.proofs();
    const auto counts = [](const CountTable& table, std::uint32_t most) {
        return Json{{"median", table.at_share(0.5)}, {"p99", table.at_share(0.99)}, {"max", most}};
    };
    return {
        {"horizon_ms",
         free_seconds(report.loaded.machine, report.loaded.machine.can.permit_samples.least) * 1e3},
        {"queries", counts(proofs.queries, proofs.queries_most)},
        {"stages", counts(proofs.stages, proofs.stages_most)},
        {"plan", plan_json(report.run.plan())},
        {"plan_of", report.plan_of.empty() ? report.loaded.source.file : report.plan_of},
        {"withheld", proofs.withheld}};
}

Json clearance_levels_json(const ReplayReport& report) {
    const ClearanceLevelStatistics& clearance_levels = report.run.clearance_levels();
    return {{"slow", clearance_levels.slow},
            {"warn", clearance_levels.warn},
            {"queries",
             {{"median", clearance_levels.queries.at_share(0.5)},
              {"p99", clearance_levels.queries.at_share(0.99)},
              {"max", clearance_levels.queries_most}}}};
}

/// When the guard was armed, and how the trace ends.
void add_course(const ReplayRun& run, Json& out) {
    if (run.armed_us()) {
        out["armed_us"] = *run.armed_us();
    }
    if (run.guard_frames() != 0) {
        out["guard_frames"] = run.guard_frames();
    }
    const StopEvent& end = run.end_in_motion();
    if (end.samples != 0) {
        out["ends_in_motion"] = {{"time_us", end.time_us}, {"sample", end.snapshot.sample}};
        if (end.cause != GuardFault::none) {
            out["ends_in_motion"]["stop_us"] = end.stop_us;
            out["ends_in_motion"]["reason"] = reason_text(end);
        }
    }
}

Json faults_json(const ReceiverCounters& counters) {
    Json out = Json::object();
    for (std::uint32_t i = 1; i < kReceiverFaults; ++i) {
        if (counters.faults[i] != 0) {
            out[fault_row(static_cast<ReceiverFault>(i)).name] = counters.faults[i];
        }
    }
    return out;
}

/// By name; with times if each pair was queried separately.
Json pairs_json(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    const Machine& machine = report.loaded.machine;
    const bool has_times = !run.is_stoppable() && report.gpu.empty();
    Json out = Json::object();
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        Json pair = has_times ? time_json(run.pairs()[i].time) : Json::object();
        pair["not_proven"] = run.pairs()[i].not_proven;
        if (run.has_clearance_levels()) {
            pair["slow"] = run.pairs()[i].slow;
            pair["warn"] = run.pairs()[i].warn;
        }
        out[pair_name(machine, i)] = std::move(pair);
    }
    return out;
}

Json cycle_json(const ReplayRun& run) {
    Json out = time_json(run.cycles());
    out["median_us"] = us(run.cycles().at_share_ns(0.5));
    return out;
}

Json slowest_json(const ReplayReport& report) {
    Json out = Json::array();
    for (const SlowCycle& slow : report.run.slowest()) {
        out.push_back({{"us", us(slow.spent_ns)},
                       {"time_us", slow.snapshot.arrived_us},
                       {"axes", axes_json(report.loaded.machine, slow.snapshot)}});
    }
    return out;
}

/// Adds whether the trace was read without fault, and which lines were skipped.
void add_end(const TraceEnd& end, Json& out) {
    out["valid"] = end.fault.empty();
    if (!end.fault.empty()) {
        out["fault"] = end.fault;
    }
    out["lines_skipped"] = end.lines_skipped;
    if (end.lines_skipped != 0) {
        out["first_skipped"] = end.first_skipped;
    }
}

}  // namespace

std::string describe_unread(const std::string& trace, const std::string& fault) {
    Json out{{"trace", trace}};
    add_end({.fault = fault}, out);
    return text_of(out);
}

ReplayDocument describe_replay(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    const Machine& machine = report.loaded.machine;
    const ReceiverCounters counters = run.input();
    Json out{{"trace", report.trace}};
    add_end(report.end, out);
    if (!report.lines.is_empty()) {
        out["program"] = report.lines.program;
        if (!report.lines.read_as.empty()) {
            out["read_as"] = report.lines.read_as;
        }
    }
    out.update(Json{{"machine", machine.name},
                    {"mode", run.is_stoppable() ? "stoppable" : "contact"},
                    {"engine", report.gpu.empty() ? "cpu" : "cuda"},
                    {"lanes", report.engine.lanes()},
                    {"gpu", report.gpu},
                    {"frames", run.frame_count()},
                    {"samples", run.cycles().count()},
                    {"samples_lost", counters.samples_lost},
                    {"permits", run.permits()},
                    {"deadline_us", report.deadline_us},
                    {"overruns", run.overruns()},
                    {"obeyed_by", to_text(machine.guard.obeyed_by)}});
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        out["not_obeyed"] = refusal;
    }
    if (machine.can.hashes_in_id != 0) {
        out["hashes_compared"] = run.hashes_heard();
    }
    out["period"] = period_json(report);
    add_course(run, out);
    out["receiver_faults"] = faults_json(counters);
    out["pairs"] = pairs_json(report);
    if (run.has_clearance_levels()) {
        out["levels"] = clearance_levels_json(report);
    }
    if (run.is_stoppable()) {
        out["proofs"] = proofs_json(report);
    }
    out["limits"] = limits_json(machine, run.limits());
    out["cycle"] = cycle_json(run);
    out["slowest"] = slowest_json(report);
    auto& stops = out["stops"] = Json::array();
    for (const StopEvent& stop : run.stops()) {
        stops.push_back(stop_json(report, stop));
    }
    out["stop_count"] = run.stop_count();
    Json shown = out["stops"];  // for a page, which also contains the sentences
    const auto add_sentences = [&](const StopEvent& stop, Json& on_page) {
        if (const auto why = report.whys.find(&stop); why != report.whys.end()) {
            on_page["why"] = page_why_json(machine, why->second);
        }
    };
    for (std::size_t i = 0; i < run.stops().size(); ++i) {
        add_sentences(run.stops()[i], shown[i]);
    }
    if (run.withheld().samples != 0) {
        out["kept_back"] = stop_json(report, run.withheld());
        shown.push_back(out["kept_back"]);
        add_sentences(run.withheld(), shown.back());
        shown.back()["withheld"] = true;
    }
    return {text_of(out), shown.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

}  // namespace axg
