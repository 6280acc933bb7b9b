// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/stop_cause_json.hpp"

#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/cli/plan_json.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json remedies_json(const StopWhy& why) {
    const NeedRemedies& remedies = why.remedies;
    Json out = Json::object();
    if (remedies.is_alone) {
        out["alone"] = true;
    }
    if (remedies.speed_share) {
        out["speed_share"] = *remedies.speed_share;
    }
    if (remedies.margin_mm) {
        out["margin_mm"] = *remedies.margin_mm;
    }
    if (remedies.queries) {
        out["queries"] = *remedies.queries;
    }
    if (remedies.are_other_limits) {
        out["limits"] = why.other_limits;
    }
    return out;
}

Json advice_json(const Advice& advice) {
    Json settings = Json::array();
    for (const AdvisedSetting& setting : advice.settings) {
        Json one{
            {"lines", setting.lines}, {"driven", setting.is_driven}, {"gone", setting.is_gone}};
        if (setting.is_gone) {
            one["after_s"] = setting.after_s;
        } else {
            one["left_mm"] = setting.left_mm;
            one["gain_mm"] = setting.gain_mm;
        }
        settings.push_back(std::move(one));
    }
    return {
        {"tried", advice.tried}, {"driven", advice.was_driven}, {"settings", std::move(settings)}};
}

Json vector_json(Vec3d v) {
    return {v.x, v.y, v.z};
}

void add_reach(const Machine& machine, const StopWhy& why, Json& out) {
    Json& axes = out["reach"] = Json::object();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const bool is_rotary = machine.axes[i].kind == AxisKind::rotary;
        const double unit = is_rotary ? 180.0 / kPi : 1.0;
        const double centre = why.reach.centre[i], half = why.reach.half[i];
        axes[machine.axes[i].name + (is_rotary ? "_deg" : "_mm")] = {(centre - half) * unit,
                                                                     (centre + half) * unit};
    }
    Json& bodies = out["reach_bodies"] = Json::array();
    for (const ReachBody& body : why.bodies) {
        Json rows = Json::array();
        for (int i = 0; i < 3; ++i) {
            const Pose& p = body.placed;
            rows.push_back({p.r[i][0], p.r[i][1], p.r[i][2], p.t[i]});
        }
        bodies.push_back({{"body", machine.bodies[body.body].name},
                          {"moves_mm", body.moves_mm},
                          {"low_mm", vector_json(body.low_mm)},
                          {"high_mm", vector_json(body.high_mm)},
                          {"placed", std::move(rows)}});
    }
}

Json limit_json(const LimitFact& fact, const Machine& machine) {
    const Axis& axis = machine.axes[fact.axis];
    Json out{{"kind", to_text(fact.kind)},
             {"axis", axis.name},
             {"measured", in_axis_units(axis, fact.measured)}};
    if (fact.declared > 0) {  // a range has no declared value
        out["declared"] = in_axis_units(axis, fact.declared);
    }
    out["unit"] = unit_of(axis, figure_of(fact.kind));
    return out;
}

}  // namespace

void add_stop_cause(const Machine& machine, StopReason reason, std::uint32_t pair,
                    ReceiverFault fault, const LimitFact& limit, nlohmann::ordered_json& out) {
    if (pair != kNoIndex) {
        out["pair"] = pair_name(machine, pair);
    }
    if (reason == StopReason::input) {
        out["fault"] = fault_row(fault).name;
    }
    if (has_limit(reason)) {
        out["limit"] = limit_json(limit, machine);
    }
}

void add_program_line(const ProgramLines& lines, std::int64_t time_us, Json& out) {
    if (const ProgramStep* step = step_at(lines, time_us)) {
        out["program_line"] = step->line;
        out["program_block"] = step->block;
    }
}

Json why_json(const Machine& machine, const StopWhy& why) {
    const DistanceNeed& need = why.need;
    Json out{{"cause", to_text(why.cause)}, {"pair", pair_name(machine, why.pair)}};
    if (why.tool != kNoIndex) {
        out["tool"] = machine.tools[why.tool].number;
    }
    if (why.cause == WhyCause::contained || why.cause == WhyCause::not_known) {
        return out;
    }
    out.update(Json{{"needed_mm", need.sum_mm()},
                    {"available_mm", why.available_mm},
                    {"within_mm", why.within_mm},
                    {"margin_mm", need.margin_mm},
                    {"arithmetic_mm", need.arithmetic_mm},
                    {"list_full", why.is_list_full}});
    if (const char* const list = full_list(why.full)) {
        out["full_list"] = list;
    }
    if (why.has_reach) {
        out["worst_mm"] = why.worst_mm;
        out["queries"] = why.queries;
        if (why.is_whole) {
            out["to_standstill_mm"] = need.until_braking_mm;
        } else {
            out["until_braking_mm"] = need.until_braking_mm;
            out["braking_mm"] = need.braking_mm;
            out["position_error_mm"] = need.position_error_mm;
            out["speed_uncertainty_mm"] = need.speed_uncertainty_mm;
        }
        if (why.open) {
            out["open"] = {{"needed_mm", why.open->needed_mm},
                           {"available_mm", why.open->available_mm}};
        }
        if (why.whole) {
            out["whole_reach"] = lists_json(*why.whole);
        }
        add_reach(machine, why, out);
    }
    out["remedies"] = remedies_json(why);
    if (why.advice) {
        out["advice"] = advice_json(*why.advice);
    }
    return out;
}

Json page_why_json(const Machine& machine, const StopWhy& why) {
    Json out = why_json(machine, why);
    out["sentences"] = why_sentences(machine, why);
    return out;
}

Json escapes_json(const Machine& machine, const Escapes& escapes) {
    auto out = Json::array();
    for (const EscapeJog& jog : escapes.list()) {
        const bool rotary = machine.axes[jog.axis].kind == AxisKind::rotary;
        out.push_back({{"axis", machine.axes[jog.axis].name},
                       {"direction", jog.is_negative ? "-" : "+"},
                       {rotary ? "step_deg" : "step_mm", step_in_file_units(machine, jog)},
                       {"clearance_mm", jog.clearance_mm}});
    }
    return out;
}

}  // namespace axg
