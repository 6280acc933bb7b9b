// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/command_files.hpp"

#include <algorithm>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/whole_file.hpp"

namespace axg {
namespace {

/// "-o,--output" is "--output" in a message.
std::string long_name(const std::string& option) {
    return option.substr(option.rfind(',') + 1);
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

bool are_sound(const CommandFiles& files, std::FILE* messages) {
    bool is_sound = true;
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
