// SPDX-License-Identifier: Apache-2.0
// Random approaches of the machine of approach_machine.hpp: limits of its axes, the places that it
// begins at and goes for, how its board is told to go, and what happens on the wire. Some are drawn
// for what they bring about. mm.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/certificate/stop_certificate.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "tests/support/approach_machine.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/lazy_motion.hpp"
#include "tests/support/look_ahead_machine.hpp"
#include "tests/support/wild_wire.hpp"

namespace axg::test {

/// Which approaches are drawn.
enum class Aim : std::uint8_t {
    any,       // all of these but the last, and half of them none
    straight,  // along one axis at its largest speed, until the guard falls silent
    crawl,     // near, slowed down, and let go again and again
    turn,      // some axes begin to move on the way
    tool,      // the long tool leaves on the way down, and the guard falls silent soon after
    let_go,    // as crawl, nearer, and the guard falls silent when it says stop
    announce,  // a cap, of a board with a look-ahead path
};

struct WildApproach {
    Approach approach;
    Positions start{};
    MotionStory story;
    WildFaults faults;
    std::uint64_t seed = 0;
    double raise = 0;  // share of cycles in which the order is raised, whatever the law says
    std::int64_t response_us = 0;
    bool is_clear = false;  // it goes for a place where nothing is
    int reacts_ticks = 0;   // of the ablation
};

inline constexpr double kTickS = 1e-3;

inline void draw_limits(Dice& dice, Machine& machine) {
    for (Axis& axis : machine.axes) {
        axis.speed_max = dice.in(50, 700);
        axis.acceleration_max = dice.in(1000, 10'000);
        axis.jerk_max = dice.magnitude(2e4, 2e5);
        axis.stopping_min = axis.acceleration_max * dice.in(0.5, 1);
    }
    machine.guard.board_reaction_s = dice.in(0.2e-3, 3e-3);
    machine.guard.free_jerk_limited = dice.chance(0.5);
    CanLayout& can = machine.can;
    can.format = dice.chance(0.5) ? CanFormat::fd : CanFormat::classical;
    can.sample_us = dice.chance(0.8) ? 1000 : 2000;
    const double most = can.format == CanFormat::fd ? 16 : 13;
    can.permit_samples.least = static_cast<std::uint8_t>(dice.chance(0.5) ? 3 : dice.in(3, 9));
    can.permit_samples.most = static_cast<std::uint8_t>(dice.in(can.permit_samples.least, most));
    const std::uint32_t least = 3;
    can.stale_after_us = can.sample_us * std::max<std::uint32_t>(least, can.permit_samples.most);
    const double kind = dice.in(0, 1);
    machine.guard.cap = kind < 0.2   ? CapPromise::none
                        : kind < 0.6 ? CapPromise::all_axes
                                     : CapPromise::per_axis;
}

/// About what is not proven at rest, for the shortest permit.
inline double standing_mm(const Machine& machine) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Axis& axis = machine.axes[i];
        const double a = axis.acceleration_max;
        const double free_s = free_seconds(machine, machine.can.permit_samples.least);
        const double jerk_s =
            machine.guard.free_jerk_limited ? std::min(1.0, axis.jerk_max * free_s / a) : 1;
        const double v = std::min(axis.speed_max, a * free_s * jerk_s);
        most += 0.5 * v * free_s + v * v / (2 * axis.stopping_min) + v * a / axis.jerk_max;
    }
    return most;
}

inline Positions random_place(Dice& dice) {
    Positions at{};
    at[0] = dice.in(-90, 70);
    at[1] = dice.in(-90, 90);
    at[2] = dice.in(-9, 120);
    return at;
}
inline Positions place(Dice& dice, bool touches) {
    for (int i = 0; i < 10'000; ++i) {
        const Positions at = random_place(dice);
        if ((gap_mm(kLongTool, at) <= 0) == touches) {
            return at;
        }
    }
    return {};
}

