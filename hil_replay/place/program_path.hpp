// SPDX-License-Identifier: Apache-2.0
// The path of a program as straight chords, each with its line, to match recorded positions with.
// In path mm: one degree of a rotary axis counts as one mm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

inline constexpr std::size_t kPathPointsMax = 8U << 20U;

struct ProgramPath {
    std::uint32_t axis_count = 0;
    std::vector<float> coordinates;    // [points][axes]
    std::vector<double> along_mm;      // [points], from the start of the program
    std::vector<std::uint32_t> lines;  // [points], of the chord that ends there; 0: the start

    [[nodiscard]] std::size_t size() const noexcept { return lines.size(); }
    [[nodiscard]] std::span<const float> point(std::size_t i) const noexcept {
        return std::span(coordinates).subspan(i * axis_count, axis_count);
    }
};

/// Every corner is sharp; a curve has chords of 0.5 mm, and no chord turns an endless axis by more
/// than a quarter of a turn.
/// @return  empty where it would have more than kPathPointsMax points
[[nodiscard]] ProgramPath make_program_path(const Program& program, const Machine& machine);

}  // namespace axg
