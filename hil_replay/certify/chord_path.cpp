// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/chord_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reach/stop_limits.hpp"

namespace axg {
namespace {

constexpr double kUp = 1.0 + 0x1p-40;  // exceeds the roundings of the formulas below
constexpr std::uint64_t kChunkSteps = 4096;
// Speeds would differ too much within a longer segment, where each axis stops by itself.
constexpr std::uint64_t kIndependentChunkSteps = 100;
constexpr std::uint64_t kProgressSteps = 100'000;

std::int64_t nearest_unit(double position, AxisKind kind) {
    return std::llround(position / unit_of(kind));
}

std::uint8_t speed_step(double speed, double most) {
    const double steps = std::ceil(kSpeedSteps * speed / most * kUp);
    return static_cast<std::uint8_t>(std::clamp(steps, 0.0, kSpeedSteps));
}

/// The time after which a stop's own acceleration has ended, during which it counts what the axis
/// would have done without the stop.
double ahead_seconds(const Machine& machine, const Axis& axis) {
    return machine.guard.free_jerk_limited ? axis.acceleration_max / axis.jerk_max * kUp : 0;
}

double longest_stop_seconds(const Machine& machine) {
    double ramp = 0, braking = 0;
    for (const Axis& axis : machine.axes) {
        ramp = std::max(ramp, (axis.acceleration_max + axis.stopping_min) / axis.jerk_max);
        braking = std::max(braking, axis.speed_max / axis.stopping_min);
    }
    return (ramp + braking) * kUp;
}

}  // namespace

std::int64_t units_up(double length, AxisKind kind) noexcept {
    return static_cast<std::int64_t>(std::ceil(length / unit_of(kind) * kUp));
}

PathThinner::PathThinner(const Machine& machine, const ChordOptions& options)
    : machine_(machine), needs_speeds_(machine.guard.promise == StopPromise::independent) {
    chunk_steps_max_ = needs_speeds_ ? kIndependentChunkSteps : kChunkSteps;
    path_.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        const bool is_linear = axis.kind == AxisKind::linear;
        const double delta = is_linear ? options.delta_mm : options.delta_rad;
        path_.delta[i] = units_up(delta, axis.kind);
        path_.following[i] = units_up(axis.following_error + axis.position_error, axis.kind);
        // Between two samples a command leaves their chord by at most this.
        const double bulge = axis.acceleration_max * kMotionStepS * kMotionStepS / 8 * kUp;
        tolerance_[i] = std::max(0.0, delta - bulge);
    }
}

void PathThinner::note_speeds(const AxisPositions& from, const AxisPositions& to) {
    OwnSpeeds step;
    for (std::uint32_t i = 0; needs_speeds_ && i < path_.axis_count; ++i) {
        const Axis& axis = machine_.axes[i];
        const double mean = (to[i] - from[i]) / kMotionStepS;
        if (mean != 0) {  // a speed differs from its mean by half a step of acceleration
            const double half = axis.acceleration_max * kMotionStepS / 2;
            step.up[i] = speed_step(mean + half, axis.speed_max);
            step.down[i] = speed_step(half - mean, axis.speed_max);
        }
    }
    steps_.push_back(step);
}

void PathThinner::add(const MotionSample& sample, std::uint32_t tool) {
    if (!has_begun_) {
        has_begun_ = true;
        tool_ = tool;
        path_.runs.push_back({.tool = tool});
        chunk_.push_back({sample.index, sample.position});
        steps_.emplace_back();
        for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
            path_.nodes.push_back(nearest_unit(sample.position[i], machine_.axes[i].kind));
        }
    }
    const bool moves = sample.position != last_ && sample.index != chunk_.front().index;
    const bool is_full = sample.index - chunk_.front().index > chunk_steps_max_;
    if (tool != tool_ || (moves && (sample.line != line_ || is_full))) {
        end_chunk();
    }
    if (tool != tool_) {
        changes_.push_back(sample.index);
        path_.runs.push_back({.tool = tool});
        tool_ = tool;
    }
    if (moves) {
        line_ = sample.line;
        if (chunk_.size() == 1) {  // the axes may have rested there since
            chunk_.front().index = sample.index - 1;
        }
        chunk_.push_back({sample.index, sample.position});
        note_speeds(last_, sample.position);
    }
    last_ = sample.position;
    path_.seconds = static_cast<double>(sample.index) * kMotionStepS;
}

/// The sample between two others that is farthest from their chord; `from` where all are near
/// enough.
std::size_t PathThinner::worst_between(std::size_t from, std::size_t to) const {
    AxisPositions a{}, way{};
    std::uint32_t widest = 0;
    double most = 0, length = 0;
    for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
        const AxisKind kind = machine_.axes[i].kind;
        const double unit = unit_of(kind);
        a[i] = static_cast<double>(nearest_unit(chunk_[from].position[i], kind)) * unit;
        way[i] = static_cast<double>(nearest_unit(chunk_[to].position[i], kind)) * unit - a[i];
        length = std::fabs(way[i]) / tolerance_[i];
        if (length > most) {
            most = length;
            widest = i;
        }
    }
    std::size_t worst = from;
    double worst_share = 1;
    for (std::size_t k = from + 1; k < to; ++k) {
        const AxisPositions& p = chunk_[k].position;
        const double along =
            most > 0 ? std::clamp((p[widest] - a[widest]) / way[widest], 0.0, 1.0) : 0;
        double share = 0;
        for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
            share = std::max(share, std::fabs(p[i] - (a[i] + along * way[i])) / tolerance_[i]);
        }
        if (share * kUp > worst_share) {
            worst_share = share;
            worst = k;
        }
    }
    return worst;
}

