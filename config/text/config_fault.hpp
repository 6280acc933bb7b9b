// SPDX-License-Identifier: Apache-2.0
// What is wrong with a file, where, and what to do next.
#pragma once

#include <string>

namespace axg {

/// One fault of a machine file or of a file it names. Prints as
/// `machine.yaml:14: axes.A.travel_deg: got "2,2", wanted two numbers, low then high`.
struct ConfigFault {
    std::string where;   // FILE:LINE
    std::string key;     // dotted path, list items by name or index
    std::string got;     // as written, control characters escaped
    std::string wanted;  // and what to do next
};
[[nodiscard]] std::string to_string(const ConfigFault& fault);

}  // namespace axg
