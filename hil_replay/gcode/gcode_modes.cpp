// SPDX-License-Identifier: Apache-2.0
// M70 to M73: modes saved and restored, each subroutine its own. Source: LinuxCNC "M-codes";
// interp_convert.cc (2.9), restore_settings.
#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {

using enum ModalGroup;

void GcodeInterpreter::save_modes() {
    const std::int32_t code = block_->code(saving);
    std::optional<SavedModes>& saved = saved_modes_.back();
    if (code == 700 || code == 730) {
        saved = SavedModes{state_, code == 730 && saved_modes_.size() > 1};
    } else if (code == 710) {
        saved.reset();
    } else if (code == 720 && saved) {
        restore_modes(saved->state);
    } else if (code == 720) {
        fault("M72", "no modes are saved here; write M70 before it, in the same subroutine");
    }
}

void GcodeInterpreter::set_call_depth(std::size_t depth, std::uint32_t line) {
    GcodeBlock returning;
    returning.line = line;
    returning.codes.fill(-1);
    block_ = &returning;
    while (saved_modes_.size() > depth + 1) {
        if (saved_modes_.back() && saved_modes_.back()->is_for_return) {
            restore_modes(saved_modes_.back()->state);
        }
        saved_modes_.pop_back();
    }
    saved_modes_.resize(depth + 1);
    block_ = nullptr;
}

/// The motion mode is not restored, as in LinuxCNC. Its G43 and G92.3 would count from the tool and
/// the offset of now.
void GcodeInterpreter::restore_modes(const GcodeState& saved) {
    if (cutter_.is_on()) {
        fault("M72", "modes are restored under cutter compensation; write G40 before it");
        return;
    }
    if (is_nurbs_open()) {
        fault("M72", "modes are restored between G5.2 and G5.3; write G5.3 before it");
        state_.spline.is_refused = true;
        return;
    }
    state_.spline.has_tangent = false;
    if (saved.tool_offset != state_.tool_offset || saved.local_offset != state_.local_offset ||
        saved.control != state_.control) {
        fault("M72", "the tool offset, G52 or G92 changed since M70 or M73; write their words");
        return;
    }
    const double rotation_before_rad = rotation_rad();
    state_.plane = saved.plane;
    state_.is_inch = saved.is_inch;
    state_.is_unit_of_start = saved.is_unit_of_start;
    state_.is_incremental = saved.is_incremental;
    state_.has_absolute_centers = saved.has_absolute_centers;
    state_.is_inverse_time = saved.is_inverse_time;
    state_.is_per_revolution = saved.is_per_revolution;
    state_.feed = saved.feed;
    state_.feed_scale = saved.feed_scale;
    state_.is_feed_in_start_unit = saved.is_feed_in_start_unit;
    state_.spindle_rev_min = saved.spindle_rev_min;
    state_.has_surface_speed = saved.has_surface_speed;
    state_.is_exact = saved.is_exact;
    state_.blend_mm = saved.blend_mm;
    state_.work_offset = saved.work_offset;
    state_.retracts_to_r = saved.retracts_to_r;
    check_rotation(rotation_before_rad);
}

}  // namespace axg
