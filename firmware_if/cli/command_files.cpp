// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/command_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/whole_file.hpp"

namespace axg {
namespace {

/// "-o,--output" is "--output" in a message.
std::string long_name(const std::string& option) {
    return option.substr(option.rfind(',') + 1);
}

constexpr const char* kMachineFile = "a machine file";

/// What the ending of a name stands for; empty: nothing known.
std::string kind_of_name(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    constexpr std::array kMachines{".yaml", ".yml", ".axg"};
    constexpr std::array kPrograms{".ngc", ".nc", ".gcode", ".tap", ".cnc", ".mpf", ".eia"};
    constexpr std::array kTraces{".log", ".asc"};
    const auto is_in = [&ending](const auto& endings) {
        return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    return is_in(kMachines)   ? kMachineFile
           : is_in(kPrograms) ? "a G-code program"
           : is_in(kTraces)   ? "a trace"
                              : "";
}

bool complain(const CommandFiles::Named& file, const std::string& what, std::FILE* messages) {
    std::fprintf(messages, "%s: %s: %s\n", long_name(file.option).c_str(),
                 escaped(*file.path, 4096).c_str(), what.c_str());
    return false;
}

bool is_apart(const CommandFiles::Named& output, const std::string& input, const std::string& name,
              std::FILE* messages) {
    return !is_same_file(*output.path, input) ||
           complain(output, "is the same file as " + name + ". Pass another file name.", messages);
}

/// "-" is stdin as an input and stdout as an output.
bool is_apart_from_input(const CommandFiles::Named& output, const std::string& input,
                         const std::string& name, std::FILE* messages) {
    return (input == "-" && is_stdout(*output.path)) || is_apart(output, input, name, messages);
}

}  // namespace

std::string misplaced_input(const std::vector<CommandFiles::Named>& inputs) {
    const CommandFiles::Named* machine = nullptr;  // no machine file, by its name
    const CommandFiles::Named* other = nullptr;    // a machine file in another one's place
    for (const CommandFiles::Named& input : inputs) {
        const std::string kind = kind_of_name(*input.path);
        if (input.option == "MACHINE" && !kind.empty() && kind != kMachineFile) {
            machine = &input;
        } else if ((input.option == "PROGRAM" || input.option == "TRACE") && kind == kMachineFile) {
            other = &input;
        }
    }
    if (machine == nullptr && other == nullptr) {
        return {};
    }
    const CommandFiles::Named& wrong = machine != nullptr ? *machine : *other;
    return fmt::format(
        "{}: {}: is {} by its name. {}", wrong.option, escaped(*wrong.path, 4096),
        kind_of_name(*wrong.path),
        machine != nullptr && other != nullptr
            ? fmt::format("{} is the machine file: swap the two.", escaped(*other->path, 4096))
            : "The machine file comes first, then the other file.");
}

bool are_sound(const CommandFiles& files, std::FILE* messages) {
    const std::string misplaced = misplaced_input(files.inputs);
    bool is_sound = misplaced.empty();
    if (!is_sound) {
        fmt::print(messages, "{}\n", misplaced);
    }
    for (const CommandFiles::Named& folder : files.folders) {
        const std::string fault =
            folder.path->empty() ? std::string() : output_folder_fault(*folder.path);
        is_sound = (fault.empty() || complain(folder, fault, messages)) && is_sound;
    }
    for (auto output = files.outputs.begin(); output != files.outputs.end(); ++output) {
        if (output->path->empty()) {
            continue;
        }
        const std::string fault = output_fault(*output->path);
        is_sound = (fault.empty() || complain(*output, fault, messages)) && is_sound;
        for (const CommandFiles::Named& input : files.inputs) {
            is_sound =
                (input.path->empty() ||
                 is_apart_from_input(*output, *input.path, long_name(input.option), messages)) &&
                is_sound;
        }
        for (auto other = files.outputs.begin(); other != output; ++other) {
            is_sound = (other->path->empty() ||
                        is_apart(*output, *other->path, long_name(other->option), messages)) &&
                       is_sound;
        }
    }
    return is_sound;
}

bool are_apart(const CommandFiles& files, const std::vector<std::string>& inputs,
               std::FILE* messages) {
    bool are = true;
    for (const CommandFiles::Named& output : files.outputs) {
        for (const std::string& input : inputs) {
            are = (output.path->empty() ||
                   is_apart_from_input(output, input, "the input " + escaped(input, 4096),
                                       messages)) &&
                  are;
        }
    }
    return are;
}

bool takes_stdout(const CommandFiles& files) {
    return std::any_of(files.outputs.begin(), files.outputs.end(),
                       [](const CommandFiles::Named& output) {
                           return !output.path->empty() && is_stdout(*output.path);
                       });
}

}  // namespace axg
