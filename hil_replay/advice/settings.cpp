// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/machine/parse_machine.hpp"
#include "core/reach/stop_limits.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "hil_replay/replay/limit_table.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kMoreWork = 4;  // queries and lists of a larger plan, in times
constexpr std::uint32_t kAheadRound = 50, kAheadMost = 1024;

bool may_limit_jerk(const Machine& machine) {
    return !machine.guard.free_jerk_limited &&
           std::all_of(machine.axes.begin(), machine.axes.end(), has_jerk_limit);
}

bool is_on_path(const Machine& machine, const UnprovenPair& pair, std::uint32_t axis) {
    const auto begin = pair.task.path.body.begin();
    return std::any_of(begin, begin + pair.task.path.count,
                       [&](std::uint32_t body) { return machine.bodies[body].joint.axis == axis; });
}

std::string axis_line(const Axis& axis, const std::string& keys) {
    return fmt::format("axes: {{{}: {{{}}}}}", axis.name, keys);
}

/// Limits of the pair's axes that are higher than the trace ever came.
Setting shown_limits(const Machine& machine, const UnprovenPair& pair, const LimitSurvey& seen) {
    Setting out;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (!is_on_path(machine, pair, i)) {
            continue;
        }
        const Axis& axis = machine.axes[i];
        const double per_minute = axis.kind == AxisKind::rotary ? 1 : 60;
        const auto keys = proposed_keys(axis, proposed_limits(machine, seen, i));
        std::string text;
        const auto add = [&](const ProposedKey& key, double declared) {
            if (key.value > 0 && key.value < declared) {
                text += fmt::format("{}{}: {:.6g}", text.empty() ? "" : ", ", key.key, key.value);
            }
        };
        add(keys[0], in_axis_units(axis, axis.speed_max) * per_minute);
        add(keys[1], in_axis_units(axis, axis.acceleration_max));
        if (!text.empty()) {
            out.lines.push_back(axis_line(axis, text));
        }
    }
    return out;
}

Setting larger_plan(const Machine& machine) {
    const CycleRules& rules = machine.cycle;
    WorkLists lists;
    for (const WorkListName& one : kWorkLists) {
        lists.*one.list = kMoreWork * rules.lists.*one.list;
    }
    return {.lines = {fmt::format("cycle: {{stages: {}, queries: {}, lists: {{{}}}}}", rules.stages,
                                  kMoreWork * rules.queries, format_lists(lists))}};
}

/// Half of the largest speed of the pair's axis that is nearest to its own.
std::optional<Setting> half_speed(const Machine& machine, const UnprovenPair& pair) {
    std::uint32_t fastest = kNoIndex;
    double most = 0;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const double speed = 0.5 * std::fabs(pair.now[i].speed_low + pair.now[i].speed_high);
        const double share = speed / machine.axes[i].speed_max;
        if (is_on_path(machine, pair, i) && share > most) {
            most = share;
            fastest = i;
        }
    }
    if (fastest == kNoIndex || most < 0.5) {
        return std::nullopt;
    }
    const Axis& axis = machine.axes[fastest];
    const bool is_rotary = axis.kind == AxisKind::rotary;
    return Setting{
        .lines = {axis_line(
            axis, fmt::format("{}: {:.6g}", is_rotary ? "speed_deg_s" : "speed_mm_min",
                              0.5 * in_axis_units(axis, axis.speed_max) * (is_rotary ? 1 : 60)))}};
}

/// Returns the periods of the longest stop of an axis, rounded up; at most kAheadMost.
std::uint32_t ahead_samples(const Machine& machine) {
    double longest_s = 0;
    for (const Axis& axis : machine.axes) {
        longest_s =
            std::max(longest_s, axis.speed_max / axis.stopping_min +
                                    (axis.acceleration_max + axis.stopping_min) / axis.jerk_max);
    }
    longest_s += free_seconds(machine, machine.can.permit_samples.most);
    const double samples = longest_s / (machine.can.sample_us * 1e-6);
    return std::min(kAheadMost,
                    kAheadRound * static_cast<std::uint32_t>(std::ceil(samples / kAheadRound)));
}

}  // namespace

std::vector<Setting> settings_of_trace(const Machine& machine, const UnprovenPair& pair,
                                       const LimitSurvey& seen) {
    std::vector<Setting> out;
    const auto keeps_jerk = [&](std::size_t i) {
        return seen.axes()[i].jerk.measured <= machine.axes[i].jerk_max;
    };
    bool is_jerk_kept = may_limit_jerk(machine);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        is_jerk_kept = is_jerk_kept && keeps_jerk(i);
    }
    Setting lower = shown_limits(machine, pair, seen);
    if (is_jerk_kept) {
        out.push_back({.lines = {"guard: {free_jerk: limited}"}});
    }
    if (!lower.lines.empty()) {
        out.push_back(lower);
        if (is_jerk_kept) {
            lower.lines.emplace_back("guard: {free_jerk: limited}");
            out.push_back(std::move(lower));
        }
    }
    if (!machine.plan) {
        out.push_back(larger_plan(machine));
    }
    return out;
}

std::vector<Setting> settings_of_board(const Machine& machine, const UnprovenPair& pair) {
    std::vector<Setting> out;
    const bool is_plain = machine.guard.cap == CapPromise::none;
    const bool may_limit = may_limit_jerk(machine);
    if (may_limit) {
        out.push_back({.lines = {"guard: {free_jerk: limited}"}});
    }
    if (std::optional<Setting> slower = half_speed(machine, pair)) {
        out.push_back(std::move(*slower));
    }
    if (is_plain) {
        out.push_back({.lines = {"guard: {cap: per_axis}"}});
        out.push_back({.lines = {"guard: {cap: all_axes}"}});
        if (may_limit) {
            out.push_back({.lines = {"guard: {cap: all_axes, free_jerk: limited}"}});
        }
    }
    if (machine.can.look_ahead_samples == 0) {
        const std::string can =
            fmt::format("can: {{format: fd, ahead: {{samples: {}}}}}", ahead_samples(machine));
        out.push_back({.lines = {can}});
        out.push_back({.lines = {"guard: {promise: path_keeping}", can}});
    }
    return out;
}

std::optional<LoadedMachine> with_setting(const LoadedMachine& loaded,
                                          const std::vector<std::string>& lines) {
    Machine changed;
    if (!parse_changed_machine(loaded.source, lines, changed).empty()) {
        return std::nullopt;
    }
    std::optional<LoadedMachine> out = loaded;
    out->machine.axes = std::move(changed.axes);
    out->machine.guard = changed.guard;
    out->machine.can = std::move(changed.can);
    out->machine.cycle = changed.cycle;
    return out;
}

}  // namespace axg
