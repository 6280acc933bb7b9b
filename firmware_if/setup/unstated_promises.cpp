// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/unstated_promises.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "core/base/sincos.hpp"
#include "core/reach/stop_limits.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {
namespace {

// Values that promise less; not measured.
constexpr double kReactionTimes = 2;   // of the default
constexpr double kPositionTimes = 10;  // of the default
constexpr double kJitterShare = 0.1;   // of a period
constexpr double kTimerShare = 0.05;   // that nobody compares with another timer

using Edit = std::function<void(Machine&, std::uint32_t axis)>;

/// How far a stop from rapid leads at most beyond the position of its sample.
double reach_at_rapid(const Machine& machine, std::uint32_t axis) {
    const double fastest = machine.axes[axis].speed_max;
    const double free_s = free_seconds(machine, machine.can.permit_samples.least);
    return sample_errors(machine, axis, 0).position +
           forward_reach(stop_limits(machine, axis), fastest, fastest, free_s);
}

/// Reach of an axis that reverses in a stop: at its largest acceleration from the reversal on.
double reach_of_turn(const Machine& machine, std::uint32_t axis) {
    AxisLimits limits = stop_limits(machine, axis);
    limits.stop_turns_round = true;
    return forward_reach(limits, 0, 0, 0, limits.acceleration_max);
}

/// The part of a machine that a reach depends on.
Machine promises_of(const Machine& machine) {
    Machine out;
    out.axes = machine.axes;
    out.can = machine.can;
    out.guard = machine.guard;
    return out;
}

class PromiseList {
  public:
    explicit PromiseList(const Machine& machine) : machine_(machine) {}

    template <class Cost>
    void add(UnstatedPromise promise, Cost cost) {
        bool has_linear = false;
        for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
            const bool is_linear = machine_.axes[i].kind == AxisKind::linear;
            const double one = cost(i);
            const bool is_more =
                is_linear == has_linear ? one > promise.cost : is_linear && one > 0;
            if (is_more) {
                promise.axis = i;
                promise.cost = one;
                has_linear = is_linear;
            }
        }
        if (promise.cost > 0) {
            const bool is_rotary = machine_.axes[promise.axis].kind == AxisKind::rotary;
            promise.cost *= is_rotary ? 180 / kPi : 1;
            out_.push_back(std::move(promise));
        }
    }
    /// With the machine as the edit makes it.
    void add_edited(UnstatedPromise promise, const Edit& edit) {
        const Machine stated = promises_of(machine_);
        add(std::move(promise), [&](std::uint32_t axis) {
            Machine cautious = stated;
            edit(cautious, axis);
            return reach_at_rapid(cautious, axis) - reach_at_rapid(stated, axis);
        });
    }
    [[nodiscard]] std::vector<UnstatedPromise> take() { return std::move(out_); }

  private:
    const Machine& machine_;
    std::vector<UnstatedPromise> out_;
};

std::string ends_text(ValueAge age) {
    return age.least_us == age.most_us ? fmt::format("{}", age.most_us)
                                       : fmt::format("[{}, {}]", age.least_us, age.most_us);
}

void add_guard(const Machine& machine, PromiseList& list) {
    const GuardRules& guard = machine.guard;
    if (!machine.states.stop_reversal && guard.stop_reversal == StopReversal::none) {
        list.add({.key = "guard.stop_reversal", .assumed = "none", .cautious = "jerk_limited"},
                 [&](std::uint32_t axis) { return reach_of_turn(machine, axis); });
    }
    if (!machine.states.board_reaction_ms) {
        const double longer_s = kReactionTimes * guard.board_reaction_s;
        list.add_edited(
            {.key = "guard.board_reaction_ms",
             .assumed = fmt::format("{:.4g}", guard.board_reaction_s * 1e3),
             .cautious = fmt::format("{:.4g}", longer_s * 1e3)},
            [longer_s](Machine& m, std::uint32_t) { m.guard.board_reaction_s = longer_s; });
    }
    const double jitter_s = kJitterShare * machine.can.sample_us * 1e-6;
    if (!machine.states.latch_jitter_us && jitter_s > guard.latch_jitter_s) {
        list.add_edited(
            {.key = "guard.latch_jitter_us",
             .assumed = fmt::format("{:.4g}", guard.latch_jitter_s * 1e6),
             .cautious = fmt::format("{:.4g}", jitter_s * 1e6)},
            [jitter_s](Machine& m, std::uint32_t) { m.guard.latch_jitter_s = jitter_s; });
    }
}

void add_can(const Machine& machine, PromiseList& list) {
    const ValueAge before{0, machine.can.sample_us};
    if (!machine.states.latched_age_us && machine.can.latched_age.most_us < before.most_us) {
        list.add_edited({.key = "can.latched_age_us",
                         .assumed = ends_text(machine.can.latched_age),
                         .cautious = ends_text(before)},
                        [before](Machine& m, std::uint32_t) { m.can.latched_age = before; });
    }
    // SYNC is this computer's own clock, and no frame shows the timer that ends the permit.
    if (machine.can.guard_sends_sync) {
        list.add_edited({.key = "can.sample_us",
                         .assumed = fmt::format("{} to {:.0f} % on the board's timer",
                                                machine.can.sample_us, kPeriodShare * 100),
                         .cautious = fmt::format("{:.0f} %", kTimerShare * 100)},
                        [](Machine& m, std::uint32_t) {
                            const double share = (1 + kTimerShare) / (1 + kPeriodShare);
                            m.can.sample_us = static_cast<std::uint32_t>(m.can.sample_us * share);
                        });
    }
}

void add_axes(const Machine& machine, PromiseList& list) {
    const auto states_all = [&machine](bool Axis::*stated) {
        return std::all_of(machine.axes.begin(), machine.axes.end(),
                           [stated](const Axis& axis) { return axis.*stated; });
    };
    if (!states_all(&Axis::states_position_error)) {
        list.add_edited({.key = "position_error_...",
                         .assumed = "0.001 mm, 0.0005 deg",
                         .cautious = fmt::format("{:.0f} times that", kPositionTimes)},
                        [](Machine& m, std::uint32_t axis) {
                            Axis& of = m.axes[axis];
                            of.position_error *= of.states_position_error ? 1 : kPositionTimes;
                        });
    }
    if (!states_all(&Axis::states_following_error)) {
        list.add_edited(
            {.key = "following_error_...", .assumed = "0", .cautious = "the way of one period"},
            [](Machine& m, std::uint32_t axis) {
                Axis& of = m.axes[axis];
                const double way = of.speed_max * m.can.sample_us * 1e-6;
                of.following_error = of.states_following_error ? of.following_error : way;
            });
    }
}

}  // namespace

std::vector<UnstatedPromise> unstated_promises(const Machine& machine) {
    PromiseList list(machine);
    add_guard(machine, list);
    add_can(machine, list);
    add_axes(machine, list);
    return list.take();
}

std::string format_promise(const Machine& machine, const UnstatedPromise& promise) {
    const Axis& axis = machine.axes[promise.axis];
    return fmt::format("{}: {} assumed; with {} {} stops {:.3g} {} later", promise.key,
                       promise.assumed, promise.cautious, axis.name, promise.cost,
                       axis.kind == AxisKind::rotary ? "deg" : "mm");
}

}  // namespace axg
