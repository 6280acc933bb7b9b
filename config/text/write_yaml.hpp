// SPDX-License-Identifier: Apache-2.0
// A tree of a machine file back to text that parse_yaml() reads as the same tree.
#pragma once

#include <string>

#include "config/text/yaml_tree.hpp"

namespace axg {

/// The line of an entry that no file had: write_yaml() marks it.
inline constexpr int kDefaultLine = -1;

/// Maps in block style, lists of values on one line. An entry of kDefaultLine ends in "# default";
/// without a value it is a comment, "# key: none", for a key whose absence is the value.
[[nodiscard]] std::string write_yaml(const YamlNode& map);

}  // namespace axg
