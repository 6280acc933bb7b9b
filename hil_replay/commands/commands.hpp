// SPDX-License-Identifier: Apache-2.0
// The subcommands of axguard: each adds itself to the command line.
#pragma once

namespace axg {

class CommandLine;

void add_simulate(CommandLine& line);
void add_check(CommandLine& line);
void add_compile(CommandLine& line);
void add_init(CommandLine& line);
void add_replay(CommandLine& line);
void add_drive(CommandLine& line);
void add_inspect(CommandLine& line);
void add_demo(CommandLine& line);

}  // namespace axg
