// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/admitted_plan_json.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/cli/plan_json.hpp"

namespace axg {

namespace {

using Json = nlohmann::ordered_json;

/// Null where `of` has no such value: a file that a person edited throws nothing.
Json value_at(const Json& of, const char* key) {
    return of.is_object() && of.contains(key) ? of[key] : Json();
}

std::string text_at(const Json& of, const char* key) {
    const Json found = value_at(of, key);
    return found.is_string() ? found.get<std::string>() : "";
}

/// Why the plan in `document` is none for this machine; empty: it is.
std::string refusal_of(const Json& document, const LoadedMachine& loaded) {
    const std::string wanted = configuration_hash(loaded.machine, loaded.meshes);
    if (document.is_discarded() || !document.is_object() || !document.contains("checks")) {
        return "no verdict of axguardd admit. Pass the file BUS.admission.json of its --state-dir";
    }
    if (const std::string found = text_at(document, "configuration_sha256"); found != wanted) {
        return fmt::format(
            "the verdict is about another machine file (configuration {:.12}, this one has "
            "{:.12}). Use the guard's machine file, or run axguardd admit with this one",
            escaped(found), wanted);
    }
    if (text_at(document, "mode") != "stoppable") {
        return "the verdict is about contact mode, which has no plan. Run axguardd admit with "
               "--mode stoppable";
    }
    return "";
}

}  // namespace

std::optional<AdmittedPlan> read_admitted_plan(const std::string& path, const LoadedMachine& loaded,
                                               std::string& fault) {
    std::ifstream file(path);
    const Json document = file ? Json::parse(file, nullptr, false) : Json(Json::value_t::discarded);
    fault = refusal_of(document, loaded);
    AdmittedPlan out;
    const std::optional<CyclePlan> plan = fault.empty() && document.contains("plan")
                                              ? plan_from_json(document["plan"])
                                              : std::nullopt;
    if (fault.empty() && (!plan || plan->queries[0] < kQueriesAPair * stop_tasks(loaded.machine))) {
        fault = "the verdict has no plan for this machine. Run axguardd admit of this version";
    }
    if (!fault.empty()) {
        fault = fmt::format("{}: {}.", escaped(path, 4096), fault);
        return std::nullopt;
    }
    out.plan = *plan;
    out.is_fit = value_at(document, "fit") == true;
    out.host = text_at(document, "host");
    out.date = text_at(document, "date");
    const Json cycles = value_at(value_at(document, "figures"), "cycles");
    const Json longest_us = value_at(cycles, "fill_us");
    out.engine = text_at(cycles, "engine");
    out.longest_us = longest_us.is_number() ? longest_us.get<double>() : 0;
    return out;
}

bool is_within(const CyclePlan& small, const CyclePlan& large) noexcept {
    bool is_less = small.stages == large.stages && small.form == large.form &&
                   small.depth_max <= large.depth_max;
    for (std::uint32_t stage = 0; stage < kStagesMax; ++stage) {
        const WorkLists &a = small.lists[stage], &b = large.lists[stage];
        is_less = is_less && small.queries[stage] <= large.queries[stage] &&
                  a.node_pairs <= b.node_pairs && a.leaf_pairs <= b.leaf_pairs &&
                  a.box_rows <= b.box_rows && a.triangle_pairs <= b.triangle_pairs &&
                  a.rechecks <= b.rechecks;
    }
    return is_less;
}

}  // namespace axg
