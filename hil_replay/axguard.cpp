// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/axguard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "config/nearest_word.hpp"
#include "config/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/commands.hpp"

namespace axg {
namespace {

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
    CommandLine line({.name = "axguard",
                      .purpose = "axguard: proves that a five-axis machine stays clear of itself",
                      .version = AXG_VERSION});
    add_demo(line);
    add_init(line);
    add_check(line);
    add_compile(line);
    add_simulate(line);
    add_replay(line);
    add_drive(line);
    add_inspect(line);
    add_query(line);
    add_accuracy(line);
    add_chart(line);
    add_bench(line);
    if (!begins_well(words, line.command_names())) {
        return kExitUsage;
    }
    return line.parse(std::move(words));
}

}  // namespace axg
