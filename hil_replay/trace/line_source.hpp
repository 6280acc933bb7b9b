// SPDX-License-Identifier: Apache-2.0
// Lines of a text file, or of text in memory, with fixed memory: a log may be larger than the RAM.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

inline constexpr std::size_t kLineBytesMax = std::size_t{1} << 16U;  // no trace format comes near

class LineSource {
  public:
    /// @param text  must outlive the source
    explicit LineSource(std::string_view text) noexcept : rest_(text), at_end_(true) {}
    /// Owns the file from now on.
    explicit LineSource(std::FILE* file);
    ~LineSource();
    LineSource(const LineSource&) = delete;
    LineSource& operator=(const LineSource&) = delete;

    /// The next line without its end (LF or CR LF), a byte-order mark at the start left out. False
    /// at the end and on a read error; then error() is set. The view is valid until the next call.
    [[nodiscard]] bool next(std::string_view& line);
    /// The line is longer than kLineBytesMax: next() gave only how it begins.
    [[nodiscard]] bool is_too_long() const noexcept { return is_too_long_; }
    [[nodiscard]] const std::string& error() const noexcept { return error_; }
    [[nodiscard]] std::uint64_t line_number() const noexcept { return line_number_; }
    /// The share of the file that was read, 0 to 1. 0: of unknown size.
    [[nodiscard]] double share() const noexcept;

  private:
    bool take(std::string_view& line);
    void pass_rest_of_line();
    bool refill();

    std::FILE* file_ = nullptr;
    std::uint64_t file_bytes_ = 0, read_bytes_ = 0;
    std::vector<char> buffer_;
    std::string_view rest_;
    bool at_end_ = false, is_too_long_ = false;
    std::string begin_;  // of a line that is too long
    std::uint64_t line_number_ = 0;
    std::string error_;
};

}  // namespace axg
