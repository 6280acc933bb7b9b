// SPDX-License-Identifier: Apache-2.0
// axguardd status: the state of a running guard, without root.
#pragma once

namespace axg {

class CommandLine;

void add_status(CommandLine& line);

}  // namespace axg
