// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/axguard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "config/nearest_word.hpp"
#include "config/quote_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/commands.hpp"

namespace axg {
namespace {

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) {
        names.push_back(command->get_name());
    }
    return names;
}

/// Whether the words begin with a command or an option; a message with the commands there are if
/// not.
bool begins_well(const std::vector<std::string>& words, const std::vector<std::string>& names) {
    const std::string word = words.empty() ? std::string() : words.front();
    if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) {
        return true;
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view near = nearest_word(word, known);
    fmt::print(stderr, "axguard: got {}, wanted a command: {}{}\n",
               word.empty() ? "nothing" : '"' + escaped(word) + '"', listed(known),
               near.empty() ? "; axguard demo shows what they do"
                            : "; did you mean " + std::string(near) + '?');
    return false;
}

}  // namespace

int run_axguard(std::vector<std::string> words) {
    CLI::App app{"axguard: proves that a five-axis machine stays clear of itself", "axguard"};
    app.set_version_flag("--version", AXG_VERSION);
    app.require_subcommand(1);
    int exit_code = kExitClean;
    add_demo(app, exit_code);
    add_init(app, exit_code);
    add_check(app, exit_code);
    add_compile(app, exit_code);
    add_simulate(app, exit_code);
    add_replay(app, exit_code);
    add_drive(app, exit_code);
    add_inspect(app, exit_code);
    add_query(app, exit_code);
    add_accuracy(app, exit_code);
    add_chart(app, exit_code);
    add_bench(app, exit_code);
    if (!begins_well(words, names_of_commands(app))) {
        return kExitUsage;
    }
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    try {
        app.parse(words);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitClean : kExitUsage;
    }
    return exit_code;
}

}  // namespace axg
