// SPDX-License-Identifier: Apache-2.0
// `axguardd doctor`: what of this machine would make the guard late or deaf, and the command that
// mends it.
#pragma once

namespace axg {

class CommandLine;

void add_doctor(CommandLine& line);

}  // namespace axg
