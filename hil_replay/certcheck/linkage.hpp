// SPDX-License-Identifier: Apache-2.0
// The joints between the two bodies of a task: where they put the surfaces, and how much nearer
// they can bring them within a box of axis positions. All in the frame of the bodies' common
// ancestor.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hil_replay/certcheck/model.hpp"

namespace axg::certcheck {

class Linkage {
  public:
    Linkage(const Model& model, const Task& task);

    /// Places the surfaces. @param position for each axis, in units; halves are exact
    void place(std::span<const double> position);
    /// Surface of body a (0) or b (1) to the common frame.
    [[nodiscard]] const Pose& pose(std::size_t side) const { return pose_[side]; }
    /// An upper bound of what the distance loses, mm, when each axis leaves its place by at most
    /// half_width units.
    [[nodiscard]] double motion(std::span<const double> half_width) const;

  private:
    struct Joint {
        std::size_t axis;
        bool is_rotary;
        double unit;
        Vector direction, pivot;  // machine coordinates, axes at 0
        Vector along, point;      // as placed
    };
    using Row = std::vector<const Joint*>;  // neighbours, from one body to the other

    [[nodiscard]] double distance_max(const Joint& joint, std::size_t side) const;
    [[nodiscard]] std::vector<double> levers(const Row& row, std::size_t side,
                                             std::span<const double> half_width) const;
    static double shift(const Row& group, std::span<const double> half_width);
    static Interval turn_shift(const Joint& joint, double lever,
                               std::span<const double> half_width);

    std::array<const Surface*, 2> surface_;
    std::array<Pose, 2> at_, pose_;
    std::array<std::vector<Joint>, 2> chain_;  // from the common ancestor outwards
};

}  // namespace axg::certcheck
