// SPDX-License-Identifier: Apache-2.0
// Proves that two triangles of a pair are within a distance of each other everywhere in a joint
// box: the other side of core/certificate/joint_box_proof.hpp. Offline. mm.
// Source: docs/theory/travel.md, "Exclusions".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/certificate/joint_box_proof.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// A distance that two triangles never exceed in a box.
struct NearBound {
    double mm = 0;
    std::uint32_t widest_axis = kNoIndex;  // the best axis to split; kNoIndex: none
};

/// Bounds over one box; the poses at its corners are computed once for all triangles.
class NearBox {
  public:
    /// @param task  bodies, places and path of the pair; without pieces. All references must
    /// outlive this
    NearBox(const Machine& machine, const JointBoxTask& task, const JointBox& box);

    /// Infinite: more than six linear axes are between the bodies.
    [[nodiscard]] NearBound bound(const Triangle& a, const Triangle& b) const;

    [[nodiscard]] std::span<const Pose> moved() const noexcept { return moved_; }

  private:
    const Machine& machine_;
    const JointBoxTask& task_;
    JointBox box_;
    std::array<double, kAxesMax> turns_{};   // half widths, 0 for a linear axis
    std::array<Pose, kBodiesMax> moved_{};   // at the centre
    std::uint32_t longest_axis_ = kNoIndex;  // the linear one with the largest half width
    std::vector<Pose> corners_;              // a's frame to b's
};

/// The distance of two points of the triangles, about the least: an upper bound of theirs.
/// @param pose  a's frame to b's
[[nodiscard]] double near_points_mm(const Triangle& a, const Triangle& b,
                                    const Pose& pose) noexcept;

}  // namespace axg
