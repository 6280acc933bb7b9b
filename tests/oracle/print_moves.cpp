// SPDX-License-Identifier: Apache-2.0
// A program's canonical moves as text, for comparison with another interpreter. mm, degrees, s.
// print_moves [--tip | --wrapped] [--lines] PROGRAM; --lines: each after its line in the program.
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

/// Six axes that go anywhere: what is compared is what the words mean.
Machine boundless_machine() {
    Machine machine;
    for (const char letter : {'X', 'Y', 'Z', 'A', 'B', 'C'}) {
        const bool is_rotary = letter < 'X';
        machine.axes.push_back({.name = std::string(1, letter),
                                .kind = is_rotary ? AxisKind::rotary : AxisKind::linear,
                                .unlimited = is_rotary,
                                .min = -1e6,
                                .max = 1e6,
                                .speed_max = 100,
                                .acceleration_max = 1000,
                                .jerk_max = 10000,
                                .stopping_min = 1000});
    }
    for (const std::uint16_t number : std::initializer_list<std::uint16_t>{1, 8, 21, 48, 52, 150}) {
        machine.tools.emplace_back().number = number;
        machine.tools.back().diameter_mm = 6;  // DIAMETER_MM of rs274_test.py
    }
    machine.first_tool = 1;
    return machine;
}

/// For tool centre point control: a table that tilts and turns, and a travel without end.
Machine tip_machine() {
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.min = -1e6;
        axis.max = 1e6;
    }
    return machine;
}

/// The six axes that are compared; 0 of one that the machine lacks.
void print_positions(const Machine& machine, const Move& move) {
    for (const char letter : {'X', 'Y', 'Z', 'A', 'B', 'C'}) {
        const std::uint32_t axis = axis_of_letter(machine, letter);
        const double position = axis == kNoIndex ? 0 : move.target[axis];
        std::printf(" %.9f", position * (letter < 'X' ? 180.0 / kPi : 1.0));
    }
}

void print_move(const Machine& machine, const Move& move) {
    if (move.kind == MoveKind::tool_change || move.kind == MoveKind::coordinates) {
        return;
    }
    if (move.kind == MoveKind::dwell) {
        std::printf("dwell %.9f\n", move.dwell_s);
        return;
    }
    const bool is_arc = move.kind == MoveKind::arc;
    std::fputs(is_arc ? "arc" : move.feed_kind == FeedKind::rapid ? "rapid" : "feed", stdout);
    print_positions(machine, move);
    if (is_arc) {
        std::printf(" %u %u %.9f %.9f %.9f", move.arc.first, move.arc.second,
                    move.arc.center_first_mm, move.arc.center_second_mm, move.arc.sweep_rad);
    }
    std::printf("\n");
}

int print_moves(const char* path, const Machine& machine, RotaryRule rule, bool has_lines) {
    std::ifstream file(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    GcodeOptions options;
    options.block_delete = BlockDelete::run;
    options.program.rotary.fill(rule);
    const GcodeResult result = read_gcode(text, machine, options);
    for (const ProgramFault& fault : result.faults) {
        std::fprintf(stderr, "%s:%u: %s: %s\n", path, fault.line, fault.word.c_str(),
                     fault.message.c_str());
    }
    if (!result.faults.empty()) {
        return 3;
    }
    for (const Move& move : result.program.moves) {
        if (has_lines && move.kind != MoveKind::tool_change && move.kind != MoveKind::coordinates) {
            std::printf("%u ", move.line);
        }
        print_move(machine, move);
    }
    return 0;
}

}  // namespace
}  // namespace axg

int main(int argc, char** argv) {
    bool is_tip = false, is_wrapped = false, has_lines = false;
    for (int i = 1; i + 1 < argc; ++i) {
        const std::string_view option = argv[i];
        is_tip = is_tip || option == "--tip";
        is_wrapped = is_wrapped || option == "--wrapped";
        has_lines = has_lines || option == "--lines";
        if (option != "--tip" && option != "--wrapped" && option != "--lines") {
            return 2;
        }
    }
    return argc < 2 ? 2
                    : axg::print_moves(
                          argv[argc - 1], is_tip ? axg::tip_machine() : axg::boundless_machine(),
                          is_wrapped ? axg::RotaryRule::wrapped : axg::RotaryRule::programmed,
                          has_lines);
}
