// SPDX-License-Identifier: Apache-2.0
// `axguardd board-test`: plays a guard that misbehaves to a board on a bench, and judges it.
#pragma once

namespace axg {

class CommandLine;

void add_board_test(CommandLine& line);

}  // namespace axg
