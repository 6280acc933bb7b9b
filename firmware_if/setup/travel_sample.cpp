// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/travel_sample.hpp"

#include <algorithm>
#include <array>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

/// Part of a Halton sequence (Halton 1960): even cover of the travel, the same on every machine.
double radical_inverse(std::uint32_t index, std::uint32_t base) {
    double value = 0, digit = 1;
    for (; index != 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

}  // namespace

AxisSnapshot sampled_position(const Machine& machine, std::uint32_t index) {
    constexpr std::array<std::uint32_t, kAxesMax> kPrimes{2,  3,  5,  7,  11, 13, 17, 19,
                                                          23, 29, 31, 37, 41, 43, 47, 53};
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double low = axis.unlimited ? 0 : axis.min;
        const double high = axis.unlimited ? 2 * kPi : axis.max;
        snapshot.position[i] = index == 0 ? std::clamp(0.0, low, high)
                                          : low + (high - low) * radical_inverse(index, kPrimes[i]);
    }
    return snapshot;
}

}  // namespace axg
