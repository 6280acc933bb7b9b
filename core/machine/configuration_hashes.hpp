// SPDX-License-Identifier: Apache-2.0
// Four hashes of the machine that board and guard compare before motion. Contents of each:
// docs/reference/protocol.md, "Hashes".
#pragma once

#include <array>
#include <cstdint>

namespace axg {

inline constexpr std::uint32_t kHashParts = 4;
inline constexpr std::array<const char*, kHashParts> kHashPartNames{"model", "kinematics", "tools",
                                                                    "limits"};

struct ConfigurationHashes {
    std::array<std::uint32_t, kHashParts> of{};  // in the order of the names

    friend constexpr bool operator==(const ConfigurationHashes&,
                                     const ConfigurationHashes&) = default;
};

}  // namespace axg
