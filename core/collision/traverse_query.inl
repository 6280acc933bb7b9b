// SPDX-License-Identifier: Apache-2.0
// The numbers of one query that every engine must have to the bit: frames, slacks and margins,
// and the vertices of the recheck. mm. Part of traverse.inl and of the CUDA kernels: no include
// guard, no namespace of its own; include box_test.inl before it. Source: docs/theory/accuracy.md,
// section 4.

/// Constants of a query, computed before any node is opened.
struct QueryConstants {
    Frame a_in_b, b_in_a;
    float tight_slack;  // of tight boxes: covers their roundings, the margin and the pose's error
    float margin, d32;  // r' and d of the theorem, float; of a leaf's vertices: leaf_d
    float r_square;     // the margin's square, for the shared axes
    double margin64, d64;  // the same for the recheck
    bool has_margin;
};

AXG_HD float up(double d) noexcept {
    return static_cast<float>(d * (1.0 + 0x1p-22));
}

AXG_HD void set_frame(Frame& f, const Pose& p, double slack) noexcept {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            f.r[i][j] = static_cast<float>(p.r[i][j]);
            f.size_r[i][j] = __builtin_fabsf(f.r[i][j]);
        }
        f.t[i] = static_cast<float>(p.t[i]);
    }
    f.slack = up(slack);
}

/// Whether a query meets the requirements of the proof. NaN and infinity fail by their bits, and
/// also fail the comparisons.
AXG_HD bool usable(const Query& q) noexcept {
    bool good = is_finite(q.r_mm) && is_finite(q.pose_error_mm) && q.r_mm >= 0 &&
                q.r_mm <= kMarginMmMax && q.pose_error_mm >= 0 &&
                q.pose_error_mm <= kPoseErrorMmMax;
    for (int i = 0; i < 3; ++i) {
        good = good && is_finite(q.pose.t[i]) && is_finite(q.pose.r[i][0]) &&
               is_finite(q.pose.r[i][1]) && is_finite(q.pose.r[i][2]);
        good = good && __builtin_fabs(q.pose.t[i]) <= 4 * kCoordinateMmMax;
        for (int j = i; j < 3; ++j) {
            const double d = q.pose.r[0][i] * q.pose.r[0][j] + q.pose.r[1][i] * q.pose.r[1][j] +
                             q.pose.r[2][i] * q.pose.r[2][j] - (i == j ? 1.0 : 0.0);
            good = good && __builtin_fabs(d) <= kRigidDefectMax;
        }
    }
    return good;
}

/// @param reach_a, reach_b  largest |coordinate| of either mesh, mm
AXG_HD void set_constants(QueryConstants& c, const Query& q, float reach_a,
                          float reach_b) noexcept {
    const bool margin = q.kind != QueryKind::clearance && q.r_mm > 0;
    double t = 0;
    for (int k = 0; k < 3; ++k) {
        t = lanes::max(t, __builtin_fabs(q.pose.t[k]));
    }
    // Largest |coordinate| that can appear. The floor covers what underflow costs where every
    // coordinate is next to nothing.
    const double coordinate_mm = t + 3.0 * double(reach_a) + 2.0 * double(reach_b) + 0x1p-40;
    // Errors of any vertex of a in b's frame: arithmetic and pose. In float, leaf_d adds the part
    // that depends on the leaf.
    c.d32 = up(0x1p21 * (0x1p-43 * coordinate_mm + q.pose_error_mm)) + 0x1p-90F;
    c.d64 = 0x1p50 * (0x1p-50 * coordinate_mm + q.pose_error_mm) * (1.0 + 0x1p-50);
    c.has_margin = margin;
    const double r = lanes::max(q.r_mm, 0x1p-40);
    c.margin = up(r * (1.0 + 0x1p-20));
    c.r_square = up(r * r * (1.0 + 0x1p-17));
    c.margin64 = r * (1.0 + 0x1p-48);
    const double slack = 0x1p-17 * coordinate_mm + 2.0 * q.pose_error_mm + (margin ? q.r_mm : 0.0);
    c.tight_slack = up(0x1p-20 * coordinate_mm + 2.0 * q.pose_error_mm + (margin ? q.r_mm : 0.0));
    set_frame(c.a_in_b, q.pose, slack);
    set_frame(c.b_in_a, inverse(q.pose), slack);
}

/// Vertex coordinate of a in b's frame less the origin, double: at most 2^-50 of the coordinates in
/// error.
AXG_HD double moved_coordinate(const Pose& p, int k, double x, double y, double z,
                               double origin) noexcept {
    return lanes::fma(p.r[k][0], x,
                      lanes::fma(p.r[k][1], y, lanes::fma(p.r[k][2], z, p.t[k] - origin)));
}

/// One coordinate of a leaf's own centre in the other body's frame less an origin, rounded once.
AXG_HD float moved_centre(const Pose& p, int k, const float* centre, float origin) noexcept {
    return static_cast<float>(
        moved_coordinate(p, k, centre[0], centre[1], centre[2], static_cast<double>(origin)));
}

/// The same of a vertex, in float. x, y, z: less the leaf's centre; shift: moved_centre.
AXG_HD V moved_about(const Frame& f, int k, float shift, V x, V y, V z) noexcept {
    using lanes::fma;
    return fma(V::of(f.r[k][0]), x,
               fma(V::of(f.r[k][1]), y, fma(V::of(f.r[k][2]), z, V::of(shift))));
}

/// d of the theorem for vertices of a leaf moved so: adds 3/4 of its box's largest half width.
AXG_HD float leaf_d(float d32, const Aabb& box) noexcept {
    return lanes::fma(0.75F, lanes::max(lanes::max(box.h[0], box.h[1]), box.h[2]), d32);
}

/// One pair in double, for the recheck: un-rounded vertices, less the same origin as in float.
AXG_HD sat::TrianglePair<double> double_pair(const QueryConstants& c, const Pose& pose,
                                             const float* origin, const TreeLeaf& a, unsigned i,
                                             const TreeLeaf& b, unsigned j) noexcept {
    sat::TrianglePair<double> p;
    double most[3] = {0, 0, 0};
    for (int v = 0; v < 3; ++v) {
        double ca[3], cb[3];
        for (int k = 0; k < 3; ++k) {
            ca[k] = moved_coordinate(pose, k, a.v[3 * v][i], a.v[3 * v + 1][i], a.v[3 * v + 2][i],
                                     origin[k]);
            cb[k] = static_cast<double>(b.v[3 * v + k][j]) - origin[k];
            most[k] = lanes::max(most[k], lanes::max(lanes::abs(ca[k]), lanes::abs(cb[k])));
        }
        p.a[v] = {ca[0], ca[1], ca[2]};
        p.b[v] = {cb[0], cb[1], cb[2]};
    }
    p.scale = {sat::scale_of(most[0], c.d64), sat::scale_of(most[1], c.d64),
               sat::scale_of(most[2], c.d64)};
    return p;
}
