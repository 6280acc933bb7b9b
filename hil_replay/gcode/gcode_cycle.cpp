// SPDX-License-Identifier: Apache-2.0
// Canned cycles: G73, G81 to G86 and G89, with G98 and G99. The spindle is not simulated.
// Source: LinuxCNC "G-codes"; tests/oracle/rs274_test.py compares them with its interpreter.
#include <algorithm>
#include <cmath>
#include <string>

#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {
namespace {

constexpr double kPeckBackMm = 0.254;  // G73 retracts by it, G83 stops above the last depth by it
constexpr double kPecksMax = 100'000;  // of one hole

}  // namespace

/// The holes of one block. Machine coordinates, mm.
struct GcodeInterpreter::Hole {
    std::string word;
    char up_letter = 'Z';
    std::uint32_t up = kNoIndex;
    AxisPositions at{}, step{};  // of the first hole, and to the next
    double r_mm = 0, bottom_mm = 0, clear_mm = 0, peck_mm = 0;
    double feed = 0;
    int repeats = 1;
};

void GcodeInterpreter::run_cycle(std::int32_t last_motion, bool has_axis) {
    Hole hole;
    hole.word = std::string("G").append(std::to_string(state_.motion / 10));
    hole.up_letter = state_.plane == 170 ? 'Z' : state_.plane == 180 ? 'Y' : 'X';
    hole.up = axis_of_letter(machine_, hole.up_letter);
    if (!has_axis || block_->is_machine || state_.is_inverse_time) {
        fault(hole.word, !has_axis ? "expected axis words with the position of the hole"
                         : block_->is_machine
                             ? "conflicts with G53; write the position with G0 before it"
                             : "conflicts with G93; write G94 before it");
        return;
    }
    if (state_.motion == 840 && state_.plane != 170) {
        fault(hole.word,
              "LinuxCNC (2.9, 2.10) feeds along other axes in G18 and G19 than down the "
              "hole; write G1 in its place");
        return;
    }
    if (hole.up == kNoIndex || machine_.axes[hole.up].kind != AxisKind::linear) {
        fault(hole.word, std::string("the machine has no linear axis ") + hole.up_letter);
        return;
    }
    if (is_rotated() && state_.plane != 170) {
        refuse_rotated(hole.word);
        return;
    }
    if (!read_letters(hole, last_motion == state_.motion) || !read_hole(hole)) {
        return;
    }
    drill(hole);
}

bool GcodeInterpreter::read_letters(Hole& hole, bool is_same) {
    const GcodeBlock& block = *block_;
    for (const char letter : {'A', 'B', 'C', 'U', 'V', 'W', 'I', 'J', 'K'}) {
        if (block.has(letter)) {
            fault(hole.word, std::string(1, letter) + ": a cycle uses only X, Y and Z");
            return false;
        }
    }
    const bool has_dwell = state_.motion == 820 || state_.motion == 860 || state_.motion == 890;
    const bool has_peck = state_.motion == 730 || state_.motion == 830;
    CycleState& cycle = state_.cycle;
    const auto take = [&](char letter, double& kept) {
        if (!block.has(letter) && !is_same) {
            fault(hole.word, std::string("expected ") + letter);
            return false;
        }
        kept = block.value(letter, kept);
        return true;
    };
    if (!take('R', cycle.r) || !take(hole.up_letter, cycle.bottom) ||
        (has_dwell && !take('P', cycle.dwell_s)) || (has_peck && !take('Q', cycle.peck))) {
        return false;
    }
    if (state_.motion == 840) {  // while the spindle reverses; as in LinuxCNC, P of any cycle
        cycle.dwell_s = block.value('P', cycle.dwell_s);
    }
    if (!(cycle.dwell_s >= 0 && cycle.dwell_s <= 86400)) {
        fault(hole.word, "P: expected 0 to 86400 seconds");
        return false;
    }
    if (has_peck && !(cycle.peck > 0)) {
        fault(hole.word, "Q: expected the depth of a peck, above 0");
        return false;
    }
    const double repeats = block.value('L', 1);
    if (repeats != std::floor(repeats) || repeats < 1 || repeats > kPecksMax) {
        fault(hole.word, "L: expected the number of repetitions, an integer from 1");
        return false;
    }
    hole.repeats = static_cast<int>(repeats);
    return true;
}

