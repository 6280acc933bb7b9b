// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/stop_fit.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/machine/machine.hpp"

namespace axg {

namespace {

constexpr double kReactionMaxS = 10;
constexpr double kFactorMax = 4;
constexpr int kHalvings = 40;

/// The last value from `good` on for which `is_good` holds, towards `bad`; monotone.
double last_good(double good, double bad, const std::function<bool(double)>& is_good) {
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (good + bad);
        (is_good(middle) ? good : bad) = middle;
    }
    return good;
}

std::optional<double> largest(double least, const std::function<bool(double)>& is_good) {
    const double most = kFactorMax * least;
    return is_good(most) ? std::nullopt : std::optional(last_good(least, most, is_good));
}

bool all_fit(std::span<const AxisStop> stops, std::uint32_t axis, const StopFigures& figures) {
    return std::all_of(stops.begin(), stops.end(), [&](const AxisStop& stop) {
        return stop.axis != axis || fits(stop, figures);
    });
}

}  // namespace

double longest_travel(const StopFigures& figures, double speed, double seconds) noexcept {
    const double free_s = std::min(seconds, figures.reaction_s);
    const double braking_s = seconds - free_s;
    const bool has_ramp = figures.jerk < kNoJerkLimit;
    const double ramp_s = has_ramp ? figures.deceleration / figures.jerk : 0;
    const double jerk = has_ramp ? figures.jerk : 0;
    const double rest_in_ramp_s = has_ramp ? std::sqrt(2 * speed / jerk) : 1e9;
    const double in_ramp_s = std::min({braking_s, ramp_s, rest_in_ramp_s});
    double travel =
        speed * free_s + speed * in_ramp_s - jerk * in_ramp_s * in_ramp_s * in_ramp_s / 6;
    const double left = speed - 0.5 * jerk * in_ramp_s * in_ramp_s;
    if (braking_s > ramp_s && left > 0) {
        const double flat_s = std::min(braking_s - ramp_s, left / figures.deceleration);
        travel += left * flat_s - 0.5 * figures.deceleration * flat_s * flat_s;
    }
    return travel;
}

bool fits(const AxisStop& stop, const StopFigures& figures) noexcept {
    return std::all_of(stop.points.begin(), stop.points.end(), [&](const AxisStop::Point& point) {
        return point.travel <= longest_travel(figures, stop.speed, point.seconds) + stop.tolerance;
    });
}

double fitted_reaction_s(const AxisStop& stop, double deceleration, double jerk) noexcept {
    const auto is_good = [&](double reaction_s) {
        return fits(stop, {reaction_s, deceleration, jerk});
    };
    if (is_good(0)) {
        return 0;
    }
    return is_good(kReactionMaxS) ? last_good(kReactionMaxS, 0, is_good) : kNoReaction;
}

std::optional<double> fitted_deceleration(std::span<const AxisStop> stops, std::uint32_t axis,
                                          const StopFigures& figures) noexcept {
    return largest(figures.deceleration, [&](double deceleration) {
        return all_fit(stops, axis, {figures.reaction_s, deceleration, figures.jerk});
    });
}

std::optional<double> fitted_jerk(std::span<const AxisStop> stops, std::uint32_t axis,
                                  const StopFigures& figures) noexcept {
    if (figures.jerk >= kNoJerkLimit) {
        return std::nullopt;
    }
    return largest(figures.jerk, [&](double jerk) {
        return all_fit(stops, axis, {figures.reaction_s, figures.deceleration, jerk});
    });
}

}  // namespace axg
