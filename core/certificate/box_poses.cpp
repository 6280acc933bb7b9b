// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/box_poses.hpp"

#include <algorithm>
#include <cmath>

#include "core/machine/kinematics.hpp"

namespace axg {

SinCos SineMemo::of(double angle_rad) noexcept {
    // The high bits of a product depend on every bit of the angle.
    const std::uint64_t mixed = __builtin_bit_cast(std::uint64_t, angle_rad) * 0x9e3779b97f4a7c15U;
    Entry& entry = entries_[mixed >> 58U];
    if (entry.angle_rad != angle_rad) {
        entry = {angle_rad, sin_cos(angle_rad)};
    }
    return entry.sines;
}

/// Of b's joints the inverse: the way from a leads down to b against them.
Pose BoxPoses::motion(std::uint32_t joint, double position) noexcept {
    const Joint& moving = machine_->bodies[task_->path.body[joint]].joint;
    const double sign = joint < task_->path.count_a ? 1 : -1;
    if (machine_->axes[moving.axis].kind == AxisKind::linear) {
        return linear_motion(moving, sign * position);
    }
    const SinCos sines = sines_.of(position);
    return rotary_motion(moving, {sign * sines.sin, sines.cos});
}

/// Moves what `pose` places.
void BoxPoses::move_by(std::uint32_t joint, double position, Pose& pose) noexcept {
    const Pose moved = motion(joint, position);
    const Joint& moving = machine_->bodies[task_->path.body[joint]].joint;
    if (machine_->axes[moving.axis].kind == AxisKind::linear) {
        for (int i = 0; i < 3; ++i) {
            pose.t[i] += moved.t[i];
        }
        return;
    }
    pose = compose(moved, pose);
}

void BoxPoses::begin(const JointBoxTask& task, const JointBox& grid, const JointBox& box,
                     std::uint32_t cut) noexcept {
    task_ = &task;
    free_count_ = 0;
    fixed_[0] = task.at_a;
    std::uint32_t all_bits = 0;
    for (std::uint32_t k = 0; k < task.path.count; ++k) {
        const std::uint32_t axis = machine_->bodies[task.path.body[k]].joint.axis;
        if ((cut >> axis & 1U) == 0) {
            move_by(k, box.centre[axis], fixed_[free_count_]);
            continue;
        }
        const double places = std::round(grid.half[axis] / box.half[axis]);
        const int bits = std::max(0, std::ilogb(places));  // 0 places where roundings are wider
        free_[free_count_++] = {k, axis, static_cast<std::uint32_t>(bits),
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

/// From a to the middle of the path.
Pose BoxPoses::right_of(const std::array<double, kAxesMax>& position) noexcept {
    Pose out = fixed_[0];
    for (std::uint32_t i = right_.begin; i < right_.end; ++i) {
        if (i != 0) {
            out = compose(fixed_[i], out);
        }
        move_by(free_[i].joint, position[free_[i].axis], out);
    }
    return out;
}

/// And on to b.
Pose BoxPoses::left_of(const std::array<double, kAxesMax>& position) noexcept {
    Pose out = fixed_[left_.begin];
    for (std::uint32_t i = left_.begin; i < left_.end; ++i) {
        move_by(free_[i].joint, position[free_[i].axis], out);
        out = compose(fixed_[i + 1], out);
    }
    return out;
}

/// The product for these positions of a half's free joints, made once as long as its place is not
/// taken by others.
template <class Product>
Pose BoxPoses::remembered(Half& half, const std::array<double, kAxesMax>& position,
                          const Product& product) noexcept {
    std::uint64_t place = 0;
    std::array<double, 4> at{};
    if (half.end - half.begin > at.size()) {
        return product(position);
    }
    for (std::uint32_t i = half.begin; i < half.end; ++i) {
        const Free& free = free_[i];
        at[i - half.begin] = position[free.axis];
        const double along = (position[free.axis] - free.low) * free.places_a_unit;
        // NaN where the grid is a point, below 0 by a rounding: any place will do.
        const bool is_inside = along >= 0 && along < 0x1p53;
        place = place << free.bits | (is_inside ? static_cast<std::uint64_t>(along) : 0);
    }
    place %= half.product.size();
    if ((half.known >> place & 1U) == 0 || half.position[place] != at) {
        half.known |= std::uint64_t{1} << place;
        half.position[place] = at;
        half.product[place] = product(position);
    }
    return half.product[place];
}

Pose BoxPoses::at(const std::array<double, kAxesMax>& position) noexcept {
    if (free_count_ == 0) {
        return fixed_[0];
    }
    const Pose right = remembered(right_, position, [this](const auto& q) { return right_of(q); });
    if (left_.begin == left_.end) {
        return compose(fixed_[free_count_], right);
    }
    return compose(remembered(left_, position, [this](const auto& q) { return left_of(q); }),
                   right);
}

}  // namespace axg
