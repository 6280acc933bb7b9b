// SPDX-License-Identifier: Apache-2.0
// Rigid placement p' = R p + t in double, mm. R row by row. Composed on the host only.
#pragma once

#include "core/base/host_device.hpp"
#include "core/base/vec3.hpp"

namespace axg {

struct Pose {
    double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double t[3] = {0, 0, 0};
};

AXG_HD constexpr Vec3d rotate(const Pose& p, Vec3d v) noexcept {
    return {(p.r[0][0] * v.x + p.r[0][1] * v.y) + p.r[0][2] * v.z,
            (p.r[1][0] * v.x + p.r[1][1] * v.y) + p.r[1][2] * v.z,
            (p.r[2][0] * v.x + p.r[2][1] * v.y) + p.r[2][2] * v.z};
}

AXG_HD constexpr Vec3d apply(const Pose& p, Vec3d v) noexcept {
    return rotate(p, v) + Vec3d{p.t[0], p.t[1], p.t[2]};
}

/// a * b: first b, then a.
AXG_HD constexpr Pose compose(const Pose& a, const Pose& b) noexcept {
    Pose c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            c.r[i][j] = (a.r[i][0] * b.r[0][j] + a.r[i][1] * b.r[1][j]) + a.r[i][2] * b.r[2][j];
        }
        c.t[i] = ((a.r[i][0] * b.t[0] + a.r[i][1] * b.t[1]) + a.r[i][2] * b.t[2]) + a.t[i];
    }
    return c;
}

/// The inverse of a rigid placement: the rotation is transposed, not inverted.
AXG_HD constexpr Pose inverse(const Pose& a) noexcept {
    Pose c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            c.r[i][j] = a.r[j][i];
        }
    }
    for (int i = 0; i < 3; ++i) {
        c.t[i] = -((c.r[i][0] * a.t[0] + c.r[i][1] * a.t[1]) + c.r[i][2] * a.t[2]);
    }
    return c;
}

}  // namespace axg
