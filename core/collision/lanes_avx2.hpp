// SPDX-License-Identifier: Apache-2.0
// Eight float lanes on AVX2 with FMA. Included by one translation unit compiled for it.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "core/collision/lanes.hpp"

namespace axg::lanes {

struct Float8 {
    __m256 v;
    static constexpr unsigned kWidth = 8;

    AXG_HD static Float8 load(const float* p) noexcept { return {_mm256_loadu_ps(p)}; }
    AXG_HD static Float8 of(float c) noexcept { return {_mm256_set1_ps(c)}; }
    AXG_HD void store(float* p) const noexcept { _mm256_storeu_ps(p, v); }
    /// table[index[lane]] out of 32 entries.
    AXG_HD static Float8 pick(const float* table, const std::uint8_t* index) noexcept {
        const __m256i at =
            _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(index)));
        return {_mm256_i32gather_ps(table, at, 4)};
    }
    /// Least of all lanes; a zero, also of most(), may have either sign.
    AXG_HD float least() const noexcept {
        __m128 m = _mm_min_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
        m = _mm_min_ps(m, _mm_movehl_ps(m, m));
        return _mm_cvtss_f32(_mm_min_ss(m, _mm_movehdup_ps(m)));
    }
    AXG_HD float most() const noexcept {
        __m128 m = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
        m = _mm_max_ps(m, _mm_movehl_ps(m, m));
        return _mm_cvtss_f32(_mm_max_ss(m, _mm_movehdup_ps(m)));
    }
};
struct Mask8 {
    __m256 m;

    AXG_HD std::uint32_t bits() const noexcept {
        return static_cast<std::uint32_t>(_mm256_movemask_ps(m));
    }
};

AXG_HD Float8 operator+(Float8 a, Float8 b) noexcept {
    return {_mm256_add_ps(a.v, b.v)};
}
AXG_HD Float8 operator-(Float8 a, Float8 b) noexcept {
    return {_mm256_sub_ps(a.v, b.v)};
}
AXG_HD Float8 operator*(Float8 a, Float8 b) noexcept {
    return {_mm256_mul_ps(a.v, b.v)};
}
AXG_HD Float8 operator/(Float8 a, Float8 b) noexcept {
    return {_mm256_div_ps(a.v, b.v)};
}
AXG_HD Float8 operator-(Float8 a) noexcept {
    return {_mm256_xor_ps(a.v, _mm256_set1_ps(-0.0F))};
}
AXG_HD Float8 min(Float8 a, Float8 b) noexcept {
    return {_mm256_min_ps(a.v, b.v)};
}
AXG_HD Float8 max(Float8 a, Float8 b) noexcept {
    return {_mm256_max_ps(a.v, b.v)};
}
AXG_HD Float8 abs(Float8 a) noexcept {
    return {_mm256_andnot_ps(_mm256_set1_ps(-0.0F), a.v)};
}
AXG_HD Float8 fma(Float8 a, Float8 b, Float8 c) noexcept {
    return {_mm256_fmadd_ps(a.v, b.v, c.v)};
}
AXG_HD Float8 sqrt(Float8 a) noexcept {
    return {_mm256_sqrt_ps(a.v)};
}
AXG_HD Mask8 greater(Float8 a, Float8 b) noexcept {
    return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)};
}
AXG_HD Float8 select(Mask8 m, Float8 a, Float8 b) noexcept {
    return {_mm256_blendv_ps(b.v, a.v, m.m)};
}
AXG_HD Mask8 either(Mask8 a, Mask8 b) noexcept {
    return {_mm256_or_ps(a.m, b.m)};
}
AXG_HD Mask8 both(Mask8 a, Mask8 b) noexcept {
    return {_mm256_and_ps(a.m, b.m)};
}
AXG_HD bool all(Mask8 m) noexcept {
    return _mm256_movemask_ps(m.m) == 0xff;
}

template <>
struct Traits<Float8> {
    using Mask = Mask8;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;
    AXG_HD static Float8 of(double c) noexcept { return Float8::of(static_cast<float>(c)); }
};

}  // namespace axg::lanes
