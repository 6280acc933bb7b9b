// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_block.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace axg {
namespace {

using enum ModalGroup;

/// Ten times the number if it has at most one decimal, else -1. LinuxCNC has the same tolerance.
std::int32_t code_of(double number) {
    const double tenfold = number * 10.0;
    const double nearest = std::round(tenfold);
    if (std::abs(tenfold - nearest) > 1e-3 || nearest < 0 || nearest > 1e6) {
        return -1;
    }
    return static_cast<std::int32_t>(nearest);
}

std::string name_of(char letter, std::int32_t code) {
    std::string name(1, letter);
    name += std::to_string(code / 10);
    if (code % 10 != 0) {
        name += '.';
        name += std::to_string(code % 10);
    }
    return name;
}

class BlockBuilder {
  public:
    BlockBuilder(std::uint32_t line, std::span<const std::string> ignored,
                 std::vector<ProgramFault>& faults)
        : ignored_(ignored), faults_(faults) {
        block_.line = line;
        block_.codes.fill(-1);
    }

    void add(const GcodeWord& word) {
        if (word.letter == 'G' || word.letter == 'M') {
            add_code(word);
        } else {
            auto& slot = block_.letters[static_cast<std::size_t>(word.letter - 'A')];
            if (slot) {
                fault(word.text,
                      std::string("a second ") + word.letter + " in one block; remove one of them");
            }
            slot = word.number;
        }
    }

    /// Reports letters that no word of the block uses: they may be typing errors.
    void check_letters() {
        const bool is_skipped =
            !block_.ignored.empty() && std::all_of(block_.codes.begin(), block_.codes.end(),
                                                   [](std::int32_t code) { return code == -1; });
        for (const char letter : {'D', 'E', 'H', 'I', 'J', 'K', 'L', 'P', 'Q', 'R'}) {
            if (is_skipped && block_.has(letter)) {
                block_.letters[static_cast<std::size_t>(letter - 'A')].reset();
            }
        }
        const std::int32_t motion_code = block_.code(motion);
        const bool may_be_arc = motion_code == -1 || motion_code == 20 || motion_code == 30;
        const bool may_be_cycle = motion_code == -1 || is_canned_cycle(motion_code);
        const bool writes_offset = block_.code(non_modal) == 100;
        const bool is_cubic = motion_code == 50, is_spline = is_single_spline(motion_code);
        const bool is_point = motion_code == kNurbsPoint;
        unused('P',
               may_be_arc || may_be_cycle || writes_offset || block_.code(non_modal) == 40 ||
                   block_.code(path) == 640 || is_cubic || is_point,
               "G4, G5, G5.2, G10, G64, arcs, canned cycles, M19, M50 to M53 and M62 to M66 take "
               "it");
        unused('Q', may_be_cycle || block_.code(path) == 640 || is_cubic,
               "G5, G64, G73, G83, M19 and M66 to M68 take it");
        unused('D', block_.code(cutter) > 400, "G41 to G42.1 and G96 take it");
        unused('E', false, "M66 to M68 take it");
        unused('H', block_.code(tool_length) == 430 || block_.code(tool_length) == 434,
               "G43 and G43.4 take it");
        unused('L', may_be_cycle || writes_offset || is_point,
               "G5.2, G10, M66 and canned cycles take it");
        unused('R', may_be_arc || may_be_cycle, "arcs, canned cycles and M19 take it");
        unused('I', may_be_arc || is_spline || motion_code == 331,
               "G2, G3, G5, G5.1 and G33.1 take it");
        unused('J', may_be_arc || is_spline, "G2, G3, G5 and G5.1 take it");
        unused('K', may_be_arc || is_thread(motion_code), "G2, G3, G33 and G33.1 take it");
    }

    [[nodiscard]] GcodeBlock take() { return std::move(block_); }

  private:
    void fault(const std::string& word, std::string message) {
        faults_.push_back({block_.line, word, std::move(message)});
    }

