// SPDX-License-Identifier: Apache-2.0
// The operations of the certified tests, for one lane (float, double: host, device and recheck).
// The wide forms are in lanes_avx512.hpp, lanes_avx2.hpp and lanes_neon.hpp; each returns the same
// bits as these.
#pragma once

#include "core/base/host_device.hpp"

// Before a loop over the axes of a pair in V: a device compiler unrolls it, at most kUnrollTo<V>
// times. No result depends on it.
#if defined(__CUDA_ARCH__)
#define AXG_PRAGMA(words) _Pragma(#words)
#define AXG_UNROLL(V) AXG_PRAGMA(unroll axg::lanes::kUnrollTo<V>)
#else
#define AXG_UNROLL(V)
#endif

namespace axg::lanes {

/// Turns of an axis loop that are unrolled; no such loop has more than nine.
template <class V>
inline constexpr int kUnrollTo = 16;

// min and max as x86 defines them: the second operand wins ties, signed zeros and NaN. Inputs hold
// no NaN anyway.
AXG_HD float min(float a, float b) noexcept {
    return a < b ? a : b;
}
AXG_HD float max(float a, float b) noexcept {
    return a > b ? a : b;
}
AXG_HD double min(double a, double b) noexcept {
    return a < b ? a : b;
}
AXG_HD double max(double a, double b) noexcept {
    return a > b ? a : b;
}
AXG_HD float abs(float a) noexcept {
    return __builtin_fabsf(a);
}
AXG_HD double abs(double a) noexcept {
    return __builtin_fabs(a);
}
AXG_HD float fma(float a, float b, float c) noexcept {
    return __builtin_fmaf(a, b, c);
}
AXG_HD double fma(double a, double b, double c) noexcept {
    return __builtin_fma(a, b, c);
}
AXG_HD float sqrt(float a) noexcept {
    return __builtin_sqrtf(a);
}
AXG_HD double sqrt(double a) noexcept {
    return __builtin_sqrt(a);
}
AXG_HD bool greater(float a, float b) noexcept {
    return a > b;
}
AXG_HD bool greater(double a, double b) noexcept {
    return a > b;
}
AXG_HD float select(bool m, float a, float b) noexcept {
    return m ? a : b;
}
AXG_HD double select(bool m, double a, double b) noexcept {
    return m ? a : b;
}

AXG_HD bool either(bool a, bool b) noexcept {
    return a || b;
}
AXG_HD bool both(bool a, bool b) noexcept {
    return a && b;
}
AXG_HD bool all(bool m) noexcept {
    return m;
}

/// Constants of a lane's format for the bound of docs/theory/accuracy.md.
template <class V>
struct Traits;

template <>
struct Traits<float> {
    using Mask = bool;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;  // 2^-100 of the theorem
    AXG_HD static float of(double c) noexcept { return static_cast<float>(c); }
};
template <>
struct Traits<double> {
    using Mask = bool;
    static constexpr double kUnit = 0x1p-53;
    static constexpr double kTiny = 0x1p-900;
    AXG_HD static double of(double c) noexcept { return c; }
};

}  // namespace axg::lanes
