// SPDX-License-Identifier: Apache-2.0
// A program's commands and their options. CLI11 parses them. It costs seconds of compile time in
// every file that includes it: only command_line.cpp does.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/cli/command_files.hpp"

namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI

namespace axg {

/// One option of a command. A handle: valid as long as its CommandLine.
class Option {
  public:
    explicit Option(CLI::Option* option) noexcept : option_(option) {}

    Option required() const;
    Option one_of(std::initializer_list<const char*> words) const;
    /// Both bounds are allowed.
    /// @tparam Value  int, unsigned, std::int64_t or double: the help names it
    template <class Value>
    Option between(Value least, Value most) const;
    /// @param fault_of  what is wrong with a word; empty: nothing
    Option check(std::function<std::string(const std::string&)> fault_of) const;
    Option shows_default() const;
    /// May be given more than once, with one value each time.
    Option repeatable() const;
    /// Accepts several values at once, with this between them.
    Option separated_by(char separator) const;

    /// After parsing.
    [[nodiscard]] bool is_given() const;

  private:
    CLI::Option* option_;
};

/// One command of a program. A handle: valid as long as its CommandLine.
class Command {
  public:
    Command(CLI::App* app, int* exit_code)
        : app_(app), exit_code_(exit_code), files_(std::make_shared<CommandFiles>()) {}

    /// @param names   "--name", "-n,--name", or without hyphens a positional one
    /// @param value   out, as it was unless the option is given; must outlive the parsing
    /// @tparam Value  bounded by the list at the end of command_line.cpp
    template <class Value>
    Option add_option(const std::string& names, Value& value, const std::string& help) const;
    Option add_flag(const std::string& names, bool& value, const std::string& help) const;
    /// A flag that accepts a word only as --name=WORD.
    /// @param names  "--name{WORD}" with the word of a bare --name
    Option add_flag(const std::string& names, std::string& value, const std::string& help) const;
    // Options that name files. The action runs only after every name was checked.
    Option add_input(const std::string& names, std::string& path, const std::string& help) const;
    Option add_output(const std::string& names, std::string& path, const std::string& help) const;
    Option add_output_folder(const std::string& names, std::string& path,
                             const std::string& help) const;
    [[nodiscard]] const std::shared_ptr<CommandFiles>& files() const noexcept { return files_; }

    /// Lists the command in the program's help under this heading.
    void set_group(const std::string& heading) const;
    /// Puts a command line that works in front of the help: most people read no further.
    void set_example(const std::string& example) const;
    /// @param action  runs when the command is given; returns an exit code
    void set_action(std::function<int()> action) const;

  private:
    CLI::App* app_;
    int* exit_code_;
    std::shared_ptr<CommandFiles> files_;
};

/// Title of a program in its help.
struct ProgramTitle {
    std::string name, purpose, version;
};

class CommandLine {
  public:
    explicit CommandLine(const ProgramTitle& title);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    Command add_command(const std::string& name, const std::string& purpose);
    /// Adds the command that prints a shell's completion of all commands.
    void add_completion();
    /// In the order in which they were added.
    [[nodiscard]] std::vector<std::string> command_names() const;

    /// Runs the command that the first word names; prints the commands there are when it names
    /// none. "help COMMAND" prints the help of a command.
    /// @param hint  for a word that resembles no command: what to type instead
    [[nodiscard]] int parse_command(std::vector<std::string> words, const std::string& hint);
    /// Runs the command that the words name. Prints help and complaints itself.
    /// @param words  as typed after the program's name
    /// @return  the exit code of the command; kExitUsage for words that do not parse
    [[nodiscard]] int parse(std::vector<std::string> words);

  private:
    /// Whether the first word is a command or an option.
    [[nodiscard]] bool begins_well(const std::vector<std::string>& words,
                                   const std::string& hint) const;
    /// Prints help or complaints about words that did not parse. Returns the exit code.
    [[nodiscard]] int end_unparsed(const CLI::ParseError& error,
                                   const std::vector<std::string>& words) const;

    std::unique_ptr<CLI::App> app_;
    int exit_code_;
    std::string shell_;  // of the completion
};

}  // namespace axg
