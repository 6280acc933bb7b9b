// SPDX-License-Identifier: Apache-2.0
// A machine being read: the plain data so far, and the line of each part in the file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/text/named_file.hpp"
#include "core/machine/machine.hpp"

namespace axg {

class FaultList;

/// Beyond the margin of a pair.
struct ClearanceLevelDistances {
    double slow_mm = 0, warn_mm = 0;
};

struct MachineDraft {
    Machine machine;
    FaultList& faults;
    const NamedFiles& files;
    std::string_view can_source = "classical";  // can.format: a name of WireFormat, or dbc
    bool states_permit_samples = false;  // else they follow from `permit`, `ahead` and guard.cap
    std::vector<int> axis_lines{}, body_lines{}, tool_lines{};
    ClearanceLevelDistances usual_clearance_levels{};  // of pairs that state none
    std::vector<std::string> doubts{};                 // lines for a person to review
    bool surfaces_are_sound = true;                    // no body has an unreadable `tool` key
    bool names_are_sound =
        true;  // else a missing pair would be reported twice: once for its misspelt body
};

/// Index of the first item of that name, or kNoIndex.
template <class Named>
[[nodiscard]] std::uint32_t index_of(const std::vector<Named>& all,
                                     std::string_view name) noexcept {
    for (std::uint32_t i = 0; i < all.size(); ++i) {
        if (all[i].name == name) {
            return i;
        }
    }
    return kNoIndex;
}

template <class Named>
[[nodiscard]] std::vector<std::string_view> names_of(const std::vector<Named>& all) {
    std::vector<std::string_view> names;
    for (const Named& one : all) {
        if (!one.name.empty()) {
            names.push_back(one.name);
        }
    }
    return names;
}

}  // namespace axg
