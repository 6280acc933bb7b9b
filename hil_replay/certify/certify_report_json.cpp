// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "hil_replay/certify/certify_report.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json describe_open(const CertifyReport& report, const OpenStretch& open) {
    const Machine& machine = report.machine;
    const CertifyTask& task = report.tasks.tasks[open.task];
    const JointBox joints = joint_box(machine, open.box);
    Json position = Json::object();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double scale = machine.axes[i].kind == AxisKind::rotary ? 180 / kPi : 1;
        position[machine.axes[i].name] = joints.centre[i] * scale;
    }
    return {{"lines", lines_text(report.path, open)},
            {"first_segment", open.first},
            {"end_segment", open.end},
            {"a", machine.bodies[machine.pairs[task.pair].a].name},
            {"b", machine.bodies[machine.pairs[task.pair].b].name},
            {"tool", task.tool == kNoIndex ? Json(nullptr) : Json(machine.tools[task.tool].number)},
            {"reason", to_text(open.reason)},
            {"position", position},
            {"clearance_mm", open.clearance_mm},
            {"needed_mm", open.needed_mm}};
}

Json name_or_null(const std::string& name) {
    return name.empty() ? Json(nullptr) : Json(name);
}

}  // namespace

std::string describe_certify(const CertifyReport& report) {
    Json open = Json::array();
    for (const OpenStretch& stretch : report.proof.open) {
        open.push_back(describe_open(report, stretch));
    }
    const Json document{{"program", report.program},
                        {"machine", report.machine.name},
                        {"certified", report.proof.open.empty()},
                        {"override_percent", report.override_percent},
                        {"covers_lower_overrides", report.covers_lower},
                        {"promise", to_text(report.machine.guard.promise)},
                        {"seconds", report.path.seconds},
                        {"segments", report.path.segment_count()},
                        {"pairs", report.tasks.tasks.size()},
                        {"boxes", report.proof.boxes},
                        {"queries", report.proof.questions},
                        {"certificate", name_or_null(report.certificate)},
                        {"bytes", report.certificate_bytes},
                        {"model", name_or_null(report.model)},
                        {"model_sha256", report.model_sha256},
                        {"spent_s", report.spent_s},
                        {"open", open}};
    return text_of(document);
}

}  // namespace axg
