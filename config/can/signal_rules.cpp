// SPDX-License-Identifier: Apache-2.0
#include "config/can/signal_rules.hpp"

#include <algorithm>
#include <cmath>

#include "config/text/map_reader.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::array<SignalUnit, kSignalUnitNames.size()> kUnits{{{AxisKind::linear, 1.0},
                                                                  {AxisKind::linear, 25.4},
                                                                  {AxisKind::linear, 1000.0},
                                                                  {AxisKind::linear, 0.001},
                                                                  {AxisKind::rotary, 1.0},
                                                                  {AxisKind::rotary, 180.0 / kPi},
                                                                  {AxisKind::rotary, 360.0}}};

/// The smallest and the largest number that the bits can represent.
struct RawRange {
    double low, high;
};

RawRange raw_range(const CanSignal& signal) noexcept {
    if (signal.type != SignalType::integer) {
        const double most = signal.type == SignalType::float32 ? 3.4e38 : 1.7e308;
        return {-most, most};
    }
    const int bits = signal.length_bits - (signal.is_signed ? 1 : 0);
    return {signal.is_signed ? -std::ldexp(1.0, bits) : 0.0, std::ldexp(1.0, bits) - 1.0};
}

}  // namespace

SignalUnit signal_unit(std::size_t index) noexcept {
    return kUnits[index];
}

std::string units_of(AxisKind kind) {
    return kind == AxisKind::rotary ? "deg, rad or turn" : "mm, inch, m or um";
}

/// Most significant bit first runs down to bit 0 of a byte and on at bit 7 of the next.
bool covered_bits(const CanSignal& signal, std::uint32_t frame_bits, FrameBits& out) {
    std::uint32_t bit = signal.start_bit;
    for (std::uint32_t i = 0; i < signal.length_bits; ++i) {
        if (bit >= frame_bits) {
            return false;
        }
        out.set(bit);
        const bool next_byte = signal.order == ByteOrder::big && bit % 8 == 0;
        bit = signal.order == ByteOrder::little ? bit + 1 : next_byte ? bit + 15 : bit - 1;
    }
    return true;
}

SignalReach reach_of(const CanSignal& signal, const Axis& axis) {
    const RawRange raw = raw_range(signal);
    const double one = raw.low * signal.factor + signal.offset;
    const double other = raw.high * signal.factor + signal.offset;
    const double low = std::min(one, other);
    const double high = std::max(one, other);
    const double to_file = axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
    const double slack = std::fabs(signal.factor);  // half a count either way would do
    const bool fits = axis.unlimited
                          ? high - low >= 360.0 - slack
                          : low <= axis.min * to_file + slack && high >= axis.max * to_file - slack;
    if (fits) {
        return {};
    }
    return {false, "bits that reach from " + shown(low) + " to " + shown(high),
            axis.unlimited ? "a full turn of 360 degrees"
                           : "the axis' whole travel, " + shown(axis.min * to_file) + " to " +
                                 shown(axis.max * to_file)};
}

}  // namespace axg
