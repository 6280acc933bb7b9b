// SPDX-License-Identifier: Apache-2.0
// One float lane whose axis loops a device compiler does not unroll, to measure the effect of
// unrolling. Returns the same bits as float.
#pragma once

#include "core/base/host_device.hpp"
#include "core/collision/lanes.hpp"

namespace axg::lanes {

struct RolledFloat {
    float v;
};

template <>
inline constexpr int kUnrollTo<RolledFloat> = 1;

AXG_HD RolledFloat operator+(RolledFloat a, RolledFloat b) noexcept {
    return {a.v + b.v};
}
AXG_HD RolledFloat operator-(RolledFloat a, RolledFloat b) noexcept {
    return {a.v - b.v};
}
AXG_HD RolledFloat operator*(RolledFloat a, RolledFloat b) noexcept {
    return {a.v * b.v};
}
AXG_HD RolledFloat operator/(RolledFloat a, RolledFloat b) noexcept {
    return {a.v / b.v};
}
AXG_HD RolledFloat operator-(RolledFloat a) noexcept {
    return {-a.v};
}
AXG_HD RolledFloat min(RolledFloat a, RolledFloat b) noexcept {
    return {lanes::min(a.v, b.v)};
}
AXG_HD RolledFloat max(RolledFloat a, RolledFloat b) noexcept {
    return {lanes::max(a.v, b.v)};
}
AXG_HD RolledFloat abs(RolledFloat a) noexcept {
    return {lanes::abs(a.v)};
}
AXG_HD RolledFloat fma(RolledFloat a, RolledFloat b, RolledFloat c) noexcept {
    return {lanes::fma(a.v, b.v, c.v)};
}
AXG_HD RolledFloat sqrt(RolledFloat a) noexcept {
    return {lanes::sqrt(a.v)};
}
AXG_HD bool greater(RolledFloat a, RolledFloat b) noexcept {
    return a.v > b.v;
}
AXG_HD RolledFloat select(bool m, RolledFloat a, RolledFloat b) noexcept {
    return m ? a : b;
}

template <>
struct Traits<RolledFloat> {
    using Mask = bool;
    static constexpr float kUnit = 0x1p-24F;
    static constexpr float kTiny = 0x1p-100F;
    AXG_HD static RolledFloat of(double c) noexcept { return {static_cast<float>(c)}; }
};

}  // namespace axg::lanes
