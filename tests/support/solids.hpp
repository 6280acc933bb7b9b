// SPDX-License-Identifier: Apache-2.0
// Small solids for the mesh tests, built triangle by triangle, and ways to damage them.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg::test {

using Triangles = std::vector<Triangle>;

/// A box of 12 triangles, facing outwards.
inline Triangles box(Vec3f low, Vec3f high) {
    std::array<Vec3f, 8> p;
    for (unsigned i = 0; i < 8; ++i) {
        p[i] = {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y,
                (i & 4U) != 0 ? high.z : low.z};
    }
    constexpr std::array<std::array<unsigned, 4>, 6> kSides{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    Triangles out;
    for (const auto& s : kSides) {
        out.push_back({p[s[0]], p[s[1]], p[s[2]]});
        out.push_back({p[s[0]], p[s[2]], p[s[3]]});
    }
    return out;
}

inline Triangles turned_over(Triangles triangles) {
    for (Triangle& t : triangles) {
        std::swap(t.b, t.c);
    }
    return triangles;
}

inline Triangles together(Triangles a, const Triangles& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline Triangles moved(Triangles triangles, Vec3f by) {
    for (Triangle& t : triangles) {
        t = {t.a + by, t.b + by, t.c + by};
    }
    return triangles;
}

}  // namespace axg::test
