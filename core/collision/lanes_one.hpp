// SPDX-License-Identifier: Apache-2.0
// One float lane: the traversal's box tests as a thread of a GPU runs them, and as any processor
// can, slowly. Bit for bit what the wide lanes give.
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"
#include "core/collision/lanes.hpp"

namespace axg::lanes {

struct Mask1 {
    bool m;

    AXG_HD std::uint32_t bits() const noexcept { return m ? 1U : 0U; }
};

struct Float1 {
    float v;
    static constexpr unsigned kWidth = 1;

    AXG_HD static Float1 load(const float* p) noexcept { return {*p}; }
    AXG_HD static Float1 of(float c) noexcept { return {c}; }
    AXG_HD void store(float* p) const noexcept { *p = v; }
    AXG_HD static Float1 pick(const float* table, const std::uint8_t* index) noexcept {
        return {table[*index]};
    }
    AXG_HD float least() const noexcept { return v; }
    AXG_HD float most() const noexcept { return v; }
};

AXG_HD Float1 operator+(Float1 a, Float1 b) noexcept {
    return {a.v + b.v};
}
AXG_HD Float1 operator-(Float1 a, Float1 b) noexcept {
    return {a.v - b.v};
}
AXG_HD Float1 operator*(Float1 a, Float1 b) noexcept {
    return {a.v * b.v};
}
AXG_HD Float1 operator/(Float1 a, Float1 b) noexcept {
    return {a.v / b.v};
}
AXG_HD Float1 operator-(Float1 a) noexcept {
    return {-a.v};
}
AXG_HD Float1 min(Float1 a, Float1 b) noexcept {
    return {lanes::min(a.v, b.v)};
}
AXG_HD Float1 max(Float1 a, Float1 b) noexcept {
    return {lanes::max(a.v, b.v)};
}
AXG_HD Float1 abs(Float1 a) noexcept {
    return {lanes::abs(a.v)};
}
AXG_HD Float1 fma(Float1 a, Float1 b, Float1 c) noexcept {
    return {lanes::fma(a.v, b.v, c.v)};
}
AXG_HD Float1 sqrt(Float1 a) noexcept {
    return {lanes::sqrt(a.v)};
}
AXG_HD Mask1 greater(Float1 a, Float1 b) noexcept {
    return {a.v > b.v};
}
AXG_HD Float1 select(Mask1 m, Float1 a, Float1 b) noexcept {
    return m.m ? a : b;
}
AXG_HD Mask1 either(Mask1 a, Mask1 b) noexcept {
    return {a.m || b.m};
}
AXG_HD Mask1 both(Mask1 a, Mask1 b) noexcept {
    return {a.m && b.m};
}
AXG_HD bool all(Mask1 m) noexcept {
    return m.m;
}

template <>
struct Traits<Float1> {
    using Mask = Mask1;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;
    AXG_HD static Float1 of(double c) noexcept { return Float1::of(static_cast<float>(c)); }
};

}  // namespace axg::lanes
