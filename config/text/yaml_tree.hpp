// SPDX-License-Identifier: Apache-2.0
// A YAML document as a plain tree with line numbers, built in one bounded pass over the parser's
// events: no node of the library's own is ever made, so aliases cannot multiply and depth cannot
// run away. The pass refuses anchors, aliases, tags, duplicate or odd keys and a second document,
// and reports each with its line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace axg {

class FaultList;

inline constexpr std::size_t kYamlSizeBytesMax = 1U << 20U;
inline constexpr int kYamlDepthMax = 16;
inline constexpr std::uint32_t kYamlNodesMax = 100'000;

struct YamlEntry;

struct YamlNode {
    enum class Kind : std::uint8_t { nothing, scalar, sequence, map, refused };
    Kind kind = Kind::nothing;  // refused: already reported, report no more about it
    int line = 0;
    bool is_quoted = false;          // a quoted or block text: never a number or a bool
    std::string text;                // scalar
    std::vector<YamlEntry> entries;  // sequence (keys empty) or map, in the order of the file
};

struct YamlEntry {
    std::string key;
    int line = 0;  // of the key
    YamlNode value;
};

/// Reads one document. True when the text is YAML to its end; the tree then represents it, and
/// `faults` holds what was refused on the way. False after a fault that leaves no tree worth
/// reading. Bounded by the three limits above, in time as well. Never throws.
[[nodiscard]] bool parse_yaml(const std::string& text, FaultList& faults, YamlNode& root);

}  // namespace axg