/// Cuts the chunk at its worst samples until all are near their chords.
void PathThinner::end_chunk() {
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, chunk_.size() - 1}};
    while (!open.empty() && chunk_.size() > 1) {
        const auto [from, to] = open.back();
        open.pop_back();
        const std::size_t cut = worst_between(from, to);
        if (cut != from) {
            open.emplace_back(cut, to);
            open.emplace_back(from, cut);
            continue;
        }
        OwnSpeeds most;
        for (std::size_t k = from + 1; k <= to; ++k) {
            for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
                most.up[i] = std::max(most.up[i], steps_[k].up[i]);
                most.down[i] = std::max(most.down[i], steps_[k].down[i]);
            }
        }
        own_.push_back(most);
        add_segment(chunk_[from], chunk_[to]);
    }
    chunk_.erase(chunk_.begin(), chunk_.end() - 1);
    steps_.assign(1, {});
}

void PathThinner::add_segment(const Timed& from, const Timed& to) {
    for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
        path_.nodes.push_back(nearest_unit(to.position[i], machine_.axes[i].kind));
    }
    path_.lines.push_back(line_);
    begin_.push_back(from.index);
    path_.ends.push_back(to.index);
    ++path_.runs.back().segments;
}

/// Speeds of a segment hold for a while after it, too.
void PathThinner::widen_speeds() {
    const std::size_t count = path_.lines.size();
    path_.speeds.resize(count * path_.axis_count * 2);
    for (std::uint32_t axis = 0; axis < path_.axis_count; ++axis) {
        const double ahead = ahead_seconds(machine_, machine_.axes[axis]) / kMotionStepS;
        const auto steps = static_cast<std::uint64_t>(std::ceil(std::min(ahead, 1e9)));
        for (const bool is_up : {true, false}) {
            const auto own = [&](std::size_t i) {
                return is_up ? own_[i].up[axis] : own_[i].down[axis];
            };
            std::vector<std::size_t> falling;  // places whose speeds fall, from `first` on
            std::size_t first = 0, next = 0;
            for (std::size_t i = 0; i < count; ++i) {
                for (; next < count && (next <= i || begin_[next] < path_.ends[i] + steps);
                     ++next) {
                    while (falling.size() > first && own(falling.back()) <= own(next)) {
                        falling.pop_back();
                    }
                    falling.push_back(next);
                }
                while (falling[first] < i) {
                    ++first;
                }
                path_.speeds[(i * path_.axis_count + axis) * 2 + (is_up ? 0 : 1)] =
                    own(falling[first]);
            }
        }
    }
}

/// Around a change of tools every tool counts, as in SpindleTools: the old one until the longest
/// permit and the longest stop are over, the new one as long before.
void PathThinner::share_tools() {
    const double free_s = free_seconds(machine_, machine_.can.permit_samples.most);
    const auto before = static_cast<std::uint64_t>(std::ceil(free_s / kMotionStepS)) + 1;
    const auto after = static_cast<std::uint64_t>(
                           std::ceil((free_s + longest_stop_seconds(machine_)) / kMotionStepS)) +
                       1;
    std::uint64_t segment = 0;
    for (std::size_t r = 0; r < path_.runs.size(); ++r) {
        PathRun& run = path_.runs[r];
        const std::uint64_t end = segment + run.segments;
        for (std::size_t k = 0; k < changes_.size() && run.segments != 0; ++k) {
            const std::uint64_t change = changes_[k];
            std::uint64_t first = 0, last = 0;
            if (k < r) {  // change k begins run k + 1
                while (first < run.segments && begin_[segment + first] < change + after) {
                    ++first;
                }
            } else {
                while (last < run.segments && path_.ends[end - 1 - last] + before > change) {
                    ++last;
                }
            }
            run.first = std::max(run.first, first);
            run.last = std::max(run.last, last);
        }
        segment = end;
    }
    std::erase_if(path_.runs, [](const PathRun& run) { return run.segments == 0; });
}

ChordPath PathThinner::finish() {
    if (has_begun_) {
        end_chunk();
        share_tools();
        if (needs_speeds_) {
            widen_speeds();
        }
    }
    return std::move(path_);
}

PlannedPath plan_chord_path(
    const Machine& machine, const Program& program, const MotionOptions& motion,
    const ChordOptions& options,
    const std::function<void(double program_s, std::uint32_t line)>& progress) {
    const MotionLimits limits = make_motion_limits(machine);
    MotionSampler sampler(program, limits, motion);
    PathThinner thinner(machine, options);
    MotionSample sample;
    std::uint32_t number = UINT32_MAX, slot = kNoIndex;
    while (sampler.next(sample)) {
        if (sample.tool != number) {
            number = sample.tool;
            const std::uint32_t held = number != 0 ? number : machine.first_tool;
            const auto is_held = [&](const Tool& tool) { return tool.number == held; };
            const auto found = std::find_if(machine.tools.begin(), machine.tools.end(), is_held);
            if (held != 0 && found == machine.tools.end()) {
                return {.path = {}, .unknown_tool = held, .unknown_line = sample.line};
            }
            slot = held == 0 ? kNoIndex : static_cast<std::uint32_t>(found - machine.tools.begin());
        }
        thinner.add(sample, slot);
        if (progress && sample.index % kProgressSteps == 0) {
            progress(static_cast<double>(sample.index) * kMotionStepS, sample.line);
        }
    }
    return {.path = thinner.finish()};
}

}  // namespace axg
