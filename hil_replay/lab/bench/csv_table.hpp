// SPDX-License-Identifier: Apache-2.0
// A comma-separated table with a head line, as the scene folder uses it: columns found by name.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

class CsvTable {
  public:
    /// Reads the whole file. False on failure, with FILE:LINE and what was expected in `error()`.
    /// Every row must have as many cells as the head; blank lines are skipped.
    [[nodiscard]] bool read(const std::string& path, std::span<const std::string_view> columns);

    [[nodiscard]] std::size_t row_count() const noexcept { return lines_.size(); }
    /// @param column  index into `columns` of read()
    [[nodiscard]] std::string_view cell(std::size_t row, std::size_t column) const noexcept {
        return cells_[row * column_count_ + column];
    }
    /// FILE:LINE of a row.
    [[nodiscard]] std::string where(std::size_t row) const;
    [[nodiscard]] const std::string& error() const noexcept { return error_; }

  private:
    [[nodiscard]] bool refuse(std::uint64_t line, const std::string& message);

    std::string path_, text_, error_;
    std::size_t column_count_ = 0;
    std::vector<std::string_view> cells_;
    std::vector<std::uint64_t> lines_;
};

/// A finite decimal number and nothing else.
[[nodiscard]] bool read_number(std::string_view text, double& out) noexcept;

}  // namespace axg
