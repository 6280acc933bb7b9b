// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/admission_record.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

namespace axg {
namespace {

nlohmann::ordered_json describe(const AdmissionFigures& figures) {
    nlohmann::ordered_json out{{"sample_us", figures.sample_us},
                               {"deadline_us", figures.deadline_us},
                               {"permit_us", figures.permit_us}};
    if (figures.wake_ups) {
        out["wake_ups"] = {{"count", figures.wake_ups->count},
                           {"p99_ns", figures.wake_ups->p99_ns},
                           {"latest_ns", figures.wake_ups->latest_ns}};
    }
    if (figures.cycles) {
        out["cycles"] = {{"engine", figures.cycles->engine},
                         {"count", figures.cycles->count},
                         {"proven_count", figures.cycles->proven_count},
                         {"proven_us", figures.cycles->proven_us},
                         {"longest_us", figures.cycles->longest_us},
                         {"questions_max", figures.cycles->queries_max},
                         {"fill_us", figures.cycles->worst_case_us}};
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

std::string admission_path(const std::string& state_dir, const std::string& bus) {
    return state_dir + "/" + bus + ".admission.json";
}

nlohmann::ordered_json describe(const AdmissionVerdict& verdict, const AdmissionFigures& figures,
                                const AdmissionSubject& subject,
                                const std::vector<std::string>& waived) {
    const std::time_t now = std::time(nullptr);
    utsname system{};
    static_cast<void>(uname(&system));  // where it fails the names are empty
    nlohmann::ordered_json checks = nlohmann::json::array();
    for (const AdmissionLine& line : verdict.lines) {
        checks.push_back(describe(line, waived));
    }
    return {{"fit", verdict.is_fit()},
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
}

std::string table_of(const AdmissionVerdict& verdict, bool only_failed) {
    std::string out;
    for (const AdmissionLine& line : verdict.lines) {
        if (line.is_passed && only_failed) {
            continue;
        }
        out += fmt::format("{:<5} {:<8} {}\n", line.is_passed ? "OK" : "BAD", to_text(line.check),
                           line.found);
        if (!line.mend.empty()) {
            out += fmt::format("{:<14} -> {}\n", "", line.mend);
        }
    }
    return out;
}

}  // namespace axg
