// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/why_stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "hil_replay/replay/limit_table.hpp"

namespace axg {
namespace {

using Limits = std::array<AxisLimits, kAxesMax>;

/// Limits of the pair's axes that the trace shows, if lower than the declared ones.
struct ShownLimits {
    Limits limits;
    std::string text;  // empty: none is less
};

/// A limit of the motion, in the axis' units, lowered to `shown`; 0: the trace shows none.
void lower(double& limit, double shown, const Axis& axis, LimitFigure figure, const char* name,
           std::string& text) {
    if (shown > 0 && shown < limit) {
        text += fmt::format(
            "{}{} {} {:.4g} of {} {}", text.empty() ? "" : ", ", axis.name, name,
            in_axis_units(axis, shown),
            limit < kNoJerkLimit ? fmt::format("{:.4g}", in_axis_units(axis, limit)) : "unlimited",
            unit_of(axis, figure));
        limit = shown;
    }
}

ShownLimits shown_limits(const WhySources& sources, const UnprovenPair& pair) {
    const Machine& machine = sources.loaded.machine;
    ShownLimits out{.limits = pair.limits, .text = {}};
    for (std::uint32_t i = 0; sources.limits != nullptr && i < machine.axes.size(); ++i) {
        const auto begin = pair.task.path.body.begin();
        const bool is_on_path =
            std::any_of(begin, begin + pair.task.path.count,
                        [&](std::uint32_t body) { return machine.bodies[body].joint.axis == i; });
        const Axis& axis = machine.axes[i];
        const bool is_rotary = axis.kind == AxisKind::rotary;
        const double unit = is_rotary ? kPi / 180.0 : 1.0;
        const ProposedLimits shown = proposed_limits(machine, *sources.limits, i);
        AxisLimits& limits = out.limits[i];
        if (!is_on_path) {
            continue;
        }
        lower(limits.speed_max, shown.speed * unit / (is_rotary ? 1 : 60), axis, LimitFigure::speed,
              "speed", out.text);
        lower(limits.acceleration_max, shown.acceleration * unit, axis, LimitFigure::acceleration,
              "acceleration", out.text);
        lower(limits.jerk_max, shown.is_jerk_unlimited ? 0 : shown.jerk * unit, axis,
              LimitFigure::jerk, "jerk", out.text);
        if (shown.stopping * unit > limits.stopping_min) {
            out.text += fmt::format("{}{} stopping {:.4g} in place of {:.4g} {}",
                                    out.text.empty() ? "" : ", ", axis.name, shown.stopping,
                                    in_axis_units(axis, limits.stopping_min),
                                    unit_of(axis, LimitFigure::acceleration));
            limits.stopping_min = shown.stopping * unit;
        }
    }
    return out;
}

WhyCause cause_of(const StopWhy& why) {
    if (why.worst_mm <= why.need.margin_mm) {
        return WhyCause::reach;
    }
    if (why.is_list_full) {
        return WhyCause::capacity;
    }
    if (why.remedies.is_alone) {
        return WhyCause::shared;
    }
    return why.remedies.queries ? WhyCause::halving : WhyCause::not_proven;
}

/// Explains a stop at the sampled pose only: in contact mode, or if one body is inside the other.
StopWhy why_at_pose(const WhySources& sources, const StopFacts& stop) {
    const Machine& machine = sources.loaded.machine;
    StopWhy why;
    why.pair = stop.pair;
    why.within_mm = kClearanceWithinMm;
    why.cause = stop.reason == StopReason::contained  ? WhyCause::contained
                : stop.reason == StopReason::capacity ? WhyCause::capacity
                                                      : WhyCause::margin;
    why.is_list_full = why.cause == WhyCause::capacity;
    const auto room = std::make_unique<PairQueries>();
    std::optional<Query> query = pose_query(machine, stop.snapshot, stop.pair, *room);
    if (!query) {
        return why;
    }
    const PairDistances distances = pose_distances(sources.engine, *query);
    why.need = distances.need;
    why.within_mm = distances.within_mm;
    why.available_mm = why.worst_mm = distances.available_mm;
    query->kind = QueryKind::farther;
    query->r_mm = std::floor(why.available_mm * 1e3) * 1e-3;
    if (query->r_mm > 0 && query->r_mm < why.need.margin_mm) {
        QueryResult result;
        sources.engine({&*query, 1}, {&result, 1});
        if (result.status == QueryStatus::ok && result.proof == Proof::far) {
            why.remedies.margin_mm = query->r_mm;
        }
    }
    return why;
}

void add_reach(const WhySources& sources, const UnprovenPair& pair, StopWhy& why) {
    const Machine& machine = sources.loaded.machine;
    const SurfaceList surfaces = surface_list(sources.loaded);
    why.has_reach = true;
    why.reach = pair.task.box;
    const auto add = [&](std::uint32_t body, const Pose& at) {
        const bool is_tool = machine.bodies[body].is_tool;
        if (is_tool && pair.tool == kNoIndex) {
            return;
        }
        const Mesh& mesh = is_tool ? *surfaces.tools()[pair.tool] : *surfaces.bodies()[body];
        ReachBody reach = reach_body(machine, body, at, extent_of(mesh), pair.task.box);
        const double deviation_mm = deviation_of(machine, body, pair.tool);
        const Vec3d wider{deviation_mm, deviation_mm, deviation_mm};
        reach.low_mm = reach.low_mm - wider;
        reach.high_mm = reach.high_mm + wider;
        why.bodies.push_back(reach);
    };
    add(pair.task.body_a, pair.task.at_a);
    add(pair.task.body_b, pair.task.at_b);
}

}  // namespace

std::optional<StopWhy> why_of(const WhySources& sources, const StopFacts& stop) {
    const bool is_about_pair = stop.reason == StopReason::contact ||
                               stop.reason == StopReason::contained ||
                               stop.reason == StopReason::capacity;
    if (stop.pair == kNoIndex || (!is_about_pair && stop.reason != StopReason::predicted)) {
        return std::nullopt;
    }
    if (!stop.unproven.is_known) {
        return is_about_pair ? std::optional<StopWhy>(why_at_pose(sources, stop)) : std::nullopt;
    }
    const Machine& machine = sources.loaded.machine;
    const UnprovenPair& pair = stop.unproven;
    const Engine& engine = sources.engine;
    StopWhy why;
    why.pair = stop.pair;
    why.tool = pair.tool;
    why.is_whole = pair.is_whole;
    why.is_jog = pair.is_jog;
    if (pair.is_blind) {
        why.cause = WhyCause::not_known;
        return why;
    }
    const PairDistances distances = pair_distances(machine, engine, pair);
    why.need = distances.need;
    why.within_mm = distances.within_mm;
    why.available_mm = distances.available_mm;
    why.open = distances.open;
    why.whole = whole_demand(machine, engine, pair);
    why.is_list_full = is_overflow(pair.result.status);
    why.full = pair.result.status;
    why.queries = pair.result.queries;
    why.worst_mm = least_clearance_mm(machine, engine, pair, why.within_mm);
    const ShownLimits shown = shown_limits(sources, pair);
    why.remedies = find_remedies(machine, engine, pair,
                                 {.tries_plans = why.worst_mm > why.need.margin_mm,
                                  .limits = shown.text.empty() ? nullptr : &shown.limits});
    why.other_limits = why.remedies.are_other_limits ? shown.text : "";
    why.cause = cause_of(why);
    add_reach(sources, pair, why);
    return why;
}

}  // namespace axg
