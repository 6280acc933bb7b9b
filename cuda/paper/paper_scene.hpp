// SPDX-License-Identifier: Apache-2.0
// Bodies in the format of the seed paper's kernels: two levels of axis-parallel boxes, one of the
// body and one per group of at most 32 triangles. mm, each body in its own frame. Plain data; for
// comparison only, no part of an engine.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/host_device.hpp"
#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/mesh/mesh.hpp"
#include "cuda/paper/six_eleven.hpp"

namespace axg::paper {

/// Triangles first .. first + count - 1 of a body, and the box around them.
struct SubBox {
    float c[3], h[3];
    std::uint32_t first, count;
};

struct Body {
    std::vector<Triangle> triangles;  // the mesh's, in the order of the sub-boxes
    std::vector<SubBox> boxes;        // the second level: the leaves of the engine's tree
    std::vector<SubBox> tiles;        // the same triangles, 32 each except the last
    SubBox whole{};                   // the first level
    float reach_mm = 0;               // largest |coordinate|
};

struct BodyPair {
    std::uint32_t a = 0, b = 0;  // bodies
};

struct Scene {
    std::vector<Body> bodies;
    std::vector<BodyPair> pairs;

    [[nodiscard]] std::uint64_t triangle_pairs(std::size_t pair) const {
        return std::uint64_t{bodies[pairs[pair].a].triangles.size()} *
               bodies[pairs[pair].b].triangles.size();
    }
};

/// Precondition: 1 to kTrianglesMax triangles, finite, |coordinate| <= kCoordinateMmMax.
[[nodiscard]] Body make_body(std::span<const Triangle> triangles);

/// Whether the box of x, moved by `pose`, and y do not overlap along one of y's axes. In float,
/// without a bound of the rounding, like all code here.
AXG_HD bool boxes_apart(const FloatPose& pose, const SubBox& x, const SubBox& y) noexcept {
    bool apart = false;
    for (int k = 0; k < 3; ++k) {
        const float* const r = pose.r[k];
        const float centre = ((r[0] * x.c[0] + r[1] * x.c[1]) + r[2] * x.c[2]) + pose.t[k];
        const float half = (__builtin_fabsf(r[0]) * x.h[0] + __builtin_fabsf(r[1]) * x.h[1]) +
                           __builtin_fabsf(r[2]) * x.h[2];
        apart = apart || __builtin_fabsf(centre - y.c[k]) > half + y.h[k];
    }
    return apart;
}

/// Whether a triangle, already in y's frame, is apart from y along one of y's axes.
AXG_HD bool triangle_apart(const Triangle& t, const SubBox& y) noexcept {
    const float low[3] = {least(least(t.a.x, t.b.x), t.c.x), least(least(t.a.y, t.b.y), t.c.y),
                          least(least(t.a.z, t.b.z), t.c.z)};
    const float high[3] = {most(most(t.a.x, t.b.x), t.c.x), most(most(t.a.y, t.b.y), t.c.y),
                           most(most(t.a.z, t.b.z), t.c.z)};
    bool apart = false;
    for (int k = 0; k < 3; ++k) {
        apart = apart || low[k] > y.c[k] + y.h[k] || high[k] < y.c[k] - y.h[k];
    }
    return apart;
}

/// Findings for one pair of bodies at one pose.
struct Found {
    std::uint32_t touching = 0;  // pairs of triangles not found apart
    std::uint32_t tested = 0;    // pairs of triangles that reached the test
    std::uint32_t left = 0;      // certified: pairs that the first stage did not prove apart

    friend bool operator==(const Found&, const Found&) = default;
};

}  // namespace axg::paper
