// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/travel.hpp"

#include "core/base/sincos.hpp"

namespace axg {

Travel travel_of(const Machine& machine) {
    Travel out;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const bool is_rotary = axis.kind == AxisKind::rotary;
        const double over = is_rotary ? machine.guard.overrun_rad : machine.guard.overrun_mm;
        out.low[i] = axis.min - over;
        out.high[i] = axis.max + over;
    }
    return out;
}

JointBox travel_box(const Machine& machine) {
    const Travel travel = travel_of(machine);
    JointBox box;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        if (machine.axes[i].unlimited) {
            box.half[i] = kPi * (1 + 0x1p-40);
            continue;
        }
        box.centre[i] = 0.5 * (travel.low[i] + travel.high[i]);
        box.half[i] = 0.5 * (travel.high[i] - travel.low[i]) * (1 + 0x1p-40) + 0x1p-30;
    }
    return box;
}

bool is_in_travel(const Machine& machine, const JointPath& path, const JointBox& box) noexcept {
    bool inside = !machine.travel.proofs.empty();
    for (std::uint32_t k = 0; inside && k < path.count; ++k) {
        const std::uint32_t axis = machine.bodies[path.body[k]].joint.axis;
        // Sums are rounded to nearest: a rounding never crosses a representable number.
        inside = machine.axes[axis].unlimited ||
                 (box.centre[axis] - box.half[axis] >= machine.travel.low[axis] &&
                  box.centre[axis] + box.half[axis] <= machine.travel.high[axis]);
    }
    return inside;
}

bool is_in_travel(const Machine& machine, std::span<const double> position) noexcept {
    bool inside = true;
    for (std::size_t i = 0; inside && !machine.travel.proofs.empty() && i < machine.axes.size();
         ++i) {
        inside = machine.axes[i].unlimited ||
                 (position[i] >= machine.travel.low[i] && position[i] <= machine.travel.high[i]);
    }
    return inside;
}

}  // namespace axg
