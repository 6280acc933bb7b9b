// SPDX-License-Identifier: Apache-2.0
// The text of a JSON document, the same for every command. For files named NAME_json.cpp: only
// these include nlohmann/json.hpp, which needs seconds to compile.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace axg {

/// Indented by two, with an end of line. In ASCII, so that no name can turn the text around it;
/// bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string text_of(const nlohmann::ordered_json& document);

/// A command that ended without results.
struct CommandFault {
    std::string program, version, command;
    int exit_code = 0;
    std::string fault;
};
/// Its document, for a program that asked for one.
[[nodiscard]] std::string describe_fault(const CommandFault& fault);

}  // namespace axg
