// SPDX-License-Identifier: Apache-2.0
// axguardd status: what a running guard says of itself, without root.
#pragma once

namespace axg {

class CommandLine;

void add_status(CommandLine& line);

}  // namespace axg
