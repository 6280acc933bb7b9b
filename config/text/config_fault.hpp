// SPDX-License-Identifier: Apache-2.0
// A fault of a file: its place, its text and the next action.
#pragma once

#include <string>

namespace axg {

/// One fault of a machine file or of a file it names. Prints as
/// `m.yaml:14: axes.A.travel_deg: invalid value (found "2,2", expected two angles, low then high).`
struct ConfigFault {
    std::string where;   // FILE:LINE
    std::string key;     // dotted path, list items by name or index
    std::string got;     // as written, control characters escaped; empty: the key is missing
    std::string wanted;  // what would be right, then behind "; " what to do
};
[[nodiscard]] std::string to_string(const ConfigFault& fault);

}  // namespace axg
