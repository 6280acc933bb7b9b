// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/commands/axguard_lab.hpp"

#include <utility>

#include "firmware_if/cli/command_line.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"

namespace axg {

int run_axguard_lab(std::vector<std::string> words) {
    CommandLine line({.name = "axguard-lab",
                      .purpose = "axguard-lab: measure the methods and engines of axguard",
                      .version = AXG_VERSION});
    add_query(line);
    add_accuracy(line);
    add_chart(line);
    add_bench(line);
    add_ablated_drive(line);
    line.add_completion();
    return line.parse_command(std::move(words), "Run axguard-lab --help for the list.");
}

}  // namespace axg
