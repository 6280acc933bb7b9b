// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/hints_frame.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

constexpr double kCountsPerMm = 100;
constexpr std::uint8_t kHintsBytes = 5;

std::uint16_t distance_of(double distance_mm) noexcept {
    const double counts = is_finite(distance_mm) ? std::floor(distance_mm * kCountsPerMm) : 0;
    return static_cast<std::uint16_t>(std::clamp(counts, 0.0, double{kHintNone}));
}

}  // namespace

Hints hints_of(const CycleResult& result, std::uint8_t sync_counter) noexcept {
    const std::uint32_t pair = result.has_permit ? result.advisories.pair : result.pair;
    return {.sync_counter = sync_counter,
            .pair = static_cast<std::uint16_t>(std::min<std::uint32_t>(pair, kHintNone)),
            .distance_10um =
                result.has_permit ? distance_of(result.advisories.distance_mm) : std::uint16_t{0}};
}

CanFrame encode_hints(const CanLayout& layout, const Hints& hints, std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.id = layout.hints_id;
    frame.length_bytes = kHintsBytes;
    frame.time_us = time_us;
    frame.data[0] = hints.sync_counter;
    detail::put_little(frame.data.data() + 1, hints.pair, 2);
    detail::put_little(frame.data.data() + 3, hints.distance_10um, 2);
    return frame;
}

}  // namespace axg
