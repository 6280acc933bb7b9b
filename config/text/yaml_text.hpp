// SPDX-License-Identifier: Apache-2.0
// A machine file's text before the YAML parser sees it: what no machine file needs and a parser may
// stumble over.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace axg {

class FaultList;

class YamlText {
  public:
    /// `text` must outlive this object.
    explicit YamlText(std::string_view text);

    /// True when the text is UTF-8 without control characters, directives or brackets nested
    /// absurdly deep; else the reason is in `faults`.
    [[nodiscard]] bool check(FaultList& faults) const;

    /// The byte at line and column, both from 0; 0 beyond the end.
    [[nodiscard]] char at(int line, int column) const noexcept;

  private:
    [[nodiscard]] bool check_signs(FaultList& faults) const;
    [[nodiscard]] bool check_characters(FaultList& faults) const;

    std::string_view text_;
    std::vector<std::size_t> line_starts_;
};

}  // namespace axg
