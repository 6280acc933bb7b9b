// SPDX-License-Identifier: Apache-2.0
// Four float lanes on AArch64 Advanced SIMD. Included by one translation unit compiled for it.
#pragma once

#include <arm_neon.h>

#include <cstdint>

#include "core/collision/lanes.hpp"

namespace axg::lanes {

struct Float4 {
    float32x4_t v;
    static constexpr unsigned kWidth = 4;

    AXG_HD static Float4 load(const float* p) noexcept { return {vld1q_f32(p)}; }
    AXG_HD static Float4 of(float c) noexcept { return {vdupq_n_f32(c)}; }
    AXG_HD void store(float* p) const noexcept { vst1q_f32(p, v); }
    /// table[index[lane]] out of 32 entries.
    AXG_HD static Float4 pick(const float* table, const std::uint8_t* index) noexcept {
        const float picked[4] = {table[index[0]], table[index[1]], table[index[2]],
                                 table[index[3]]};
        return load(picked);
    }
    /// Least of all lanes; a zero, also of most(), may have either sign.
    AXG_HD float least() const noexcept { return vminvq_f32(v); }
    AXG_HD float most() const noexcept { return vmaxvq_f32(v); }
};
struct Mask4 {
    uint32x4_t m;

    AXG_HD std::uint32_t bits() const noexcept {
        const uint32x4_t weight = {1U, 2U, 4U, 8U};
        return vaddvq_u32(vandq_u32(m, weight));
    }
};

AXG_HD Float4 operator+(Float4 a, Float4 b) noexcept {
    return {vaddq_f32(a.v, b.v)};
}
AXG_HD Float4 operator-(Float4 a, Float4 b) noexcept {
    return {vsubq_f32(a.v, b.v)};
}
AXG_HD Float4 operator*(Float4 a, Float4 b) noexcept {
    return {vmulq_f32(a.v, b.v)};
}
AXG_HD Float4 operator/(Float4 a, Float4 b) noexcept {
    return {vdivq_f32(a.v, b.v)};
}
AXG_HD Float4 operator-(Float4 a) noexcept {
    return {vnegq_f32(a.v)};
}
AXG_HD Float4 min(Float4 a, Float4 b) noexcept {
    return {vbslq_f32(vcltq_f32(a.v, b.v), a.v, b.v)};
}
AXG_HD Float4 max(Float4 a, Float4 b) noexcept {
    return {vbslq_f32(vcgtq_f32(a.v, b.v), a.v, b.v)};
}
AXG_HD Float4 abs(Float4 a) noexcept {
    return {vabsq_f32(a.v)};
}
AXG_HD Float4 fma(Float4 a, Float4 b, Float4 c) noexcept {
    return {vfmaq_f32(c.v, a.v, b.v)};
}
AXG_HD Float4 sqrt(Float4 a) noexcept {
    return {vsqrtq_f32(a.v)};
}
AXG_HD Mask4 greater(Float4 a, Float4 b) noexcept {
    return {vcgtq_f32(a.v, b.v)};
}
AXG_HD Float4 select(Mask4 m, Float4 a, Float4 b) noexcept {
    return {vbslq_f32(m.m, a.v, b.v)};
}
AXG_HD Mask4 either(Mask4 a, Mask4 b) noexcept {
    return {vorrq_u32(a.m, b.m)};
}
AXG_HD Mask4 both(Mask4 a, Mask4 b) noexcept {
    return {vandq_u32(a.m, b.m)};
}
AXG_HD bool all(Mask4 m) noexcept {
    return vminvq_u32(m.m) == 0xffffffffU;
}

template <>
struct Traits<Float4> {
    using Mask = Mask4;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;
    AXG_HD static Float4 of(double c) noexcept { return Float4::of(static_cast<float>(c)); }
};

}  // namespace axg::lanes
