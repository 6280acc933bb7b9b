// SPDX-License-Identifier: Apache-2.0
// The subcommands of axguard: each adds itself to the command line.
#pragma once

#include <functional>

namespace axg {

class CommandLine;
struct ReplayReport;

/// Called with the result of a replay; may be empty.
using ReplayObserver = std::function<void(const ReplayReport&)>;

void add_simulate(CommandLine& line);
void add_check(CommandLine& line);
void add_compile(CommandLine& line);
void add_init(CommandLine& line);
void add_replay(CommandLine& line, const ReplayObserver& observer);
void add_drive(CommandLine& line);
void add_inspect(CommandLine& line);
void add_demo(CommandLine& line);
void add_verify(CommandLine& line);
void add_certify(CommandLine& line);

}  // namespace axg
