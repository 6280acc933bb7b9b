// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/document_json.hpp"

#include <nlohmann/json.hpp>

namespace axg {

std::string text_of(const nlohmann::ordered_json& document) {
    return document.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string describe_fault(const CommandFault& fault) {
    return text_of({{"program", fault.program},
                    {"version", fault.version},
                    {"command", fault.command},
                    {"exit_code", fault.exit_code},
                    {"fault", fault.fault}});
}

}  // namespace axg
