// SPDX-License-Identifier: Apache-2.0
// `axguardd doctor`: checks this host for settings that delay the guard or lose CAN frames, and
// prints the command that corrects each.
#pragma once

namespace axg {

class CommandLine;

void add_doctor(CommandLine& line);

}  // namespace axg
