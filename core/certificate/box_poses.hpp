// SPDX-License-Identifier: Apache-2.0
// Poses of one pair at many positions that differ in few axes, like the boxes of a grid. Multiplies
// the poses of the other joints once and splits the rest into two halves, so that positions share
// factors. Double, no allocation. Source: docs/theory/certificate.md, "Levers once".
#pragma once

#include <array>
#include <cstdint>

#include "core/base/pose.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"
#include "core/machine/pose_product.hpp"

namespace axg {

/// Sines of the angles used last. Needs its constructor: zeroed memory would give a wrong sine.
class SineMemo {
  public:
    SineMemo() noexcept { entries_.fill({0, {0, 1}}); }
    [[nodiscard]] SinCos of(double angle_rad) noexcept;

  private:
    struct Entry {
        double angle_rad;
        SinCos sines;
    };
    std::array<Entry, 64> entries_;
};

class BoxPoses {
  public:
    explicit BoxPoses(const Machine& machine) noexcept : machine_(&machine) {}

    /// Prepares poses of this pair at the centres of boxes cut from `grid` like `box`.
    /// @param cut  the axes along which they were cut, one bit each
    /// Cost: one product for each joint of the path.
    void begin(const JointBoxTask& task, const JointBox& grid, const JointBox& box,
               std::uint32_t cut) noexcept;

    /// a's mesh frame in b's, at such a position. Cost: one product; if the memo lacks factors, one
    /// more for each free joint and each run of fixed ones.
    [[nodiscard]] Pose at(const std::array<double, kAxesMax>& position) noexcept;

    /// The factors that `at` multiplies; axis() returns the axis of each of its joints.
    [[nodiscard]] PoseProduct product() const noexcept {
        return {joints_.data(), fixed_.data(), free_count_, right_.end};
    }
    [[nodiscard]] std::uint32_t axis(std::uint32_t joint) const noexcept {
        return free_[joint].axis;
    }

  private:
    /// Maps a free joint's position to one of 2^bits places.
    struct Places {
        std::uint32_t axis;
        std::uint32_t bits;
        double low, places_a_unit;
    };
    /// Products of the free joints of one half of the path.
    struct Half {
        std::uint32_t begin, end;  // free joints
        std::uint64_t known;       // places that hold a product, one bit each
        std::array<std::array<double, 4>, 64> position;
        std::array<Pose, 64> product;
    };

    template <class Product>
    [[nodiscard]] Pose remembered(Half& half, const std::array<double, kAxesMax>& position,
                                  const Product& product) noexcept;

    const Machine* machine_;
    SineMemo sines_;
    std::uint32_t free_count_ = 0;
    std::array<Places, kPathMax> free_{};
    std::array<PathJoint, kPathMax> joints_{};  // the free joints
    std::array<Pose, kPathMax + 1> fixed_{};    // right of free joint i, up to free joint i - 1
    Half right_{}, left_{};
};

}  // namespace axg
