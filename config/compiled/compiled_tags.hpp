// SPDX-License-Identifier: Apache-2.0
// Tags of the sections of a compiled machine, for its writer and its reader.
#pragma once

#include <cstdint>
#include <string_view>

namespace axg::compiled {

inline constexpr std::string_view kText = "TEXT";    // the machine file
inline constexpr std::string_view kNamed = "FILE";   // a file that it names
inline constexpr std::string_view kHashes = "HASH";  // effective text, hashes
inline constexpr std::string_view kNotes = "NOTE";   // oddities of surfaces, allowed by name
inline constexpr std::string_view kMesh = "MESH";    // one surface

inline constexpr std::string_view kPairs = "PAIR";  // surfaces of pairs, and proofs of the travel

enum class SurfaceList : std::uint8_t { bodies, tools, simple_bodies, simple_tools, of_pairs };
inline constexpr std::uint32_t kSurfaceLists = 5;

}  // namespace axg::compiled
