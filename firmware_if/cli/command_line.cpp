// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/command_line.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/completion.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/whole_file.hpp"

namespace axg {
namespace {

const char* meaning_of(int exit_code) {
    switch (exit_code) {
        case kExitUsage:
            return "wrong usage; the messages on stderr name it";
        case kExitInput:
            return "configuration or input refused; the messages on stderr name it";
        case kExitUnfit:
            return "this host cannot run the guard; the messages on stderr name the reason";
        default:
            return "no result; the messages on stderr name the reason";
    }
}

/// The document of a fault may replace an older document, and nothing else: the command ended
/// before it knew all files that it reads.
bool is_free_for_fault(const std::string& target, int exit_code) {
    if (target.empty() || (target != "-" && exit_code == kExitUsage)) {
        return false;
    }
    std::error_code error;
    return !std::filesystem::is_regular_file(target, error) || std::ifstream(target).peek() == '{';
}

void write_fault(const CLI::App& command, const std::string& target, int exit_code,
                 const std::string& fault) {
    const CLI::App* const program = command.get_parent();
    (void)write_whole_file(target,
                           describe_fault({program->get_name(), program->version(),
                                           command.get_name(), exit_code, fault}),
                           stderr);
}

/// A line for each option that the command does not have, with the one that resembles it.
std::string unknown_options(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    std::string text;
    for (const std::string& word : command.remaining()) {
        const std::string name = word.substr(0, word.find('='));
        if (!name.starts_with('-') || name.size() < 2) {
            continue;
        }
        const std::string_view near = nearest_word(name, known);
        text += fmt::format("{}: unknown option.{}\n", escaped(name),
                            near.empty() ? "" : fmt::format(" Did you mean {}?", near));
    }
    return text;
}

/// "TEXT:{a,b}" are two words; any other type has none.
std::vector<std::string> allowed_words(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t begin = type.find(":{"), end = type.rfind('}');
    if (begin == std::string::npos || end == std::string::npos) {
        return {};
    }
    return CLI::detail::split(type.substr(begin + 2, end - begin - 2), ',');
}

CompletedCommand completed(const CLI::App& command) {
    CompletedCommand out{command.get_name(), command.get_description(), {}, {}};
    for (const CLI::Option* option : command.get_options()) {
        CompletedOption one{{},
                            option->get_description(),
                            allowed_words(*option),
                            option->get_items_expected_max() > 0};
        for (const std::string& name : option->get_snames()) {
            one.names.push_back("-" + name);
        }
        for (const std::string& name : option->get_lnames()) {
            one.names.push_back("--" + name);
        }
        if (one.names.empty()) {
            out.words.insert(out.words.end(), one.words.begin(), one.words.end());
        } else {
            out.options.push_back(std::move(one));
        }
    }
    return out;
}

}  // namespace

Option Option::required() const {
    option_->required();
    return *this;
}

Option Option::one_of(std::initializer_list<const char*> words) const {
    option_->check(CLI::IsMember(words));
    return *this;
}

template <class Value>
Option Option::between(Value least, Value most) const {
    option_->check(CLI::Range(least, most));
    if constexpr (std::is_floating_point_v<Value>) {  // nan is beyond neither bound
        option_->check([](const std::string& word) {
            double value = 0;
            const bool is_number = CLI::detail::lexical_cast(word, value) && !std::isnan(value);
            return is_number ? std::string()
                             : "invalid value (found " + word + ", expected a number)";
        });
    }
    return *this;
}

Option Option::check(std::function<std::string(const std::string&)> fault_of) const {
    option_->check(std::move(fault_of));
    return *this;
}

Option Option::shows_default() const {
    option_->capture_default_str();
    option_->description(
        fmt::format("{} [default: {}]", option_->get_description(), option_->get_default_str()));
    option_->default_str({});  // else CLI11 shows it a second time, behind the type
    return *this;
}

Option Option::repeatable() const {
    option_->take_all()->expected(1);
    return *this;
}

Option Option::separated_by(char separator) const {
    option_->delimiter(separator);
    return *this;
}

bool Option::is_given() const {
    return !option_->empty();
}

template <class Value>
Option Command::add_option(const std::string& names, Value& value, const std::string& help) const {
    const Option option(app_->add_option(names, value, help));
    if constexpr (std::is_unsigned_v<Value>) {  // strtoull() reads -1 as the largest value
        return option.check([](const std::string& word) {
            return word.find('-') == std::string::npos
                       ? std::string()
                       : "invalid value (found " + word + ", expected 0 or more)";
        });
    }
    return option;
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& help) const {
    return Option(app_->add_flag(names, value, help));
}

Option Command::add_flag(const std::string& names, std::string& value,
                         const std::string& help) const {
    return Option(app_->add_flag(names, value, help));
}

Option Command::add_input(const std::string& names, std::string& path,
                          const std::string& help) const {
    files_->inputs.push_back({names, &path});
    return add_option(names, path, help);
}

Option Command::add_output(const std::string& names, std::string& path,
                           const std::string& help) const {
    files_->outputs.push_back({names, &path});
    return add_option(names, path, help).check([](const std::string& word) {
        return word.empty() ? output_fault(word) : std::string();
    });
}

Option Command::add_output_folder(const std::string& names, std::string& path,
                                  const std::string& help) const {
    files_->folders.push_back({names, &path});
    return add_option(names, path, help).check([](const std::string& word) {
        return word.empty() ? output_folder_fault(word) : std::string();
    });
}

void Command::set_example(const std::string& example) const {
    app_->formatter_fn(
        [example](const CLI::App* app, const std::string& name, CLI::AppFormatMode mode) {
            return "Example:\n  " + example + "\n\n" + CLI::Formatter().make_help(app, name, mode);
        });
}

void Command::set_group(const std::string& heading) const {
    app_->group(heading);
}

void Command::set_action(std::function<int()> action) const {
    app_->callback(
        [app = app_, action = std::move(action), exit_code = exit_code_, files = files_] {
            *exit_code = are_sound(*files, stderr) ? action() : kExitUsage;
            if (*exit_code != kExitClean && files->json != nullptr && !files->has_document &&
                is_free_for_fault(*files->json, *exit_code)) {
                write_fault(*app, *files->json, *exit_code, meaning_of(*exit_code));
            }
        });
}

CommandLine::CommandLine(const ProgramTitle& title)
    : app_(std::make_unique<CLI::App>(title.purpose, title.name)), exit_code_(kExitClean) {
    app_->set_version_flag("-V,--version", title.version);
    app_->footer("Run " + title.name + " help COMMAND for the options of a command.");
    app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Command CommandLine::add_command(const std::string& name, const std::string& purpose) {
    return {app_->add_subcommand(name, purpose), &exit_code_};
}

void CommandLine::add_completion() {
    const Command command = add_command("completion", "Print the completion script of a shell");
    command.set_example("source <(" + app_->get_name() + " completion bash)");
    command.add_option("SHELL", shell_, "shell that reads the script")
        .required()
        .one_of({"bash", "zsh", "fish"});
    command.set_action([this] {
        std::vector<CompletedCommand> commands;
        for (const CLI::App* one : std::as_const(*app_).get_subcommands({})) {
            commands.push_back(completed(*one));
        }
        fmt::print("{}", completion_script(shell_, app_->get_name(), commands));
        return static_cast<int>(kExitClean);
    });
}

std::vector<std::string> CommandLine::command_names() const {
    std::vector<std::string> names;
    for (const CLI::App* command : std::as_const(*app_).get_subcommands({})) {
        names.push_back(command->get_name());
    }
    return names;
}

bool CommandLine::begins_well(const std::vector<std::string>& words,
                              const std::string& hint) const {
    const std::string word = words.empty() ? std::string() : words.front();
    const std::vector<std::string> names = command_names();
    if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) {
        return true;
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view near = nearest_word(word, known);
    fmt::print(stderr, "{}: invalid command (found {}, expected one of {}). {}\n", app_->get_name(),
               word.empty() ? "nothing" : '"' + escaped(word) + '"', listed(known),
               near.empty() ? hint : "Did you mean " + std::string(near) + '?');
    return false;
}

int CommandLine::parse_command(std::vector<std::string> words, const std::string& hint) {
    if (!words.empty() && words.front() == "help") {
        words.erase(words.begin());
        words.resize(std::min<std::size_t>(words.size(), 1));
        words.emplace_back("--help");
    }
    return begins_well(words, hint) ? parse(std::move(words)) : kExitUsage;
}

int CommandLine::end_unparsed(const CLI::ParseError& error,
                              const std::vector<std::string>& words) const {
    const std::vector<const CLI::App*> chosen = std::as_const(*app_).get_subcommands({});
    const auto command = std::find_if(chosen.begin(), chosen.end(),
                                      [](const CLI::App* one) { return one->count() != 0; });
    const bool is_fault = error.get_exit_code() != 0;
    const std::string unknown =
        is_fault && command != chosen.end() ? unknown_options(**command) : std::string();
    if (unknown.empty()) {
        (void)app_->exit(error);
    } else {
        fmt::print(stderr, "{}Run {} help {} for its options.\n", unknown, app_->get_name(),
                   (*command)->get_name());
    }
    if (is_fault && command != chosen.end() &&
        std::find(words.begin(), words.end(), "--json") != words.end() &&
        (*command)->get_option_no_throw("--json") != nullptr) {
        write_fault(**command, "-", kExitUsage, unknown.empty() ? error.what() : unknown);
    }
    return is_fault ? kExitUsage : kExitClean;
}

int CommandLine::parse(std::vector<std::string> words) {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 requires
    try {
        app_->parse(reversed);
    } catch (const CLI::ParseError& error) {
        return end_unparsed(error, words);
    }
    return exit_code_;
}

// The types in use. Another one fails to link until it is added here.
template Option Option::between(int, int) const;
template Option Option::between(unsigned, unsigned) const;
template Option Option::between(std::int64_t, std::int64_t) const;
template Option Option::between(double, double) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, unsigned&, const std::string&) const;
template Option Command::add_option(const std::string&, std::int64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&) const;

}  // namespace axg
