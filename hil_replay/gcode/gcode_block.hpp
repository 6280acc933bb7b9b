// SPDX-License-Identifier: Apache-2.0
// One block: the words of a line by modal group and letter. Reports every conflict within the line.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil_replay/gcode/gcode_lexer.hpp"
#include "hil_replay/gcode/gcode_words.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

/// The codes are ten times the number; -1: no word of that group in this block.
struct GcodeBlock {
    std::uint32_t line = 0;
    std::array<std::int32_t, kModalGroups> codes{};
    bool is_machine = false;                          // G53
    std::array<std::optional<double>, 26> letters{};  // by letter - 'A'; G, M and N stay empty
    std::vector<std::string> ignored;                 // words skipped at the user's request

    [[nodiscard]] std::int32_t code(ModalGroup group) const {
        return codes[static_cast<std::size_t>(group)];
    }
    [[nodiscard]] bool has(char letter) const {
        return letters[static_cast<std::size_t>(letter - 'A')].has_value();
    }
    [[nodiscard]] double value(char letter, double otherwise = 0) const {
        return letters[static_cast<std::size_t>(letter - 'A')].value_or(otherwise);
    }
};

inline constexpr char kAxisLetters[] = {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'};

/// True for a word of one of the nine axes.
[[nodiscard]] bool is_axis_letter(char letter);

/// G73, G81 to G86, G89: motion modes that drill a hole at every block with axis words.
[[nodiscard]] constexpr bool is_canned_cycle(std::int32_t motion) {
    return motion == 730 || (motion >= 810 && motion <= 890);
}
/// M2, M30.
[[nodiscard]] inline bool ends_program(const GcodeBlock& block) {
    return block.code(ModalGroup::stop) == 20 || block.code(ModalGroup::stop) == 300;
}
/// G33, G33.1: lines that follow the spindle.
[[nodiscard]] constexpr bool is_thread(std::int32_t motion) {
    return motion == 330 || motion == 331;
}
/// G38.2 to G38.5.
[[nodiscard]] constexpr bool is_probe(std::int32_t motion) {
    return motion >= 382 && motion <= 385;
}
/// G5, G5.1: splines of one block. G5.2 and G5.3 are the first and the last block of a NURBS.
[[nodiscard]] constexpr bool is_single_spline(std::int32_t motion) {
    return motion == 50 || motion == 51;
}
inline constexpr std::int32_t kNurbsPoint = 52, kNurbsEnd = 53;
/// True for a block with a word of one of the nine axes.
[[nodiscard]] bool has_axis_word(const GcodeBlock& block);
/// Whether a word that moves no axis uses this letter: M19, M50 to M53, M62 to M68, G96.
[[nodiscard]] bool is_setting_letter(const GcodeBlock& block, char letter);
/// Words whose axis words are offsets and not targets of a move: G10, G52, G92, G43.1.
[[nodiscard]] inline bool takes_axis_words(const GcodeBlock& block) {
    const std::int32_t code = block.code(ModalGroup::non_modal);
    return code == 100 || code == 520 || code == 920 || block.code(ModalGroup::tool_length) == 431;
}

/// @param ignored  words to skip, such as "M428". Applies to refused words and to M100 and above,
/// which the configuration of the control defines, and not to other words
/// @param faults   appended to; after any new one the block must not run
[[nodiscard]] GcodeBlock make_gcode_block(const GcodeLine& line, std::uint32_t line_number,
                                          std::span<const std::string> ignored,
                                          std::vector<ProgramFault>& faults);

}  // namespace axg
