// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/linkage.hpp"

namespace axg::certcheck {
namespace {

// A placement keeps lengths up to 1e-9 in each entry of R^T R (read_model.cpp), so R is no longer
// than this.
constexpr double kPlacementNorm = 1 + 1e-8;

double distance(const Vector& from, const Vector& point, const Vector& along) {
    return length(cross(from - point, along)).high;
}

/// The turn by an angle about the line through the pivot (Rodrigues), along of length 1.
Pose turn(double angle, const Vector& along, const Vector& pivot) {
    const auto [sine, cosine] = sine_cosine(angle);
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        pose.row[i] = ((1 - cosine) * along[i]) * along;
        pose.row[i][i] = pose.row[i][i] + cosine;
        pose.row[i][j] = pose.row[i][j] - sine * along[k];
        pose.row[i][k] = pose.row[i][k] + sine * along[j];
    }
    pose.shift = pivot - turned(pose, pivot);
    return pose;
}

}  // namespace

Linkage::Linkage(const Model& model, const Task& task) {
    std::array<std::vector<int>, 2> up;  // bodies up to the machine's frame
    for (std::size_t side = 0; side < 2; ++side) {
        for (int body = task.body[side]; body >= 0;
             body = model.bodies[static_cast<std::size_t>(body)].parent) {
            up[side].push_back(body);
        }
        surface_[side] = &model.surfaces[task.surface[side]];
        at_[side] = task.at[side];
    }
    while (!up[0].empty() && !up[1].empty() && up[0].back() == up[1].back()) {
        up[0].pop_back();
        up[1].pop_back();
    }
    for (std::size_t side = 0; side < 2; ++side) {
        for (auto each = up[side].rbegin(); each != up[side].rend(); ++each) {
            const Body& body = model.bodies[static_cast<std::size_t>(*each)];
            if (body.axis >= 0) {
                const auto axis = static_cast<std::size_t>(body.axis);
                chain_[side].push_back({axis,
                                        model.axes[axis].is_rotary,
                                        model.axes[axis].unit,
                                        body.direction,
                                        body.pivot,
                                        {},
                                        {}});
            }
        }
    }
}

void Linkage::place(std::span<const double> position) {
    for (std::size_t side = 0; side < 2; ++side) {
        Pose pose;
        for (Joint& joint : chain_[side]) {
            const double moved = position[joint.axis] * joint.unit;  // exact: a power of two
            joint.along = turned(pose, joint.direction);
            joint.point = placed(pose, joint.pivot);
            Pose step;
            if (joint.is_rotary) {
                step = turn(moved, joint.direction, joint.pivot);
            } else {
                step.shift = moved * joint.direction;
            }
            pose = pose * step;
        }
        pose_[side] = pose * at_[side];
    }
}

/// The largest distance of a surface from a joint's axis, as placed: by the corners of its box, for
/// a distance from a line is convex, or by the ball around its middle.
double Linkage::distance_max(const Joint& joint, std::size_t side) const {
    const Surface& surface = *surface_[side];
    const Vector& box = surface.tree.box(surface.tree.top());
    double by_box = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Vector at;
        for (unsigned i = 0; i < 3; ++i) {
            at[i] = (corner >> i & 1U) != 0 ? box[i].high : box[i].low;
        }
        by_box = std::max(by_box, distance(placed(pose_[side], at), joint.point, joint.along));
    }
    const Interval by_ball =
        distance(placed(pose_[side], surface.middle), joint.point, joint.along) +
        kPlacementNorm * Interval(surface.radius);
    return std::min(by_box, by_ball.high);
}

/// |sum of m_i d_i| for |m_i| <= w_i, where no joint between them turns the directions.
double Linkage::shift(const Row& group, std::span<const double> half_width) {
    Interval sum;
    for (const Joint* one : group) {
        for (const Joint* other : group) {
            const Interval product = dot(one->direction, other->direction);
            sum = sum + Interval(half_width[one->axis] * one->unit) *
                            Interval(half_width[other->axis] * other->unit) *
                            std::max(-product.low, product.high);
        }
    }
    return root(sum).high;
}

/// For each rotary joint of a row that begins at a surface, the largest distance of the surface
/// from the joint's axis in the box: that as placed, and what the joints before it in the row add.
std::vector<double> Linkage::levers(const Row& row, std::size_t side,
                                    std::span<const double> half_width) const {
    std::vector<double> levers(row.size());
    Interval moved;
    Row group;
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (!row[i]->is_rotary) {
            group.push_back(row[i]);
            continue;
        }
        moved = moved + shift(group, half_width);
        group.clear();
        levers[i] = (moved + distance_max(*row[i], side)).high;
        moved = moved + turn_shift(*row[i], levers[i], half_width);
    }
    return levers;
}

/// The chord of a turn: 2 L sin(w / 2).
Interval Linkage::turn_shift(const Joint& joint, double lever, std::span<const double> half_width) {
    return 2 * Interval(lever) * sine_of_half(half_width[joint.axis] * joint.unit);
}

double Linkage::motion(std::span<const double> half_width) const {
    if (surface_[0]->tree.triangles().empty() || surface_[1]->tree.triangles().empty()) {
        return 0;  // nothing that could come near
    }
    Row row;
    for (auto each = chain_[0].rbegin(); each != chain_[0].rend(); ++each) {
        row.push_back(&*each);
    }
    for (const Joint& joint : chain_[1]) {
        row.push_back(&joint);
    }
    const std::vector<double> of_a = levers(row, 0, half_width);
    const std::vector<double> of_b = levers({row.rbegin(), row.rend()}, 1, half_width);
    Interval moved;
    Row group;
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (!row[i]->is_rotary) {
            group.push_back(row[i]);
            continue;
        }
        moved = moved + shift(group, half_width);
        group.clear();
        const double lever = std::min(of_a[i], of_b[row.size() - 1 - i]);
        moved = moved + turn_shift(*row[i], lever, half_width);
    }
    return (moved + shift(group, half_width)).high;
}

}  // namespace axg::certcheck