bool GcodeInterpreter::read_hole(Hole& hole) {
    hole.feed = feed_per_minute(true);
    if (!(hole.feed > 0)) {
        return false;
    }
    const CycleState& cycle = state_.cycle;
    hole.at = state_.position;
    for (const char letter : {'X', 'Y', 'Z'}) {
        if (letter == hole.up_letter || !block_->has(letter)) {
            continue;
        }
        const std::uint32_t axis = named_axis(letter);
        if (axis == kNoIndex) {
            return false;
        }
        const double value = word_value(letter, machine_.axes[axis]);
        hole.step[axis] = state_.is_incremental ? value : 0;
        hole.at[axis] = state_.is_incremental ? hole.at[axis] : value + offset_of(axis);
    }
    if (is_rotated()) {
        const double height_mm = hole.at[hole.up];
        if (state_.is_incremental) {
            rotate(hole.step);
        } else {
            set_rotated_target(hole.at);
        }
        hole.at[hole.up] = height_mm;
    }
    // G91: R counts from the height before the row of cycles, the bottom from R.
    const double start_mm = cycle.is_in_row ? cycle.first_height_mm : state_.position[hole.up];
    const double zero = state_.is_incremental ? start_mm : offset_of(hole.up);
    hole.r_mm = cycle.r * scale() + zero;
    hole.bottom_mm = cycle.bottom * scale() + (state_.is_incremental ? hole.r_mm : zero);
    hole.peck_mm = cycle.peck * scale();
    if (hole.r_mm < hole.bottom_mm) {
        fault(hole.word, "R is below the bottom of the hole");
        return false;
    }
    const bool has_peck = state_.motion == 730 || state_.motion == 830;
    if (has_peck && hole.r_mm - hole.bottom_mm > kPecksMax * hole.peck_mm) {
        fault(hole.word, "Q: more than 100000 pecks; check the units");
        return false;
    }
    return true;
}

void GcodeInterpreter::drill(const Hole& read) {
    Hole hole = read;
    CycleState& cycle = state_.cycle;
    if (!cycle.is_in_row) {
        cycle.first_height_mm = state_.position[hole.up];
        cycle.is_in_row = true;
    }
    // As in LinuxCNC: if the height before the row is below R, the axis first rises to R in place.
    // Else it crosses at its own height or, if higher, at R (G99) or at the height before (G98).
    const double first_mm = cycle.first_height_mm;
    double height_mm =
        std::max(state_.position[hole.up], state_.retracts_to_r ? hole.r_mm : first_mm);
    if (first_mm < hole.r_mm) {
        Hole here = hole;
        here.at = state_.position;
        go_to(here, hole.r_mm, false);
        height_mm = hole.r_mm;
    }
    hole.clear_mm = state_.retracts_to_r ? hole.r_mm : std::max(first_mm, hole.r_mm);
    for (int i = 0; i < hole.repeats && !state_.has_ended; ++i) {
        for (std::size_t axis = 0; axis < hole.at.size(); ++axis) {
            hole.at[axis] += hole.step[axis];
        }
        go_to(hole, height_mm, false);
        go_to(hole, hole.r_mm, false);
        peck(hole);
        go_to(hole, hole.bottom_mm, true);
        if (state_.motion == 820 || state_.motion == 840 || state_.motion == 860 ||
            state_.motion == 890) {
            wait(cycle.dwell_s);
        }
        if (state_.motion == 850) {
            go_to(hole, hole.r_mm, true);
        }
        go_to(hole, hole.clear_mm, state_.motion == 840 || state_.motion == 890);
        height_mm = hole.clear_mm;
    }
}

void GcodeInterpreter::peck(const Hole& hole) {
    if (state_.motion != 730 && state_.motion != 830) {
        return;
    }
    for (double depth_mm = hole.r_mm - hole.peck_mm; depth_mm > hole.bottom_mm && !state_.has_ended;
         depth_mm -= hole.peck_mm) {
        go_to(hole, depth_mm, true);
        if (state_.motion == 830) {
            go_to(hole, hole.r_mm, false);
        }
        go_to(hole, depth_mm + kPeckBackMm, false);
    }
}

void GcodeInterpreter::go_to(const Hole& hole, double height_mm, bool is_feed) {
    Move next = new_move(MoveKind::line);
    next.is_exact = true;
    next.target = hole.at;
    next.target[hole.up] = height_mm;
    if (is_feed) {
        next.feed_kind = FeedKind::per_minute;
        next.feed = hole.feed;
    }
    append(next);
}

}  // namespace axg
