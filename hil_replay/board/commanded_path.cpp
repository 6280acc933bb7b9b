// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/commanded_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace axg {

namespace {

constexpr double kSecondsPerUs = 1e-6;
constexpr double kRestRatio = 1e-9;  // s or s2: avoids division by zero for axes at rest

}  // namespace

CommandedPath::CommandedPath(const Machine& machine, std::span<const double> start,
                             CommandedMotion motion, std::int64_t tick_us)
    : machine_(machine), motion_(std::move(motion)), tick_us_(tick_us) {
    start_.tick.tool = machine.first_tool;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        start_.axes[i].position = start[i];
    }
    lead_ = start_.axes;
}

void CommandedPath::begin(std::int64_t at_us) {
    first_us_ = computed_us_ = at_us;
}

void CommandedPath::compute_until(double time_us) {
    const std::size_t count = machine_.axes.size();
    while (!is_over_ && static_cast<double>(computed_us_) <= time_us) {
        const MotionTick tick = motion_({lead_.data(), count});
        if (tick.is_over) {
            is_over_ = true;
            end_ = {lead_, tick};
            return;
        }
        pieces_.push_back({lead_, tick});
        computed_us_ += tick_us_;
        for (std::size_t i = 0; i < count; ++i) {
            lead_[i] = moved_on(lead_[i], static_cast<double>(tick_us_) * kSecondsPerUs);
        }
    }
}

const CommandedPath::Piece& CommandedPath::piece_at(double time_us) {
    compute_until(time_us);
    const double since_us = time_us - static_cast<double>(first_us_);
    if (since_us < 0) {
        return start_;
    }
    const auto place = static_cast<std::size_t>(since_us / static_cast<double>(tick_us_));
    return place < pieces_.size() ? pieces_[place] : end_;
}

AxisMotions CommandedPath::at(double time_us) {
    const Piece& piece = piece_at(time_us);
    const double since_us =
        std::fmod(time_us - static_cast<double>(first_us_), static_cast<double>(tick_us_));
    AxisMotions out{};
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        out[i] = moved_on(piece.axes[i], since_us * kSecondsPerUs);
    }
    return out;
}

MotionTick CommandedPath::tick_at(double time_us) {
    return piece_at(time_us).tick;
}

bool CommandedPath::is_over(double time_us) {
    compute_until(time_us);
    return is_over_ && time_us >= static_cast<double>(computed_us_);
}

void CommandedPath::forget_before(double time_us) {
    while (!pieces_.empty() && static_cast<double>(first_us_ + tick_us_) <= time_us) {
        pieces_.pop_front();
        first_us_ += tick_us_;
    }
}

/// Largest speed of an axis in a stretch: at an end of a piece, or where its acceleration is zero.
double CommandedPath::fastest(std::uint32_t axis, double from_us, double to_us) {
    double most = 0;
    compute_until(to_us);
    const double tick_s = static_cast<double>(tick_us_) * kSecondsPerUs;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
        const double begin_us =
            static_cast<double>(first_us_) + static_cast<double>(k) * static_cast<double>(tick_us_);
        const double low = std::max(0.0, (from_us - begin_us) * kSecondsPerUs);
        const double high = std::min(tick_s, (to_us - begin_us) * kSecondsPerUs);
        if (low > high) {
            continue;
        }
        const AxisMotion& motion = pieces_[k].axes[axis];
        const double level = motion.jerk == 0 ? low : -motion.acceleration / motion.jerk;
        for (const double at : {low, high, std::clamp(level, low, high)}) {
            most = std::max(most, std::abs(moved_on(motion, at).speed));
        }
    }
    return most;
}

Brake CommandedPath::gentlest_stop(double begin_us) {
    double end_us = begin_us;
    while (true) {  // from below: the stretch grows until the stop ends in it
        double p = kRestRatio, z = kRestRatio;
        for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
            const double speed = fastest(i, begin_us, end_us);
            p = std::max(p, speed / machine_.axes[i].stopping_min);
            z = std::max(z, speed / machine_.axes[i].jerk_max);
        }
        const Brake stop{.deceleration = 1 / p, .jerk = 1 / z};
        AxisMotion rate{.position = 0, .speed = 1};
        brake(rate, stop, 1e6);
        const double rest_us = begin_us + rate.position / kSecondsPerUs;
        if (rest_us <= end_us + 1e-3) {
            return stop;
        }
        end_us = rest_us;
    }
}

}  // namespace axg
