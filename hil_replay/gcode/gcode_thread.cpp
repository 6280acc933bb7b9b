// SPDX-License-Identifier: Apache-2.0
// Lines that end where the spindle or a probe decides: G33, G33.1, G38.2 to G38.5, read to their
// programmed end. Source: LinuxCNC "G-codes"; interp_convert.cc (2.9), convert_probe.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {

/// The axes keep pace with the spindle: K is the way of each revolution.
void GcodeInterpreter::run_thread() {
    const bool is_tapping = state_.motion == 331;
    const char* const word = is_tapping ? "G33.1" : "G33";
    const double pitch = std::abs(block_->value('K'));
    if (state_.is_inverse_time || !(pitch > 0)) {
        fault(word, state_.is_inverse_time ? "conflicts with G93; write G94 before it"
                                           : "expected K, the way of each revolution, not 0");
        return;
    }
    Move there = new_move(MoveKind::line);
    const Move start = there;
    if (!set_target(there.target)) {
        return;
    }
    there.is_exact = there.is_exact || is_tapping;
    there.feed_kind = FeedKind::per_minute;
    there.feed = pitch * scale() * spindle_speed(word);
    if (!(there.feed > 0)) {
        return;
    }
    append(there);
    if (is_tapping) {
        assume("G33.1 turns round at its end");
        there.target = start.target;
        append(there);
    }
}

void GcodeInterpreter::probe() {
    constexpr double kNearestMm = 0.254;  // LinuxCNC refuses a shorter way
    const std::string word = std::string("G38.").append(std::to_string(state_.motion - 380));
    Move next = new_move(MoveKind::line);
    next.is_exact = true;
    if (state_.is_inverse_time) {
        fault(word, "conflicts with G93; write G94 before it");
        return;
    }
    if (!set_target(next.target) || !set_feed(next)) {
        return;
    }
    double square = 0;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        const double way = next.target[i] - state_.position[i];
        if (machine_.axes[i].kind == AxisKind::rotary && way != 0) {
            fault(word, machine_.axes[i].name + ": no rotary axis may turn while probing");
            return;
        }
        square += way * way;
    }
    if (square < kNearestMm * kNearestMm) {
        fault(word, "starts nearer than 0.254 mm to its end");
        return;
    }
    assume(word + " touches nothing");
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        state_.is_probed[i] = state_.is_probed[i] || next.target[i] != state_.position[i];
    }
    append(next);
}

bool GcodeInterpreter::is_unknown_arc() {
    const std::string_view letters = state_.plane == 170 ? "XY" : state_.plane == 180 ? "ZX" : "YZ";
    return std::any_of(letters.begin(), letters.end(), [this](char letter) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        return axis != kNoIndex && is_unknown_after_probe(letter, axis);
    });
}

bool GcodeInterpreter::is_unknown_after_probe(char letter, std::uint32_t axis) {
    if (!state_.is_probed[axis]) {
        return false;
    }
    fault(std::string(1, letter),
          "counts from where a probe stopped, which the machine alone "
          "knows; move the axis by an absolute word before");
    return true;
}

}  // namespace axg
