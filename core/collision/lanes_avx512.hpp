// SPDX-License-Identifier: Apache-2.0
// Sixteen float lanes on AVX-512F. Included by one translation unit compiled for it.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "core/collision/lanes.hpp"

namespace axg::lanes {

struct Float16 {
    __m512 v;
    static constexpr unsigned kWidth = 16;

    AXG_HD static Float16 load(const float* p) noexcept { return {_mm512_loadu_ps(p)}; }
    AXG_HD static Float16 of(float c) noexcept { return {_mm512_set1_ps(c)}; }
    AXG_HD void store(float* p) const noexcept { _mm512_storeu_ps(p, v); }
    /// table[index[lane]] out of 32 entries: one two-source permutation.
    AXG_HD static Float16 pick(const float* table, const std::uint8_t* index) noexcept {
        const __m512i at =
            _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(index)));
        return {_mm512_permutex2var_ps(_mm512_loadu_ps(table), at, _mm512_loadu_ps(table + 16))};
    }
    /// Least of all lanes; a zero, also of most(), may have either sign.
    AXG_HD float least() const noexcept { return _mm512_reduce_min_ps(v); }
    AXG_HD float most() const noexcept { return _mm512_reduce_max_ps(v); }
};
struct Mask16 {
    __mmask16 m;

    AXG_HD std::uint32_t bits() const noexcept { return m; }
};

AXG_HD Float16 operator+(Float16 a, Float16 b) noexcept {
    return {_mm512_add_ps(a.v, b.v)};
}
AXG_HD Float16 operator-(Float16 a, Float16 b) noexcept {
    return {_mm512_sub_ps(a.v, b.v)};
}
AXG_HD Float16 operator*(Float16 a, Float16 b) noexcept {
    return {_mm512_mul_ps(a.v, b.v)};
}
AXG_HD Float16 operator/(Float16 a, Float16 b) noexcept {
    return {_mm512_div_ps(a.v, b.v)};
}
AXG_HD Float16 operator-(Float16 a) noexcept {
    return {_mm512_castsi512_ps(
        _mm512_xor_si512(_mm512_castps_si512(a.v), _mm512_set1_epi32(INT32_MIN)))};
}
AXG_HD Float16 min(Float16 a, Float16 b) noexcept {
    return {_mm512_min_ps(a.v, b.v)};
}
AXG_HD Float16 max(Float16 a, Float16 b) noexcept {
    return {_mm512_max_ps(a.v, b.v)};
}
AXG_HD Float16 abs(Float16 a) noexcept {
    return {_mm512_abs_ps(a.v)};
}
AXG_HD Float16 fma(Float16 a, Float16 b, Float16 c) noexcept {
    return {_mm512_fmadd_ps(a.v, b.v, c.v)};
}
AXG_HD Float16 sqrt(Float16 a) noexcept {
    return {_mm512_sqrt_ps(a.v)};
}
AXG_HD Mask16 greater(Float16 a, Float16 b) noexcept {
    return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)};
}
AXG_HD Float16 select(Mask16 m, Float16 a, Float16 b) noexcept {
    return {_mm512_mask_blend_ps(m.m, b.v, a.v)};
}
AXG_HD Mask16 either(Mask16 a, Mask16 b) noexcept {
    return {static_cast<__mmask16>(a.m | b.m)};
}
AXG_HD Mask16 both(Mask16 a, Mask16 b) noexcept {
    return {static_cast<__mmask16>(a.m & b.m)};
}
AXG_HD bool all(Mask16 m) noexcept {
    return m.m == 0xffffU;
}

template <>
struct Traits<Float16> {
    using Mask = Mask16;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;
    AXG_HD static Float16 of(double c) noexcept { return Float16::of(static_cast<float>(c)); }
};

}  // namespace axg::lanes
