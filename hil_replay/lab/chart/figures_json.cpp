// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/figures_json.hpp"

#include <nlohmann/json.hpp>

namespace axg::chart {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& summary) {
    return summary.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json summary_of(const std::vector<MethodScore>& scores) {
    Json methods = Json::array();
    for (const MethodScore& m : scores) {
        const Score& s = m.machine;
        methods.push_back({{"method", m.name},
                           {"certified", m.is_certified},
                           {"fused", m.is_fused},
                           {"intersecting", s.intersecting},
                           {"apart", s.apart},
                           {"missed", s.missed},
                           {"deepest_missed_um", s.deepest_missed_um},
                           {"false_hits", s.false_hits},
                           {"false_hits_beyond_1_um", s.far_false_hits},
                           {"undecided_hits", s.undecided_hits},
                           {"undecided_apart", s.undecided_apart},
                           {"widest_undecided_um", s.widest_undecided_um},
                           {"time_touching_ns", m.ns_touching},
                           {"time_apart_ns", m.ns_apart}});
    }
    return methods;
}

}  // namespace

std::string describe_methods(const std::vector<MethodScore>& scores, unsigned passes,
                             const std::string& processor) {
    const Score& any = scores.front().machine;
    return text_of({{"pairs", any.intersecting + any.apart},
                    {"passes", passes},
                    {"processor", processor},
                    {"methods", summary_of(scores)}});
}

std::string describe_clearance_errors(const std::vector<ClearanceErrors>& methods) {
    Json out;
    for (const ClearanceErrors& m : methods) {
        out["methods"].push_back({{"method", m.method},
                                  {"certified", m.is_certified},
                                  {"clearances", m.count},
                                  {"above_the_distance", m.above},
                                  {"most_above_um", m.most_above_um},
                                  {"most_below_um", m.most_below_um}});
    }
    return text_of(out);
}

std::string describe_flips(const std::vector<FlipTotals>& methods, std::size_t pairs,
                           std::size_t orders) {
    Json out;
    for (const FlipTotals& m : methods) {
        out["methods"].push_back({{"method", m.method},
                                  {"certified", m.is_certified},
                                  {"differing", m.differing},
                                  {"separated_though_touching", m.wrong}});
    }
    out["pairs"] = pairs;
    out["orders"] = orders;
    return text_of(out);
}

std::string describe_rechecks(std::uint32_t capacity, const std::vector<RecheckNeeds>& families) {
    Json out{{"capacity", capacity}};
    for (const RecheckNeeds& f : families) {
        out["families"][f.family] = {{"cycles", f.cycles},
                                     {"most_rechecks", f.rechecks},
                                     {"over_capacity", f.over_capacity},
                                     {"pair", f.pair},
                                     {"axes", f.axes}};
    }
    return text_of(out);
}

std::string describe_undecided_gaps(const std::vector<UndecidedGap>& curves) {
    Json out;
    for (const UndecidedGap& curve : curves) {
        out["curves"].push_back({{"method", curve.method},
                                 {"aspect", curve.aspect},
                                 {"pairs", curve.pairs},
                                 {"widest_undecided_um", curve.widest_undecided_um}});
    }
    return text_of(out);
}

}  // namespace axg::chart
