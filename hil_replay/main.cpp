// SPDX-License-Identifier: Apache-2.0
// axguard: the workbench on a PC. No GPU and no CAN needed.
#include <cstdio>
#include <exception>

#include "hil_replay/commands.hpp"

int main(int argc, char** argv) {
    CLI::App app{"axguard: proves that a five-axis machine stays clear of itself"};
    app.set_version_flag("--version", AXG_VERSION);
    app.require_subcommand(1);
    int exit_code = axg::kExitClean;
    axg::add_simulate(app, exit_code);
    axg::add_check(app, exit_code);
    axg::add_query(app, exit_code);
    axg::add_replay(app, exit_code);
    axg::add_init(app, exit_code);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? axg::kExitClean : axg::kExitUsage;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "axguard: internal error: %s\n", error.what());
        return axg::kExitInternal;
    }
    return exit_code;
}
