// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/case_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/reach/stop_limits.hpp"
#include "firmware_if/cli/limit_text.hpp"

namespace axg {

namespace {

constexpr double kSteadyWindowS = 40e-3;
constexpr double kSteadyShare = 0.02;  // that the speed of both halves may differ by
constexpr double kRestS = 15e-3;       // without motion: the stop is over

std::uint64_t window_samples(const Machine& machine) noexcept {
    const double samples = kSteadyWindowS / (machine.can.sample_us * 1e-6);
    return std::max<std::uint64_t>(8, static_cast<std::uint64_t>(samples) / 2 * 2);
}

double period_s(const Machine& machine) noexcept {
    return machine.can.sample_us * 1e-6;
}

const char* length_unit(const Axis& axis) noexcept {
    return axis.kind == AxisKind::rotary ? "deg" : "mm";
}

/// Up to the first rest: what a board does afterwards is another matter.
void end_at_rest(AxisStop& stop, double resolution, double period) {
    const auto window = static_cast<std::size_t>(std::max(3.0, std::ceil(kRestS / period)));
    for (std::size_t i = 0; i + window < stop.points.size(); ++i) {
        if (std::abs(stop.points[i + window].travel - stop.points[i].travel) <= resolution) {
            stop.points.resize(i + window);
            return;
        }
    }
}

}  // namespace

double seen_reaction_s(const Machine& machine) noexcept {
    return machine.guard.board_reaction_s + age_seconds(machine).most;
}

double least_speed(const Machine& machine, const MotionRecord& record, std::size_t axis) noexcept {
    const double seconds = std::max(seen_reaction_s(machine), period_s(machine));
    return 10 * record.resolution(axis) / seconds;
}

std::vector<SteadyAxis> steady_axes(const Machine& machine, const MotionRecord& record) {
    std::vector<SteadyAxis> out;
    const std::uint64_t window = window_samples(machine);
    if (record.is_empty() || record.newest().number - record.samples().front().number < window) {
        return out;
    }
    const std::uint64_t now = record.newest().number, middle = now - window / 2,
                        start = now - window;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const double before = record.speed(i, start, middle), after = record.speed(i, middle, now);
        const double half_s = 0.5 * static_cast<double>(window) * period_s(machine);
        const double noise = 2 * record.resolution(i) / half_s;
        if (std::abs(after) >= least_speed(machine, record, i) &&
            std::abs(after - before) <= kSteadyShare * std::abs(after) + noise) {
            out.push_back({i, record.speed(i, start, now)});
        }
    }
    return out;
}

std::vector<AxisStop> stops_of(const Machine& machine, const MotionRecord& record,
                               const std::vector<SteadyAxis>& before, const StopInstant& instant) {
    std::vector<AxisStop> out;
    const RecordedSample& known = record.at(instant.sample);
    const double window_s = static_cast<double>(window_samples(machine)) * period_s(machine);
    const double jitter_s = sample_errors(machine, 0, 0).latch_jitter_s;
    for (const SteadyAxis& steady : before) {
        const double way = steady.speed < 0 ? -1 : 1;
        const double speed = std::abs(steady.speed);
        const double resolution = record.resolution(steady.axis);
        AxisStop stop{.axis = steady.axis, .speed = speed + resolution / window_s, .points = {}};
        stop.tolerance = 2 * resolution + speed * (instant.stamp_s + jitter_s);
        for (const RecordedSample& sample : record.samples()) {
            const double seconds =
                sample.number <= known.number
                    ? -1
                    : static_cast<double>(sample.number - known.number) * period_s(machine) -
                          instant.later_s;
            if (seconds >= 0) {
                const double moved =
                    way * (sample.position[steady.axis] - known.position[steady.axis]);
                stop.points.push_back({seconds, moved - speed * instant.later_s});
            }
        }
        end_at_rest(stop, resolution, period_s(machine));
        out.push_back(std::move(stop));
    }
    return out;
}

double longest_reaction_s(const Machine& machine, const std::vector<AxisStop>& stops) noexcept {
    double longest = 0;
    for (const AxisStop& stop : stops) {
        const Axis& axis = machine.axes[stop.axis];
        longest = std::max(longest, fitted_reaction_s(stop, axis.stopping_min, axis.jerk_max));
    }
    return longest;
}

bool are_steady(const std::vector<AxisStop>& stops) noexcept {
    return std::all_of(stops.begin(), stops.end(), [](const AxisStop& stop) {
        if (stop.points.empty()) {
            return false;
        }
        const AxisStop::Point& first = stop.points.front();
        return std::abs(first.travel - stop.speed * first.seconds) <= 2 * stop.tolerance;
    });
}

std::string reversal_of(const Machine& machine, const std::vector<AxisStop>& stops) {
    for (const AxisStop& stop : stops) {
        double farthest = 0;
        for (const AxisStop::Point& point : stop.points) {
            farthest = std::max(farthest, point.travel);
            const Axis& axis = machine.axes[stop.axis];
            if (farthest - point.travel > 2 * stop.tolerance) {
                return fmt::format("{} reversed {:.1f} ms after the stop was due", axis.name,
                                   point.seconds * 1e3);
            }
        }
    }
    return {};
}

std::optional<Overshoot> overshoot_of(const Machine& machine, const std::vector<AxisStop>& stops,
                                      double reaction_s) {
    for (const AxisStop& stop : stops) {
        const Axis& axis = machine.axes[stop.axis];
        const StopFigures figures{reaction_s, axis.stopping_min, axis.jerk_max};
        double most = 0, first_s = 0;
        for (const AxisStop::Point& point : stop.points) {
            const double beyond =
                point.travel - longest_travel(figures, stop.speed, point.seconds) - stop.tolerance;
            first_s = most == 0 ? point.seconds : first_s;
            most = std::max(most, beyond);
        }
        if (most > 0) {
            return Overshoot{fmt::format("{} moved {:.3g} {} farther than the machine file allows",
                                         axis.name, in_axis_units(axis, most), length_unit(axis)),
                             first_s};
        }
    }
    return std::nullopt;
}

}  // namespace axg
