// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/box_poses.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

/// Inverts the joints that carry b: the path from a passes them against their direction.
PathJoint joint_of(const Machine& machine, const JointPath& path, std::uint32_t k) noexcept {
    const Joint& moving = machine.bodies[path.body[k]].joint;
    return {moving.direction, moving.pivot_mm, k < path.count_a ? 1.0 : -1.0,
            machine.axes[moving.axis].kind == AxisKind::linear};
}

}  // namespace

SinCos SineMemo::of(double angle_rad) noexcept {
    // The high bits of a product depend on every bit of the angle.
    const std::uint64_t mixed = __builtin_bit_cast(std::uint64_t, angle_rad) * 0x9e3779b97f4a7c15U;
    Entry& entry = entries_[mixed >> 58U];
    if (entry.angle_rad != angle_rad) {
        entry = {angle_rad, sin_cos(angle_rad)};
    }
    return entry.sines;
}

void BoxPoses::begin(const JointBoxTask& task, const JointBox& grid, const JointBox& box,
                     std::uint32_t cut) noexcept {
    const auto sines = [this](double angle_rad) { return sines_.of(angle_rad); };
    free_count_ = 0;
    fixed_[0] = task.at_a;
    std::uint32_t all_bits = 0;
    for (std::uint32_t k = 0; k < task.path.count; ++k) {
        const std::uint32_t axis = machine_->bodies[task.path.body[k]].joint.axis;
        const PathJoint joint = joint_of(*machine_, task.path, k);
        if ((cut >> axis & 1U) == 0) {
            move_by(joint, box.centre[axis], sines, fixed_[free_count_]);
            continue;
        }
        const double places = std::round(grid.half[axis] / box.half[axis]);
        const int bits = std::max(0, std::ilogb(places));  // 0 places if roundings are wider
        joints_[free_count_] = joint;
        free_[free_count_++] = {axis, static_cast<std::uint32_t>(bits),
                                grid.centre[axis] - grid.half[axis],
                                0.5 * places / grid.half[axis]};
        fixed_[free_count_] = Pose{};
        all_bits += bits;
    }
    fixed_[free_count_] = compose(inverse(task.at_b), fixed_[free_count_]);
    std::uint32_t split = free_count_ == 0 ? 0 : 1;
    for (std::uint32_t bits = free_[0].bits; split < free_count_ && 2 * bits < all_bits; ++split) {
        bits += free_[split].bits;
    }
    right_.begin = 0;
    right_.end = left_.begin = split;
    left_.end = free_count_;
    right_.known = left_.known = 0;
}

/// The product for these positions of a half's free joints. Recomputes it only if another product
/// has replaced it in its place.
template <class Product>
Pose BoxPoses::remembered(Half& half, const std::array<double, kAxesMax>& position,
                          const Product& product) noexcept {
    std::uint64_t place = 0;
    std::array<double, 4> at{};
    if (half.end - half.begin > at.size()) {
        return product();
    }
    for (std::uint32_t i = half.begin; i < half.end; ++i) {
        const Places& free = free_[i];
        at[i - half.begin] = position[free.axis];
        const double along = (position[free.axis] - free.low) * free.places_a_unit;
        // NaN if the grid is a point, below 0 by a rounding: any place is valid.
        const bool is_inside = along >= 0 && along < 0x1p53;
        place = place << free.bits | (is_inside ? static_cast<std::uint64_t>(along) : 0);
    }
    place %= half.product.size();
    if ((half.known >> place & 1U) == 0 || half.position[place] != at) {
        half.known |= std::uint64_t{1} << place;
        half.position[place] = at;
        half.product[place] = product();
    }
    return half.product[place];
}

Pose BoxPoses::at(const std::array<double, kAxesMax>& position) noexcept {
    if (free_count_ == 0) {
        return fixed_[0];
    }
    const auto at = [this, &position](std::uint32_t i) { return position[free_[i].axis]; };
    const auto sines = [this](double angle_rad) { return sines_.of(angle_rad); };
    const PoseProduct p = product();
    const Pose right = remembered(right_, position, [&] { return axg::right_of(p, at, sines); });
    if (left_.begin == left_.end) {
        return compose(fixed_[free_count_], right);
    }
    return compose(remembered(left_, position, [&] { return axg::left_of(p, at, sines); }), right);
}

}  // namespace axg