    void unused(char letter, bool is_taken, const char* who) {
        if (!block_.has(letter) || is_taken || is_setting_letter(block_, letter)) {
            return;
        }
        if (!block_.ignored.empty() && block_.ignored[0][0] == 'M' &&
            (letter == 'P' || letter == 'Q')) {
            block_.letters[static_cast<std::size_t>(letter - 'A')].reset();  // the ignored word's
        } else {
            fault(std::string(1, letter),
                  std::string("no word of this block takes it (") + who + ")");
        }
    }

    static std::string reason_of(const GcodeWordRule* rule, const std::string& name, bool is_own) {
        if (rule != nullptr) {
            return std::string(rule->reason);
        }
        return is_own ? "a program of the control's own; --ignore " + name + " leaves it out"
                      : "not a word of this dialect";
    }

    void add_code(const GcodeWord& word) {
        const std::int32_t code = code_of(word.number);
        const GcodeWordRule* rule = code < 0 ? nullptr : find_gcode_word(word.letter, code);
        const std::string name = code < 0 ? word.text : name_of(word.letter, code);
        const bool is_refused = rule == nullptr || rule->support == WordSupport::refused;
        const bool is_own = word.letter == 'M' && code >= 1000;  // configured in the control
        if ((is_refused || is_own) &&
            std::find(ignored_.begin(), ignored_.end(), name) != ignored_.end()) {
            block_.ignored.push_back(name);
            return;
        }
        if (is_refused) {
            fault(name, "not supported (" + reason_of(rule, name, is_own) + ")");
            return;
        }
        if (code == 530 && word.letter == 'G') {
            block_.is_machine = true;
            return;
        }
        if (word.letter == 'M' && (code == 980 || code == 990)) {
            fault(name, "has to begin its line");
            return;
        }
        if (rule->group == count) {
            return;
        }
        std::int32_t& slot = block_.codes[static_cast<std::size_t>(rule->group)];
        const bool is_mist_and_flood =
            rule->group == coolant && slot + code == 150;  // M7 and M8: the only allowed pair
        if (rule->group == motion && slot >= 0 && (code == 800 || slot == 800)) {
            slot = code == 800 ? slot : code;  // G80 yields, as in LinuxCNC
            return;
        }
        if (slot >= 0 && !is_mist_and_flood) {
            fault(name, "conflicts with " + name_of(word.letter, slot) +
                            " in the same block; write them in two blocks");
            return;
        }
        slot = code;
    }

    std::span<const std::string> ignored_;
    std::vector<ProgramFault>& faults_;
    GcodeBlock block_;
};

}  // namespace

bool is_axis_letter(char letter) {
    return std::find(std::begin(kAxisLetters), std::end(kAxisLetters), letter) !=
           std::end(kAxisLetters);
}

bool has_axis_word(const GcodeBlock& block) {
    return std::any_of(std::begin(kAxisLetters), std::end(kAxisLetters),
                       [&block](char letter) { return block.has(letter); });
}

bool is_setting_letter(const GcodeBlock& block, char letter) {
    const std::int32_t output = block.code(outputs);
    const bool is_orientation = block.code(spindle) == 190, is_analog = output >= 670;
    switch (letter) {
        case 'D':
            return block.code(spindle_mode) == 960;
        case 'E':
            return output >= 660;
        case 'L':
            return output == 660;
        case 'P':
            return block.code(overrides) >= 500 || (output != -1 && !is_analog) || is_orientation;
        case 'Q':
            return output >= 660 || is_orientation;
        case 'R':
            return is_orientation;
        default:
            return false;
    }
}

GcodeBlock make_gcode_block(const GcodeLine& line, std::uint32_t line_number,
                            std::span<const std::string> ignored,
                            std::vector<ProgramFault>& faults) {
    const std::size_t faults_before = faults.size();
    BlockBuilder builder(line_number, ignored, faults);
    for (const GcodeWord& word : line.words) {
        builder.add(word);
    }
    if (!line.fault.empty()) {
        faults.push_back({line_number, line.fault_word, line.fault});
    } else if (faults.size() == faults_before) {
        builder.check_letters();  // only without faults: a refused word may use the letters
    }
    return builder.take();
}

}  // namespace axg
