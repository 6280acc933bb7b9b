// SPDX-License-Identifier: Apache-2.0
// NaN and infinity tested by their bits, wherever vertices, poses and positions enter: no
// compiler option can optimise the test away, and no operation quiets a signalling NaN
// before the test. Source: IEEE 754, only they have the largest exponent.
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"

namespace axg {

AXG_HD constexpr bool is_finite(float x) noexcept {
    constexpr std::uint32_t kExponent = 0x7f800000U;
    return (__builtin_bit_cast(std::uint32_t, x) & kExponent) != kExponent;
}

AXG_HD constexpr bool is_finite(double x) noexcept {
    constexpr std::uint64_t kExponent = 0x7ff0000000000000U;
    return (__builtin_bit_cast(std::uint64_t, x) & kExponent) != kExponent;
}

}  // namespace axg
