// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware_if/cli/document_json.hpp"
#include "hil_replay/commands/verify_report.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json events_json(const std::vector<VerifyEvent>& events, const char* what, bool has_clearance) {
    auto out = Json::array();
    for (const VerifyEvent& event : events) {
        Json one{{what, event.what},
                 {"time_s", event.time_s},
                 {"line", event.line},
                 {"block", event.block},
                 {"tool", event.tool}};
        if (has_clearance) {
            one["clearance_mm"] =
                std::isfinite(event.clearance_mm) ? Json(event.clearance_mm) : Json();
        }
        out.push_back(std::move(one));
    }
    return out;
}

}  // namespace

std::string describe_verify(const VerifyReport& report) {
    Json out{{"program", "axguard"},      {"version", report.version},
             {"command", "verify"},       {"exit_code", report.exit_code()},
             {"machine", report.machine}, {"overrides", report.overrides},
             {"rapids", "axis speeds"}};
    if (report.cut_mm_min > 0) {
        out["feeds_cut_at_mm_min"] = report.cut_mm_min;
    }
    if (!report.not_obeyed.empty()) {
        out["not_obeyed"] = report.not_obeyed;
    }
    auto& programs = out["programs"] = Json::array();
    for (const VerifiedProgram& program : report.programs) {
        auto runs = Json::array();
        for (const VerifyRun& run : program.runs) {
            runs.push_back({{"override", run.override_percent},
                            {"exit_code", run.exit_code},
                            {"program_s", run.program_s},
                            {"path_mm", run.path_mm},
                            {"samples", run.samples},
                            {"permits", run.permits},
                            {"contacts", events_json(run.contacts, "pair", false)},
                            {"stops", events_json(run.stops, "reason", false)},
                            {"stop_count", run.stop_count},
                            {"nearest", events_json(run.nearest, "pair", true)}});
        }
        programs.push_back({{"file", program.file},
                            {"read_as", program.read_as},
                            {"exit_code", program.exit_code},
                            {"runs", std::move(runs)}});
    }
    return text_of(out);
}

}  // namespace axg
