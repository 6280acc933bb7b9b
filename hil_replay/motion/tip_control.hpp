// SPDX-License-Identifier: Apache-2.0
// Tool centre point control: converts programmed positions of the tip in the part's frame to axis
// positions and back, with the machine's tree of joints. Units: mm, rad. docs/reference/gcode.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/motion/jet.hpp"

namespace axg {

using AxisPositions = std::array<double, kAxesMax>;  // mm or rad, in Machine::axes order

/// Below this spread X, Y and Z count as dependent: in the worst direction the axes then move 20
/// times as far as the tip.
inline constexpr double kSpreadMin = 0.05;

/// A commanded position contains X Y Z in the part's frame and the positions of all other axes.
/// With all rotary axes at zero it equals the axis positions, as without control: it includes the
/// tool offset, and the tip is displaced by commanded less offset from the spindle nose of the zero
/// pose.
class TipControl {
  public:
    /// Finds the axes that move the part and those that move the tool.
    /// @param part  the body that carries the part; empty: the one that the most axes move
    /// @return      empty on success, else what the machine lacks
    [[nodiscard]] static std::string make(const Machine& machine, const std::string& part,
                                          TipControl& out);

    void set_tool_offset(const AxisPositions& offset);

    /// Whether the tool offsets are equal. Precondition: both are for the same machine.
    friend bool operator==(const TipControl& a, const TipControl& b) noexcept {
        return a.offset_mm_ == b.offset_mm_;
    }

    /// Scalar: double, or Jet for the derivatives along a path.
    template <class Scalar>
    void axes_at(const std::array<Scalar, kAxesMax>& commanded,
                 std::array<Scalar, kAxesMax>& axes) const noexcept;

    /// The commanded position that corresponds to these axis positions.
    [[nodiscard]] AxisPositions commanded_at(const AxisPositions& axes) const noexcept;

    /// How independently X Y Z move the tip at these rotary positions: 1 if their directions are
    /// perpendicular to each other, 0 if they are linearly dependent.
    [[nodiscard]] double spread_at(const AxisPositions& commanded) const noexcept;

    [[nodiscard]] bool is_tip_axis(std::uint32_t axis) const noexcept {
        return axis == tip_axes_[0] || axis == tip_axes_[1] || axis == tip_axes_[2];
    }

  private:
    /// One joint on the path from the machine's frame to the part or the tool.
    struct Link {
        std::uint32_t axis = 0;
        bool is_rotary = false;
        std::size_t tip_axis = 3;  // 0 to 2: X Y Z; 3: another one
        Vec3d direction, pivot_mm;
    };
    /// A point of a body, and how X Y Z move it.
    template <class Scalar>
    struct Moved {
        Vec3<Scalar> point;
        std::array<Vec3<Scalar>, 3> columns{};
    };

    template <class Scalar>
    [[nodiscard]] static Moved<Scalar> move(const std::vector<Link>& links,
                                            const std::array<Scalar, kAxesMax>& axes,
                                            const Vec3<Scalar>& point) noexcept;
    [[nodiscard]] static std::vector<Link> links_to(const Machine& machine, std::uint32_t body,
                                                    const std::array<std::uint32_t, 3>& tip_axes);
    template <class Scalar>
    [[nodiscard]] Vec3<Scalar> part_point(
        const std::array<Scalar, kAxesMax>& commanded) const noexcept;

    std::vector<Link> part_, tool_;  // from the machine's frame outwards
    std::array<std::uint32_t, 3> tip_axes_{};
    std::array<Vec3d, 3> directions_{};  // of the tip in the part's frame, at the zero pose
    Vec3d nose_mm_, tip_mm_;             // at the zero pose, in machine coordinates
    std::array<double, 3> offset_mm_{};  // of the tool, along X Y Z
    std::uint32_t axis_count_ = 0;
};

namespace detail {

template <class Scalar>
Vec3<Scalar> constant(Vec3d v) noexcept {
    return {Scalar(v.x), Scalar(v.y), Scalar(v.z)};
}

/// Rodrigues' formula.
template <class Scalar>
Vec3<Scalar> turn(Vec3d direction, const SinCosOf<Scalar>& angle, const Vec3<Scalar>& v) noexcept {
    const Vec3<Scalar> d = constant<Scalar>(direction);
    return angle.cos * v + angle.sin * cross(d, v) + ((Scalar(1) - angle.cos) * dot(d, v)) * d;
}

}  // namespace detail

template <class Scalar>
TipControl::Moved<Scalar> TipControl::move(const std::vector<Link>& links,
                                           const std::array<Scalar, kAxesMax>& axes,
                                           const Vec3<Scalar>& point) noexcept {
    Moved<Scalar> out{point, {}};
    std::array<bool, 3> has_column{};
    for (std::size_t i = links.size(); i-- > 0;) {
        const Link& link = links[i];
        if (link.is_rotary) {
            const SinCosOf<Scalar> angle = sin_cos_of(axes[link.axis]);
            const Vec3<Scalar> pivot = detail::constant<Scalar>(link.pivot_mm);
            out.point = pivot + detail::turn(link.direction, angle, out.point - pivot);
            for (std::size_t k = 0; k < 3; ++k) {
                if (has_column[k]) {
                    out.columns[k] = detail::turn(link.direction, angle, out.columns[k]);
                }
            }
        } else if (link.tip_axis < 3) {
            has_column[link.tip_axis] = true;
            out.columns[link.tip_axis] =
                out.columns[link.tip_axis] + detail::constant<Scalar>(link.direction);
        } else {
            out.point = out.point + axes[link.axis] * detail::constant<Scalar>(link.direction);
        }
    }
    return out;
}

template <class Scalar>
Vec3<Scalar> TipControl::part_point(const std::array<Scalar, kAxesMax>& commanded) const noexcept {
    Vec3<Scalar> point = detail::constant<Scalar>(nose_mm_);
    for (std::size_t k = 0; k < 3; ++k) {
        point = point + (commanded[tip_axes_[k]] - Scalar(offset_mm_[k])) *
                            detail::constant<Scalar>(directions_[k]);
    }
    return point;
}

template <class Scalar>
void TipControl::axes_at(const std::array<Scalar, kAxesMax>& commanded,
                         std::array<Scalar, kAxesMax>& axes) const noexcept {
    const Moved<Scalar> part = move(part_, commanded, part_point(commanded));
    const Moved<Scalar> tool = move(tool_, commanded, detail::constant<Scalar>(tip_mm_));
    // Solves for the X Y Z at which both points coincide, with Cramer's rule.
    std::array<Vec3<Scalar>, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
        c[k] = tool.columns[k] - part.columns[k];
    }
    const Vec3<Scalar> way = part.point - tool.point;
    const Vec3<Scalar> yz = cross(c[1], c[2]);
    const Scalar scale = Scalar(1) / dot(c[0], yz);
    axes = commanded;
    axes[tip_axes_[0]] = dot(way, yz) * scale;
    axes[tip_axes_[1]] = dot(way, cross(c[2], c[0])) * scale;
    axes[tip_axes_[2]] = dot(way, cross(c[0], c[1])) * scale;
}

}  // namespace axg
