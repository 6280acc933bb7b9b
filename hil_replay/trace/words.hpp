// SPDX-License-Identifier: Apache-2.0
// Words of a line, one after the other, and the numbers they may be.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

namespace axg::detail {

class Words {
  public:
    explicit constexpr Words(std::string_view line) noexcept : rest_(line) {}

    /// The next word, empty at the end of the line.
    std::string_view next() noexcept {
        skip();
        std::size_t length = 0;
        while (length < rest_.size() && rest_[length] != ' ' && rest_[length] != '\t') {
            ++length;
        }
        const std::string_view word = rest_.substr(0, length);
        rest_.remove_prefix(length);
        return word;
    }
    [[nodiscard]] std::string_view peek() const noexcept { return Words(*this).next(); }
    [[nodiscard]] std::string_view rest() noexcept {
        skip();
        return rest_;
    }

  private:
    void skip() noexcept {
        while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) {
            rest_.remove_prefix(1);
        }
    }
    std::string_view rest_;
};

/// The whole word as an unsigned number in `base`, no larger than `max`.
[[nodiscard]] inline bool to_number(std::string_view word, int base, std::uint32_t max,
                                    std::uint32_t& value) noexcept {
    const char* end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, value, base);
    return !word.empty() && result.ec == std::errc{} && result.ptr == end && value <= max;
}

}  // namespace axg::detail
