// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/axguard.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "hil_replay/commands.hpp"

namespace axg {

int run_axguard(std::vector<std::string> words) {
    CLI::App app{"axguard: proves that a five-axis machine stays clear of itself", "axguard"};
    app.set_version_flag("--version", AXG_VERSION);
    app.require_subcommand(1);
    int exit_code = kExitClean;
    add_demo(app, exit_code);
    add_init(app, exit_code);
    add_check(app, exit_code);
    add_simulate(app, exit_code);
    add_replay(app, exit_code);
    add_query(app, exit_code);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    try {
        app.parse(words);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitClean : kExitUsage;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "axguard: internal error: %s\n", error.what());
        return kExitInternal;
    }
    return exit_code;
}

}  // namespace axg