/// On the way from a place that is clear to one that touches, so far from contact.
inline Positions place_near(Dice& dice, const Positions& touching, double clear_mm) {
    const Positions clear = place(dice, false);
    double low = 0, high = 1;
    Positions at = clear;
    for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        for (std::size_t i = 0; i < 3; ++i) {
            at[i] = touching[i] + (clear[i] - touching[i]) * middle;
        }
        (gap_mm(kLongTool, at) >= clear_mm ? high : low) = middle;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        at[i] = touching[i] + (clear[i] - touching[i]) * high;
    }
    return at;
}

/// Along one axis, and back from there so far that it is clear.
inline Positions place_along(const Positions& touching, std::size_t axis, double way,
                             double clear_mm) {
    Positions at = touching;
    for (int k = 0; k < 2000 && gap_mm(kLongTool, at) < clear_mm; ++k) {
        at[axis] += way * std::max(0.05, clear_mm - gap_mm(kLongTool, at));
    }
    return at;
}

inline WildFaults draw_faults(Dice& dice, const Machine& machine) {
    const auto period_us = static_cast<double>(machine.can.sample_us);
    const double n = machine.can.permit_samples.most;
    WildFaults faults;
    faults.lost = dice.chance(0.4) ? dice.magnitude(0.002, 0.2) : 0;
    faults.permit_lost = dice.chance(0.3) ? dice.in(0, 0.2) : 0;
    faults.late = dice.chance(0.4) ? dice.in(0, 0.5) : 0;
    faults.twice = dice.chance(0.2) ? dice.in(0, 0.2) : 0;
    faults.late_us_max = static_cast<std::int64_t>(dice.in(0.2, 1.5 * n) * period_us);
    if (dice.chance(0.1)) {
        faults.held_from_us = static_cast<std::int64_t>(dice.in(5e3, 150e3));
        faults.held_until_us =
            faults.held_from_us + static_cast<std::int64_t>(dice.in(1, 1.5 * n) * period_us);
    }
    const double silence = dice.in(0, 1);
    faults.silence = silence < 0.25  ? Silence::at_stop
                     : silence < 0.4 ? Silence::at_instant
                     : silence < 0.5 ? Silence::at_shorter
                     : silence < 0.6 ? Silence::at_lower
                                     : Silence::never;
    faults.silent_from_us = static_cast<std::int64_t>(dice.in(10e3, 150e3));
    return faults;
}

/// Of one axis at its largest speed boxes leave little room.
inline void draw_fast(Dice& dice, Machine& machine) {
    for (Axis& axis : machine.axes) {
        axis.speed_max = dice.in(150, 600);
    }
    machine.guard.cap = dice.chance(0.6) ? CapPromise::none : machine.guard.cap;
}

