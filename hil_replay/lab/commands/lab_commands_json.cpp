// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/commands/lab_commands_json.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "firmware_if/cli/document_json.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

std::string_view format_scalar(lab::Scalar scalar) {
    switch (scalar) {
        case lab::Scalar::f32:
            return "float";
        case lab::Scalar::f64:
            return "double";
        case lab::Scalar::f32_then_f64:
            return "float, then double";
        case lab::Scalar::exact:
            break;
    }
    return "exact";
}

Json description_of(const lab::Method& method) {
    return {{"name", method.name},
            {"source", method.source},
            {"arithmetic", format_scalar(method.scalar)},
            {"certified", method.certified},
            {"distance", method.gives_distance},
            {"fused", method.fused}};
}

}  // namespace

std::string describe_methods() {
    Json out{{"methods", Json::array()}};
    for (const lab::Method& method : lab::methods()) {
        out["methods"].push_back(description_of(method));
    }
    return text_of(out);
}

std::string describe_times(const TimedMethods& times) {
    Json out{{"pairs", times.pairs}, {"passes", times.passes}, {"methods", Json::array()}};
    for (std::size_t i = 0; i < times.methods.size(); ++i) {
        out["methods"].push_back({{"name", times.methods[i]->name},
                                  {"overlap_ns", times.overlapping[i].least_ns},
                                  {"overlap_ns_median", times.overlapping[i].median_ns},
                                  {"hit_ns", times.intersecting[i].least_ns},
                                  {"hit_ns_median", times.intersecting[i].median_ns}});
    }
    return text_of(out);
}

std::string describe_accuracy(const std::string& cases, const lab::Method& method,
                              std::size_t count, const AccuracyCounts& counts) {
    return text_of({{"cases", cases},
                    {"method", description_of(method)},
                    {"count", count},
                    {"separated", counts.separated},
                    {"intersecting", counts.intersecting},
                    {"undecided", counts.undecided},
                    {"rejected", counts.rejected}});
}

std::string describe_chart(const ChartDocument& chart) {
    Json out{{"seed", chart.seed}, {"quick", chart.is_quick}, {"figures", Json::array()}};
    for (const ChartDocument::Entry& entry : chart.figures) {
        Json figure{{"figure", entry.figure}, {"drawn", entry.is_drawn}};
        const Json measured = entry.summary.empty() ? Json() : Json::parse(entry.summary);
        if (!measured.is_null()) {
            figure["measured"] = measured;
        }
        out["figures"].push_back(std::move(figure));
    }
    return text_of(out);
}

std::string describe_queries(const QueryReport& report) {
    Json out{{"poses", report.poses},
             {"pairs", report.pairs},
             {"engine", report.engine},
             {"lanes", report.lanes},
             {"ask", report.kind},
             {"hits", report.hits},
             {"contained", report.contained},
             {"over_capacity", report.over_capacity}};
    if (report.passes != 0) {
        out["passes"] = report.passes;
        out["cycle_us"] = {{"median", report.cycle_us_median},
                           {"p99", report.cycle_us_p99},
                           {"max", report.cycle_us_max}};
    }
    return text_of(out);
}

}  // namespace axg
