// SPDX-License-Identifier: Apache-2.0
// What a test of a board found: a line a rule, keys for the machine file, a JSON document.
#pragma once

#include <string>

#include "core/machine/machine.hpp"
#include "firmware_if/board_test/board_player.hpp"

namespace axg {

[[nodiscard]] const char* to_text(Outcome outcome) noexcept;

/// A line for each rule, and one on what to do after each that failed.
[[nodiscard]] std::string report_text(const BoardTestResult& result);

/// Figures that every judged stop fits: reaction, then deceleration and jerk of the axes that were
/// tested. YAML, as the machine file has them; empty: no stop was judged.
[[nodiscard]] std::string machine_keys(const Machine& machine, const BoardTestResult& result);

/// The machine whose file has these keys in place of its own: number by number as they are printed.
[[nodiscard]] Machine with_measured_keys(const Machine& machine, const BoardTestResult& result);

[[nodiscard]] std::string describe_board_test(const Machine& machine, const std::string& bus,
                                              const BoardTestResult& result);

struct BoardTestCounts {
    std::size_t passed = 0, failed = 0, unclear = 0, not_tested = 0;
};
[[nodiscard]] BoardTestCounts counts_of(const BoardTestResult& result) noexcept;

}  // namespace axg
