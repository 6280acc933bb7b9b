// SPDX-License-Identifier: Apache-2.0
// Directions that prove two placed surfaces apart: a proof that a program can check which has no
// search. Source: docs/theory/program.md, "Witnesses".
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "core/collision/tree.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

inline constexpr std::uint32_t kDirectionsMax = 64;
inline constexpr std::uint32_t kWalkPairsMax = 1U << 18;  // boxes against boxes
using Directions = std::vector<Vec3f>;                    // in the frame of surface b

/// Two surfaces, a placed in the frame of b.
struct PlacedSurfaces {
    const Tree *a, *b;
    Pose pose;
};

class WitnessWalk {
  public:
    /// Whether every triangle of a is more than `r_mm` from every triangle of b, by one of the
    /// directions. Errors of rounding are below 2^-20 mm for bodies within kCoordinateMmMax.
    [[nodiscard]] bool proves(const PlacedSurfaces& at, double r_mm, const Directions& directions);

    /// Adds directions until they prove it. False: more than kDirectionsMax or kWalkPairsMax were
    /// needed, or two triangles are nearer.
    [[nodiscard]] bool complete(const PlacedSurfaces& at, double r_mm, Directions& directions);

  private:
    struct Turned {
        Vec3d in_b, in_a;
        double shift = 0, needed = 0;
    };
    bool walk(const PlacedSurfaces& at, double r_mm, Directions& directions, bool may_add);
    void add(const PlacedSurfaces& at, double r_mm, Vec3f direction);
    [[nodiscard]] bool are_apart(const Aabb& a, const Aabb& b) const noexcept;
    bool judge_leaves(const PlacedSurfaces& at, double r_mm, const TreeNode& a, const TreeNode& b,
                      Directions& directions, bool may_add);

    std::vector<Turned> turned_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open_;
};

/// From the point of a that is nearest to b, about; of unit length.
[[nodiscard]] Vec3f direction_between(const Triangle& a, const Triangle& b, const Pose& pose);

}  // namespace axg
