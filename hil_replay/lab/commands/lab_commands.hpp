// SPDX-License-Identifier: Apache-2.0
// The commands of axguard-lab: each adds itself to the command line.
#pragma once

namespace axg {

class CommandLine;

void add_query(CommandLine& line);
void add_accuracy(CommandLine& line);
void add_chart(CommandLine& line);
void add_bench(CommandLine& line);
void add_ablated_drive(CommandLine& line);

}  // namespace axg
