// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/rest_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reach/stop_reach.hpp"
#include "firmware_if/cli/limit_text.hpp"

namespace axg {

namespace {

constexpr double kStillS = 60e-3;  // at one place: the axis rests
constexpr double kSpeedS = 40e-3;  // before the stop, to see the speed by

}  // namespace

void RestWatch::begin(std::uint64_t sample, double seconds, double free_s,
                      const std::vector<SteadyAxis>& judged) {
    const double period_s = machine_.can.sample_us * 1e-6;
    axes_.assign(machine_.axes.size(), {.is_bounded = true});
    for (const SteadyAxis& steady : judged) {
        axes_[steady.axis].is_bounded = false;
    }
    cut_ = sample + static_cast<std::uint64_t>(seconds / period_s);
    free_s_ = free_s + period_s;  // the stop is due up to a period after that sample
    is_cut_ = has_gone_far_ = has_resumed_ = false;
}

/// Bounds the speed by means over short times, each with the speed that the axis may have gained.
void RestWatch::bound(WatchedAxis& watched, std::uint32_t axis, const MotionRecord& record) const {
    const Axis& promised = machine_.axes[axis];
    const double period_s = machine_.can.sample_us * 1e-6, resolution = record.resolution(axis);
    const double place = record.at(cut_).position[axis];
    AxisRange now{.low = place - resolution,
                  .high = place + resolution,
                  .speed_low = -promised.speed_max,
                  .speed_high = promised.speed_max};
    const auto most = static_cast<std::uint64_t>(kSpeedS / period_s);
    for (std::uint64_t back = 1; back <= std::min(most, cut_); ++back) {
        const double seconds = static_cast<double>(back) * period_s;
        const double mean = record.speed(axis, cut_ - back, cut_);
        const double off = resolution / seconds + promised.acceleration_max * seconds;
        now.speed_low = std::max(now.speed_low, mean - off);
        now.speed_high = std::min(now.speed_high, mean + off);
    }
    if (now.speed_low > now.speed_high) {
        now.speed_low = -promised.speed_max;
        now.speed_high = promised.speed_max;
    }
    const ReachRange reach = stop_reach({.speed_max = promised.speed_max,
                                         .acceleration_max = promised.acceleration_max,
                                         .jerk_max = promised.jerk_max,
                                         .stopping_min = promised.stopping_min,
                                         .stop_turns_round = true},
                                        now, free_s_);
    watched.low = reach.low - resolution;
    watched.high = reach.high + resolution;
}

std::optional<RestFault> RestWatch::on_sample(const MotionRecord& record) {
    const RecordedSample& newest = record.newest();
    if (axes_.empty() || newest.number <= cut_) {
        return std::nullopt;
    }
    const double period_s = machine_.can.sample_us * 1e-6;
    const bool was_cut = std::exchange(is_cut_, true);
    const auto still = static_cast<std::uint64_t>(std::ceil(kStillS / period_s));
    const auto free = static_cast<std::uint64_t>(std::ceil(free_s_ / period_s));
    std::optional<RestFault> fault;
    for (std::uint32_t i = 0; i < axes_.size(); ++i) {
        WatchedAxis& axis = axes_[i];
        const double place = newest.position[i], resolution = record.resolution(i);
        const char* const name = machine_.axes[i].name.c_str();
        if (!was_cut && axis.is_bounded) {
            bound(axis, i, record);
        }
        const double moved = std::abs(place - axis.place);
        if (axis.is_at_rest && moved > 2 * resolution && !has_resumed_) {
            has_resumed_ = true;
            fault = {Watched::resume, fmt::format("{} rested after a stop, and moves again "
                                                  "before the board is armed",
                                                  name)};
        }
        if (!axis.is_at_rest) {
            if (newest.number <= cut_ + free || moved > resolution) {
                axis.place = place;
                axis.since = newest.number;
            }
            axis.is_at_rest = newest.number - axis.since >= still;
        }
        const double beyond = std::max(axis.low - place, place - axis.high);
        if (axis.is_bounded && beyond > 0 && !has_gone_far_ && !has_resumed_) {
            has_gone_far_ = true;
            fault = {Watched::braking,
                     fmt::format("{} moves after the stop was due, {:.3g} {} farther than any stop",
                                 name, in_axis_units(machine_.axes[i], beyond),
                                 machine_.axes[i].kind == AxisKind::rotary ? "deg" : "mm")};
        }
    }
    return fault;
}

}  // namespace axg
