// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/motion_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/sincos.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

namespace {

/// The turn of an endless axis that is nearest to where it was.
double unwound(double position, double before) noexcept {
    return position + 2 * kPi * std::round((before - position) / (2 * kPi));
}

}  // namespace

MotionRecord::MotionRecord(const Machine& machine) : machine_(machine) {
    const std::array<double, kAxesMax> units = axis_units(machine);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        resolution_.push_back(2 * units[i] + 2 * (axis.position_error + axis.following_error));
    }
}

void MotionRecord::add(const AxisSnapshot& snapshot) {
    RecordedSample sample{snapshot.sample, snapshot.latched_us, snapshot.mode, snapshot.position};
    for (std::size_t i = 0; i < machine_.axes.size() && !samples_.empty(); ++i) {
        if (machine_.axes[i].unlimited) {
            sample.position[i] = unwound(sample.position[i], samples_.back().position[i]);
        }
    }
    samples_.push_back(sample);
    if (samples_.size() > kSamples) {
        samples_.pop_front();
    }
}

const RecordedSample& MotionRecord::at(std::uint64_t number) const noexcept {
    const auto after = std::upper_bound(
        samples_.begin(), samples_.end(), number,
        [](std::uint64_t wanted, const RecordedSample& one) { return wanted < one.number; });
    return after == samples_.begin() ? *after : *std::prev(after);
}

double MotionRecord::speed(std::size_t axis, std::uint64_t from, std::uint64_t to) const noexcept {
    const RecordedSample &first = at(from), &last = at(to);
    const double periods = static_cast<double>(last.number - first.number);
    return periods == 0 ? 0
                        : (last.position[axis] - first.position[axis]) /
                              (periods * machine_.can.sample_us * 1e-6);
}

bool MotionRecord::rests(std::int64_t for_us) const noexcept {
    const auto periods = static_cast<std::uint64_t>(for_us / machine_.can.sample_us);
    if (samples_.empty() || samples_.back().number - samples_.front().number < periods) {
        return false;
    }
    const std::uint64_t since = samples_.back().number - periods;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        double low = std::numeric_limits<double>::max(), high = -low;
        for (auto sample = samples_.rbegin(); sample != samples_.rend() && sample->number >= since;
             ++sample) {
            low = std::min(low, sample->position[i]);
            high = std::max(high, sample->position[i]);
        }
        if (high - low > resolution_[i]) {
            return false;
        }
    }
    return true;
}

std::uint32_t MotionRecord::left_place(std::uint64_t since) const noexcept {
    for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
        if (std::abs(newest().position[i] - at(since).position[i]) > 2 * resolution_[i]) {
            return i;
        }
    }
    return kNoIndex;
}

}  // namespace axg
