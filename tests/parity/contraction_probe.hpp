// SPDX-License-Identifier: Apache-2.0
// What a translation unit makes of a product and a sum: 0 where each is rounded, the rounding error
// of the product where a compiler fused them. All inlined: a copy left over could be taken for
// another unit's.
#pragma once

#include "core/base/host_device.hpp"
#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"

namespace axg::test {

/// a * b + c is 0 rounded twice and not 0 rounded once: c is -(a * b), rounded.
struct ProbeInput {
    float a = 1 + 0x1p-12F, b = 1 + 0x1p-12F, c = -(1 + 0x1p-11F);
    double wide_a = 1 + 0x1p-27, wide_b = 1 + 0x1p-27, wide_c = -(1 + 0x1p-26);
};

struct Probe {
    float plain = 0;
    double plain_double = 0;
    float of_vectors = 0;    // core/base/vec3.hpp, dot
    double of_rotation = 0;  // core/base/pose.hpp, rotate
    float of_lanes = 0;      // the lanes of this unit, product and sum
    float fused = 0;         // and where fusion is written out: never 0
};

AXG_HD void probe_scalars(const ProbeInput& in, Probe& out) {
    out.plain = in.a * in.b + in.c;
    out.plain_double = in.wide_a * in.wide_b + in.wide_c;
    out.of_vectors = dot(Vec3f{in.a, in.c, 0}, Vec3f{in.b, 1, 0});
    Pose turn;
    turn.r[0][0] = in.wide_a;
    turn.r[0][1] = in.wide_c;
    out.of_rotation = rotate(turn, {in.wide_b, 1, 0}).x;
    out.fused = __builtin_fmaf(in.a, in.b, in.c);
}

template <class V>
AXG_HD void probe_lanes(const ProbeInput& in, Probe& out) {
    float all[V::kWidth];
    (V::of(in.a) * V::of(in.b) + V::of(in.c)).store(all);
    out.of_lanes = all[0];
    fma(V::of(in.a), V::of(in.b), V::of(in.c)).store(all);
    out.fused = all[0];
}

// One unit for each way in which this build compiles: as everything, as the lane kernels, and as
// nothing may be compiled but the laboratory's fused methods.
[[nodiscard]] Probe probe_baseline(const ProbeInput& in);
[[nodiscard]] Probe probe_avx2(const ProbeInput& in);
[[nodiscard]] Probe probe_avx512(const ProbeInput& in);
[[nodiscard]] Probe probe_on(const ProbeInput& in);

}  // namespace axg::test
