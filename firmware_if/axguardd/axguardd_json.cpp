// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/axguardd_json.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "firmware_if/axguardd/admission_record.hpp"
#include "firmware_if/axguardd/live_threads.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/cli/plan_json.hpp"
#include "firmware_if/setup/format_plan.hpp"

namespace axg {
namespace {

nlohmann::ordered_json describe(const AdmissionFigures& figures) {
    nlohmann::ordered_json out{{"sample_us", figures.times.period_us},
                               {"deadline_us", figures.times.deadline_us},
                               {"permit_us", figures.times.permit_us}};
    if (figures.wake_ups) {
        out["wake_ups"] = {{"count", figures.wake_ups->count},
                           {"p99_ns", figures.wake_ups->p99_ns},
                           {"latest_ns", figures.wake_ups->latest_ns}};
    }
    if (figures.cycles) {
        const std::optional<CyclePlan>& plan = figures.cycles->plan;
        out["cycles"] = {{"engine", figures.cycles->engine},
                         {"count", figures.cycles->count},
                         {"proven_count", figures.cycles->proven_count},
                         {"proven_us", figures.cycles->proven_us},
                         {"longest_us", figures.cycles->longest_us},
                         {"queries_max", figures.cycles->queries_max},
                         {"fill_us", figures.cycles->worst_case_us},
                         {"plan", plan ? format_plan(*plan) : ""}};
    }
    if (figures.memory) {
        out["memory"] = {{"reserved_bytes", figures.memory->reserved_bytes},
                         {"device_bytes", figures.memory->device_bytes},
                         {"more_bytes", figures.memory->more_bytes},
                         {"available_bytes", figures.memory->available_bytes},
                         {"mapped_bytes", figures.memory->mapped_bytes},
                         {"lock_limit_bytes", figures.memory->lock_limit_bytes}};
    }
    return out;
}

nlohmann::ordered_json describe(const AdmissionLine& line, const std::vector<std::string>& waived) {
    const char* const name = to_text(line.check);
    const bool is_waived =
        !line.is_passed && std::find(waived.begin(), waived.end(), name) != waived.end();
    nlohmann::ordered_json out{{"check", name}, {"passed", line.is_passed}, {"waived", is_waived}};
    if (line.margin) {
        out["margin"] = *line.margin;
    }
    out["found"] = line.found;
    out["mend"] = line.mend;
    return out;
}

}  // namespace

std::string describe_admission(const AdmissionVerdict& verdict, const AdmissionFigures& figures,
                               const AdmissionSubject& subject,
                               const std::vector<std::string>& waived) {
    const std::time_t now = std::time(nullptr);
    utsname system{};
    static_cast<void>(uname(&system));  // where it fails the names are empty
    nlohmann::ordered_json checks = nlohmann::json::array();
    for (const AdmissionLine& line : verdict.lines) {
        checks.push_back(describe(line, waived));
    }
    nlohmann::ordered_json document{
        {"fit", verdict.is_fit()},
        {"admitted", verdict.is_waived_by(waived)},
        {"verdict", to_text(verdict)},
        {"margin", verdict.margin},
        {"checks", checks},
        {"figures", describe(figures)},
        {"machine", subject.machine},
        {"configuration_sha256", subject.configuration_sha256},
        {"bus", subject.bus},
        {"mode", subject.mode},
        {"version", AXG_VERSION},
        {"host", system.nodename},
        {"kernel", fmt::format("{} {} {}", system.release, system.version, system.machine)},
        {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))}};
    if (figures.cycles && figures.cycles->plan) {
        document["plan"] = plan_json(*figures.cycles->plan);  // for read_admitted_plan
    }
    return text_of(document);
}

std::string describe_findings(const std::vector<Finding>& findings) {
    int bad = 0;
    nlohmann::json checks = nlohmann::json::array();
    for (const Finding& finding : findings) {
        bad += finding.fitness == Fitness::bad ? 1 : 0;
        checks.push_back({{"subject", finding.subject},
                          {"fitness", to_text(finding.fitness)},
                          {"found", finding.found},
                          {"mend", finding.mend}});
    }
    return text_of({{"checks", checks}, {"fit", bad == 0}, {"bad", bad}});
}

std::string describe_latency(const LatencyReport& report) {
    const TimeHistogram& lateness = report.lateness;
    return text_of({{"wake_ups", report.count},
                    {"period_us", report.period_us},
                    {"late_ns",
                     {{"p50", lateness.at_share_ns(0.5)},
                      {"p99", lateness.at_share_ns(0.99)},
                      {"p999", lateness.at_share_ns(0.999)},
                      {"max", lateness.most_ns()}}},
                    {"three_over_n", report.rate},
                    {"fit", report.is_fit},
                    {"fit_period_us", report.fit_us},
                    {"refused", report.refused}});
}

std::string describe_run(const RunSubject& subject, const LiveEnd& end) {
    nlohmann::json faults = nlohmann::json::object();
    for (std::uint32_t i = 0; i < kReceiverFaults; ++i) {
        const auto fault = static_cast<ReceiverFault>(i);
        if (end.input.of(fault) != 0) {
            faults[fault_row(fault).name] = end.input.of(fault);
        }
    }
    const LiveCounters& counters = end.counters;
    const auto period_us = static_cast<double>(end.input.measured_period_ns) / 1000;
    const nlohmann::json document{{"machine", subject.machine},
                                  {"bus", subject.bus},
                                  {"mode", subject.mode},
                                  {"hashes", subject.compares_hashes ? "required" : "none"},
                                  {"phase", to_text(end.guard.phase)},
                                  {"cause", to_text(end.guard.cause)},
                                  {"reason", to_text(end.reason)},
                                  {"snapshots", counters.snapshots},
                                  {"permits", counters.permits},
                                  {"permits_slow", counters.slow},
                                  {"stop_frames", counters.stops},
                                  {"late", counters.late},
                                  {"refused", counters.refused},
                                  {"echoes", counters.echoes},
                                  {"send_faults", counters.send_faults},
                                  {"turns_cut_short", counters.frames_left},
                                  {"operator_acts", counters.operator_acts},
                                  {"operator_refused", counters.operator_refused},
                                  {"operator_ignored", counters.operator_ignored},
                                  {"samples_lost", end.input.samples_lost},
                                  {"frames_dropped", end.frames_dropped},
                                  {"records_lost", counters.records_lost},
                                  {"measured_period_us", period_us},
                                  {"black_box", end.dump},
                                  {"receiver_faults", faults}};
    return text_of(document);
}

}  // namespace axg
