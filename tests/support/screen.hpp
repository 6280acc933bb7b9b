// SPDX-License-Identifier: Apache-2.0
// A printed text as a reader's screen has it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace axg::test {

inline constexpr std::size_t kScreenLines = 24, kScreenColumns = 100;

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

inline std::size_t widest(const std::vector<std::string>& lines) {
    std::size_t columns = 0;
    for (const std::string& line : lines) {
        columns = std::max(columns, line.size());
    }
    return columns;
}

}  // namespace axg::test
