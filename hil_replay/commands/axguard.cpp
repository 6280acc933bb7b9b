// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/axguard.hpp"

#include <utility>

#include "firmware_if/cli/command_line.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/watch_command.hpp"

namespace axg {

int run_axguard(std::vector<std::string> words, const ReplayObserver& observer) {
    CommandLine line({.name = "axguard",
                      .purpose = "axguard: collision guard for five-axis machines; see axguard-lab "
                                 "for queries, benchmarks and charts",
                      .version = AXG_VERSION});
    add_demo(line);
    add_init(line);
    add_check(line);
    add_compile(line);
    add_verify(line);
    add_certify(line);
    add_simulate(line);
    add_replay(line, observer);
    add_drive(line);
    add_inspect(line);
    add_watch(line);
    line.add_completion();
    return line.parse_command(std::move(words), "Run axguard demo for an example.");
}

}  // namespace axg