/// Of slow axes that may speed up again: their jerk lets them, and the box knows it.
inline void draw_slow(Dice& dice, Machine& machine) {
    for (Axis& axis : machine.axes) {
        axis.acceleration_max = dice.in(3000, 10'000);
        axis.stopping_min = axis.acceleration_max * dice.in(0.5, 1);
        axis.jerk_max = dice.in(1e5, 2e5);
    }
    machine.guard.free_jerk_limited = true;
    machine.can.sample_us = 1000;
    machine.can.permit_samples = {3, static_cast<std::uint8_t>(dice.in(10, 13))};
    machine.can.stale_after_us = 1000U * machine.can.permit_samples.most;
    if (machine.guard.cap == CapPromise::none) {
        machine.guard.cap = dice.chance(0.5) ? CapPromise::all_axes : CapPromise::per_axis;
    }
}

inline void draw_let_go(Dice& dice, Machine& machine) {
    draw_slow(dice, machine);
    for (Axis& axis : machine.axes) {
        axis.speed_max = dice.in(100, 500);
        axis.acceleration_max = dice.in(6000, 10'000);
        axis.stopping_min = axis.acceleration_max * dice.in(0.5, 1);
        axis.jerk_max = dice.in(2e5, 4e5);
    }
    machine.guard.board_reaction_s = dice.in(0.2e-3, 0.8e-3);
    machine.can.permit_samples = {3, 12};
    machine.can.stale_after_us = 12'000;
}

/// Permits as different as they may be.
inline void draw_for_tool(Dice& dice, Machine& machine) {
    draw_fast(dice, machine);
    machine.guard.cap = CapPromise::none;
    machine.can.format = CanFormat::fd;
    machine.can.permit_samples = {3, static_cast<std::uint8_t>(dice.in(10, 16))};
    machine.can.stale_after_us = machine.can.sample_us * machine.can.permit_samples.most;
}

inline void draw_limits_for(Dice& dice, Aim aim, Machine& machine) {
    draw_limits(dice, machine);
    switch (aim) {
        case Aim::any:
            break;
        case Aim::straight:
            draw_fast(dice, machine);
            break;
        case Aim::crawl:
            draw_slow(dice, machine);
            break;
        case Aim::turn:
            machine.guard.cap = CapPromise::per_axis;
            break;
        case Aim::let_go:
            draw_let_go(dice, machine);
            break;
        case Aim::tool:
            draw_for_tool(dice, machine);
            break;
        case Aim::announce:
            machine.guard.cap = dice.chance(0.5) ? CapPromise::all_axes : CapPromise::per_axis;
            break;
    }
}

/// Until the guard falls silent, where that is worst.
inline void draw_straight(Dice& dice, WildApproach& out) {
    out.approach.speed_share.fill(1);
    out.raise = 0;
    WildFaults& faults = out.faults;
    faults.lost = faults.permit_lost = faults.late = faults.twice = 0;
    faults.held_from_us = INT64_MAX;
    const double silence = dice.in(0, 1);
    faults.silence = silence < 0.5   ? Silence::at_stop
                     : silence < 0.9 ? Silence::at_shorter
                                     : Silence::at_lower;
}

/// Slowed down near the plate, and let go again and again.
inline void draw_crawl(Dice& dice, WildApproach& out) {
    out.raise = dice.magnitude(0.02, 0.3);
    out.story.lazy_ticks = static_cast<std::size_t>(dice.in(0, 40));
    out.approach.speed_share.fill(1);
    WildFaults& faults = out.faults;
    faults.lost = 0;
    faults.permit_lost = dice.chance(0.5) ? dice.in(0, 0.3) : 0;
    faults.late = dice.chance(0.5) ? dice.in(0, 0.5) : 0;
    faults.silence = dice.chance(0.7)   ? Silence::at_stop
                     : dice.chance(0.5) ? Silence::at_shorter
                                        : Silence::at_instant;
}

/// The long tool leaves on the way down, and the guard falls silent soon after it may forget it.
inline void draw_tool(Dice& dice, const Machine& machine, double way_mm, WildApproach& out) {
    draw_straight(dice, out);
    const double ms = way_mm / machine.axes[2].speed_max * 1e3;
    out.story.next_tool = 2;
    out.story.tool_changes_at = static_cast<int>(dice.in(0, 40 + ms));
    out.story.turn_at = -1;
    const double kept_ms = 1e3 * free_seconds(machine, machine.can.permit_samples.most);
    out.faults.silence = Silence::at_instant;
    out.faults.silent_from_us =
        static_cast<std::int64_t>(1e3 * (out.story.tool_changes_at + kept_ms + dice.in(1, 8)));
}

inline Aim drawn_aim(Dice& dice) {
    const double drawn = dice.in(0, 1);
    return drawn < 0.5    ? Aim::any
           : drawn < 0.7  ? Aim::straight
           : drawn < 0.85 ? Aim::crawl
           : drawn < 0.95 ? Aim::turn
                          : Aim::tool;
}

/// Where it begins and where it goes.
/// @return  how far from contact it begins
inline double draw_way(Dice& dice, const Machine& machine, Aim aim, WildApproach& out) {
    const Positions touching = place(dice, true);
    const double at_rest_mm = (machine.guard.free_jerk_limited ? 1.3 : 3) * standing_mm(machine);
    const double far_mm = aim == Aim::let_go  ? dice.in(0.2, 1.4)
                          : aim == Aim::crawl ? dice.magnitude(0.3, 3)
                                              : at_rest_mm + dice.magnitude(0.3, 40);
    out.is_clear = aim == Aim::any && dice.chance(0.15);
    if (aim != Aim::any && aim != Aim::turn) {
        const bool is_down = aim == Aim::tool || dice.chance(0.6);
        out.start = place_along(touching, is_down ? 2 : 0, 1, far_mm);
    }
    if (gap_mm(kLongTool, out.start) < far_mm) {
        out.start = place_near(dice, touching, far_mm);
    }
    Positions target = touching;
    for (int i = 0; out.is_clear && i < 100; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            target[k] = out.start[k] + dice.in(-6, 6);
        }
        if (gap_mm(kLongTool, target) > at_rest_mm) {
            break;
        }
    }
    std::copy(target.begin(), target.end(), out.approach.target.begin());
    for (double& share : out.approach.speed_share) {
        share = dice.chance(0.5) ? 1 : dice.magnitude(0.02, 1);
    }
    out.approach.tick_s = kTickS;
    return far_mm;
}

/// A path that is announced, or another tool, or a turn, for those that have time for it.
inline void draw_story(Dice& dice, Aim aim, Machine& machine, WildApproach& out) {
    const bool is_capped = machine.guard.cap != CapPromise::none;
    const double announces = aim == Aim::announce ? 1
                             : !is_capped         ? 0.5
                             : aim == Aim::any    ? 0.2
                                                  : 0;
    if (dice.chance(announces)) {
        std::mt19937_64 random(out.seed);
        give_look_ahead(random, {.linear_mm = 0.02}, machine);
        machine.guard.promise =
            dice.chance(0.5) ? StopPromise::path_keeping : StopPromise::independent;
    } else if (dice.chance(0.2)) {
        out.story.tool = dice.chance(0.5) ? 1 : 2;
        out.story.tool_changes_at = static_cast<int>(dice.in(0, 80));
    }
    const bool turns = aim == Aim::turn || dice.chance(0.2);
    if (turns && machine.can.look_ahead_samples == 0) {
        out.story.turn_at = static_cast<int>(dice.in(5, 120));
        for (bool& turn : out.story.turns) {
            turn = dice.chance(0.5);
        }
    }
    out.reacts_ticks = static_cast<int>(dice.in(5, 60));
    out.story.next_tool = out.story.tool == 1 ? 2 : 1;
}

/// Limits and promises go into `machine`.
inline WildApproach draw_approach(Dice& dice, Machine& machine, Aim aim) {
    aim = aim == Aim::any ? drawn_aim(dice) : aim;
    draw_limits_for(dice, aim, machine);
    WildApproach out;
    const double far_mm = draw_way(dice, machine, aim, out);
    out.seed = static_cast<std::uint64_t>(dice.in(0, 1e15));
    out.faults = draw_faults(dice, machine);
    out.story.lazy_ticks = dice.chance(0.5) ? static_cast<std::size_t>(dice.in(1, 40)) : 0;
    out.raise = dice.chance(0.4) ? dice.magnitude(0.003, 0.1) : 0;
    out.response_us = static_cast<std::int64_t>(dice.in(100, 480));
    if (aim == Aim::straight) {
        draw_straight(dice, out);
    } else if (aim == Aim::crawl) {
        draw_crawl(dice, out);
    } else if (aim == Aim::let_go) {
        draw_straight(dice, out);
        out.raise = dice.in(0.02, 0.1);
        out.story.lazy_ticks = static_cast<std::size_t>(dice.in(0, 10));
        out.faults.silence = Silence::at_stop;
        out.faults.late = dice.chance(0.5) ? dice.in(0, 0.5) : 0;
    } else if (aim == Aim::tool) {
        draw_tool(dice, machine, far_mm, out);
        return out;
    }
    draw_story(dice, aim, machine, out);
    return out;
}

}  // namespace axg::test
