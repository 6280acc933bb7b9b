// SPDX-License-Identifier: Apache-2.0
// `axguardd board-test`: plays a guard that misbehaves to a board on a bench, and judges it.
#pragma once

namespace axg {

class CommandLine;
struct CanLayout;

/// Whether board-test can play to the board of this machine file.
[[nodiscard]] bool is_testable(const CanLayout& can) noexcept;

void add_board_test(CommandLine& line);

}  // namespace axg
