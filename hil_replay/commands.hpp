// SPDX-License-Identifier: Apache-2.0
// The subcommands of axguard: each adds itself to the parser and leaves its exit code behind when
// it has run.
#pragma once

#include <CLI/CLI.hpp>

namespace axg {

void add_simulate(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_compile(CLI::App& app, int& exit_code);
void add_init(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_drive(CLI::App& app, int& exit_code);
void add_inspect(CLI::App& app, int& exit_code);
void add_query(CLI::App& app, int& exit_code);
void add_accuracy(CLI::App& app, int& exit_code);
void add_chart(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_demo(CLI::App& app, int& exit_code);

}  // namespace axg
