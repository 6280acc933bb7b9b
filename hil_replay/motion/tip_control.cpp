// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/tip_control.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

Eigen::Vector3d to_eigen(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

constexpr std::array<const char*, 3> kTipAxisNames{"X", "Y", "Z"};

/// The axes that move a body, from the machine's frame outwards.
std::vector<std::uint32_t> axes_of(const Machine& machine, std::uint32_t body) {
    std::vector<std::uint32_t> axes;
    for (std::uint32_t at = body; at != kNoIndex; at = machine.bodies[at].parent) {
        if (machine.bodies[at].joint.axis != kNoIndex) {
            axes.insert(axes.begin(), machine.bodies[at].joint.axis);
        }
    }
    return axes;
}

/// Whether the body is on the spindle's side, so that it carries no part: from the machine's frame
/// outwards, the first moved body is the same for it and for the tool.
bool is_on_tool_side(const Machine& machine, std::uint32_t body, std::uint32_t tool_body) {
    const auto first_moved = [&machine](std::uint32_t from) {
        std::uint32_t moved = kNoIndex;
        for (std::uint32_t at = from; at != kNoIndex; at = machine.bodies[at].parent) {
            moved = machine.bodies[at].joint.axis != kNoIndex ? at : moved;
        }
        return moved;
    };
    const std::uint32_t moved = first_moved(body);
    return moved != kNoIndex && moved == first_moved(tool_body);
}

/// Finds the body of the part. kNoIndex without a fault: no axis moves the part.
std::uint32_t find_part(const Machine& machine, const std::string& name, std::uint32_t tool_body,
                        std::string& fault) {
    std::uint32_t best = kNoIndex;
    for (std::uint32_t i = 0; i < machine.bodies.size(); ++i) {
        if (!name.empty() && machine.bodies[i].name == name) {
            return i;
        }
        const std::vector<std::uint32_t> axes = axes_of(machine, i);
        if (!name.empty() || axes.empty() || is_on_tool_side(machine, i, tool_body)) {
            continue;
        }
        const std::vector<std::uint32_t> most =
            best == kNoIndex ? std::vector<std::uint32_t>{} : axes_of(machine, best);
        if (axes.size() > most.size()) {
            best = i;
            fault.clear();
        } else if (axes.size() == most.size() && axes != most) {
            fault = "ambiguous body of the part: " + machine.bodies[best].name + " or " +
                    machine.bodies[i].name + ". Select one with --part BODY";
        }
    }
    if (!name.empty()) {
        fault = "--part " + name + ": the machine file has no body of this name";
    }
    return best;
}

}  // namespace

std::vector<TipControl::Link> TipControl::links_to(const Machine& machine, std::uint32_t body,
                                                   const std::array<std::uint32_t, 3>& tip_axes) {
    std::vector<Link> links;
    for (std::uint32_t at = body; at != kNoIndex; at = machine.bodies[at].parent) {
        const Joint& joint = machine.bodies[at].joint;
        if (joint.axis == kNoIndex) {
            continue;
        }
        const auto tip = std::find(tip_axes.begin(), tip_axes.end(), joint.axis);
        links.insert(links.begin(), {.axis = joint.axis,
                                     .is_rotary = machine.axes[joint.axis].kind == AxisKind::rotary,
                                     .tip_axis = static_cast<std::size_t>(tip - tip_axes.begin()),
                                     .direction = joint.direction,
                                     .pivot_mm = joint.pivot_mm});
    }
    return links;
}

std::string TipControl::make(const Machine& machine, const std::string& part, TipControl& out) {
    out = TipControl{};
    out.axis_count_ = static_cast<std::uint32_t>(machine.axes.size());
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis =
            std::find_if(machine.axes.begin(), machine.axes.end(), [k](const Axis& one) {
                return one.name == kTipAxisNames[k] && one.kind == AxisKind::linear;
            });
        if (axis == machine.axes.end()) {
            return std::string("the machine has no linear axis ") + kTipAxisNames[k];
        }
        out.tip_axes_[k] = static_cast<std::uint32_t>(axis - machine.axes.begin());
    }
    const auto tool = std::find_if(machine.bodies.begin(), machine.bodies.end(),
                                   [](const Body& body) { return body.is_tool; });
    if (tool == machine.bodies.end()) {
        return "no body of the machine file has tool: true, so that the tip is unknown";
    }
    const auto tool_body = static_cast<std::uint32_t>(tool - machine.bodies.begin());
    std::string fault;
    const std::uint32_t part_body = find_part(machine, part, tool_body, fault);
    if (!fault.empty()) {
        return fault;
    }
    out.tool_ = links_to(machine, tool_body, out.tip_axes_);
    out.part_ = links_to(machine, part_body, out.tip_axes_);
    out.nose_mm_ = {tool->at.t[0], tool->at.t[1], tool->at.t[2]};
    const AxisPositions zero{};
    const Moved<double> of_tool = move(out.tool_, zero, out.nose_mm_);
    const Moved<double> of_part = move(out.part_, zero, out.nose_mm_);
    for (std::size_t k = 0; k < 3; ++k) {
        out.directions_[k] = of_tool.columns[k] - of_part.columns[k];
    }
    out.set_tool_offset({});
    if (!(out.spread_at(zero) >= kSpreadMin)) {
        return "X, Y and Z do not move the tip in all directions, with all axes at zero";
    }
    return {};
}

void TipControl::set_tool_offset(const AxisPositions& offset) {
    tip_mm_ = nose_mm_;
    for (std::size_t k = 0; k < 3; ++k) {
        offset_mm_[k] = offset[tip_axes_[k]];
        tip_mm_ = tip_mm_ - offset_mm_[k] * directions_[k];
    }
}

AxisPositions TipControl::commanded_at(const AxisPositions& axes) const noexcept {
    // The contribution of X Y Z to a point on either side is added after all turns, as in `move`.
    const auto placed = [&axes](const Moved<double>& moved, const auto& tip_axes) {
        Vec3d point = moved.point;
        for (std::size_t k = 0; k < 3; ++k) {
            point = point + axes[tip_axes[k]] * moved.columns[k];
        }
        return point;
    };
    const Vec3d tip = placed(move(tool_, axes, tip_mm_), tip_axes_);
    // The part's frame is rigid: four of its points determine all others. X Y Z shift them alike:
    // differences without them keep their digits far from zero too.
    const Moved<double> nose = move(part_, axes, nose_mm_);
    Eigen::Matrix3d frame;
    for (int k = 0; k < 3; ++k) {
        const Vec3d ahead = nose_mm_ + directions_[static_cast<std::size_t>(k)];
        frame.col(k) = to_eigen(move(part_, axes, ahead).point - nose.point);
    }
    const Eigen::Vector3d along = frame.fullPivLu().solve(to_eigen(tip - placed(nose, tip_axes_)));
    AxisPositions commanded = axes;
    for (std::size_t k = 0; k < 3; ++k) {
        commanded[tip_axes_[k]] = along[static_cast<Eigen::Index>(k)] + offset_mm_[k];
    }
    return commanded;
}

double TipControl::spread_at(const AxisPositions& commanded) const noexcept {
    const Moved<double> part = move(part_, commanded, nose_mm_);
    const Moved<double> tool = move(tool_, commanded, tip_mm_);
    Eigen::Matrix3d ways;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        ways.col(k) = to_eigen(tool.columns[i] - part.columns[i]);
    }
    const double lengths = ways.colwise().norm().prod();
    return lengths > 0 ? std::abs(ways.determinant()) / lengths : 0.0;
}

}  // namespace axg
