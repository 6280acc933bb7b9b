// SPDX-License-Identifier: Apache-2.0
// Reads an EDS or DCF file (CiA 306): which transmit PDOs a CANopen device sends, under which
// identifier, and their content.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/text/config_fault.hpp"

namespace axg {

inline constexpr std::size_t kEdsSizeBytesMax = std::size_t{4} << 20U;
inline constexpr std::size_t kEdsEntriesMax = 200'000;

/// One transmit PDO as objects 0x1800 + n and 0x1A00 + n describe it.
struct EdsPdo {
    std::uint32_t number = 1;  // TPDO1 is 1
    int line = 0;              // of its COB-ID
    std::uint32_t cob_id = 0;  // 0x1800 + n, sub 1: bit 31 is off, bit 29 an extended id
    std::uint32_t transmission_type = 0;
    // What DefaultValue gives this node, if a file that names no node has another ParameterValue.
    std::optional<std::uint32_t> default_cob_id{};
    std::vector<std::uint32_t> map;  // index << 16 | subindex << 8 | bits, the active ones
};

struct Eds {
    std::optional<std::uint32_t> node;  // DCF: what it was written for
    std::vector<EdsPdo> pdos;           // those whose objects are complete
};

/// ParameterValue (DCF) overrides DefaultValue; $NODEID is `node`. Returns no faults, or leaves
/// `out` untouched and returns the faults. Time: proportional to the text.
[[nodiscard]] std::vector<ConfigFault> parse_eds(std::string_view text, const std::string& file,
                                                 std::uint32_t node, Eds& out);

}  // namespace axg
