// SPDX-License-Identifier: Apache-2.0
// Sources: bash's manual, "Programmable Completion"; zshcompsys(1), _arguments; fish's complete(1).
#include "firmware_if/cli/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace axg {
namespace {

/// A name that each shell accepts for a function.
std::string function_name(const std::string& program) {
    std::string name = "_" + program;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// Text in a description: without letters that mean something to one of the shells.
std::string plain(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']') {
            out += c == '[' ? '(' : ')';
        } else if (c == ':') {
            out += ',';
        } else if (c != '\'' && c != '\\' && c != '`' && c != '"') {
            out += c;
        }
    }
    return out;
}

std::string names_of(std::span<const CompletedCommand> commands) {
    std::string text;
    for (const CompletedCommand& command : commands) {
        text += command.name + " ";
    }
    return text + "help";
}

std::string bash_script(const std::string& program, std::span<const CompletedCommand> commands) {
    std::string values, options;
    for (const CompletedCommand& command : commands) {
        std::string names;
        for (const CompletedOption& option : command.options) {
            for (const std::string& name : option.names) {
                names += (names.empty() ? "" : " ") + name;
                if (option.has_value) {
                    values += fmt::format("        \"{} {}\") words=\"{}\" ;;\n", command.name,
                                          name, fmt::join(option.words, " "));
                }
            }
        }
        options += fmt::format(
            "            {}) words=\"{}\"; [ \"${{current#-}}\" = \"$current\" ] && words=\"{}\" "
            ";;\n",
            command.name, names, fmt::join(command.words, " "));
    }
    // An empty reply leaves the word to -o default: file names.
    return fmt::format(R"(# bash: source <({0} completion bash)
{1}() {{
    local current="${{COMP_WORDS[COMP_CWORD]}}" words=""
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="{2} --help --version"
    elif [ "${{COMP_WORDS[1]}}" = help ]; then
        words="{2}"
    else
        case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
{3}        *) case "${{COMP_WORDS[1]}}" in
{4}            esac ;;
        esac
    fi
    [ -z "$words" ] || COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F {1} {0}
)",
                       program, function_name(program), names_of(commands), values, options);
}

std::string zsh_script(const std::string& program, std::span<const CompletedCommand> commands) {
    std::string names, cases;
    for (const CompletedCommand& command : commands) {
        names += fmt::format(" '{}:{}'", command.name, plain(command.purpose));
        cases += fmt::format("    {}) _arguments", command.name);
        for (const CompletedOption& option : command.options) {
            for (const std::string& name : option.names) {
                const std::string value =
                    !option.has_value ? ""
                    : option.words.empty()
                        ? ":value:_files"
                        : fmt::format(":value:({})", fmt::join(option.words, " "));
                cases += fmt::format(" \\\n        '{}[{}]{}'", name, plain(option.help), value);
            }
        }
        cases += command.words.empty() ? " \\\n        '*:file:_files' ;;\n"
                                       : fmt::format(" \\\n        '1:word:({})' ;;\n",
                                                     fmt::join(command.words, " "));
    }
    return fmt::format(R"(#compdef {0}
# zsh: source <({0} completion zsh)
{1}() {{
    local -a verbs
    verbs=({2} 'help:print the help of a command')
    if (( CURRENT == 2 )); then
        _describe command verbs
        return
    fi
    local command="$words[2]"
    shift words
    (( CURRENT-- ))
    case "$command" in
{3}    help) _describe command verbs ;;
    esac
}}
compdef {1} {0}
)",
                       program, function_name(program), names, cases);
}

std::string fish_script(const std::string& program, std::span<const CompletedCommand> commands) {
    std::string text = fmt::format("# fish: {0} completion fish | source\n", program);
    for (const CompletedCommand& command : commands) {
        text += fmt::format("complete -c {} -f -n __fish_use_subcommand -a {} -d '{}'\n", program,
                            command.name, plain(command.purpose));
        const std::string head = fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'",
                                             program, command.name);
        if (!command.words.empty()) {
            text += fmt::format("{} -f -a '{}'\n", head, fmt::join(command.words, " "));
        }
        for (const CompletedOption& option : command.options) {
            text += head;
            for (const std::string& name : option.names) {
                text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            }
            text += !option.has_value ? ""
                    : option.words.empty()
                        ? " -r"
                        : fmt::format(" -x -a '{}'", fmt::join(option.words, " "));
            text += fmt::format(" -d '{}'\n", plain(option.help));
        }
    }
    return text + fmt::format(
                      "complete -c {0} -f -n __fish_use_subcommand -a help\n"
                      "complete -c {0} -f -n '__fish_seen_subcommand_from help' -a '{1}'\n",
                      program, names_of(commands));
}

}  // namespace

std::string completion_script(std::string_view shell, const std::string& program,
                              std::span<const CompletedCommand> commands) {
    return shell == "bash"  ? bash_script(program, commands)
           : shell == "zsh" ? zsh_script(program, commands)
                            : fish_script(program, commands);
}

}  // namespace axg
