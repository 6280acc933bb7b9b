// SPDX-License-Identifier: Apache-2.0
// A section's bytes, read in order; nothing is read beyond them.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace axg::certcheck {

/// Why the files do not prove what they claim. Thrown; `check_files` turns it into an exit code.
struct Refusal {
    int exit_code;  // 10: not proven; 12: not readable
    std::string text;
};

class ByteReader {
  public:
    ByteReader() = default;
    /// @param offset place of the first byte in its file, for messages
    ByteReader(std::string name, std::span<const std::uint8_t> bytes, std::uint64_t offset)
        : name_(std::move(name)), bytes_(bytes), offset_(offset) {}

    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] std::string place() const {
        return name_ + ", byte " + std::to_string(offset_ + at_);
    }
    [[noreturn]] void unreadable(const std::string& what) const {
        throw Refusal{12, place() + ": " + what};
    }
    void require(bool holds, const char* what) const {
        if (!holds) {
            unreadable(what);
        }
    }
    std::span<const std::uint8_t> take(std::size_t count) {
        require(count <= left(), "the section ends too early");
        at_ += count;
        return bytes_.subspan(at_ - count, count);
    }
    template <class Number>
    Number number() {
        static_assert(std::endian::native == std::endian::little);
        Number value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::uint64_t varint() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 63; shift += 7) {
            const auto byte = number<std::uint8_t>();
            value |= std::uint64_t{byte & 0x7fU} << shift;
            if (byte < 0x80) {
                return value;
            }
        }
        unreadable("a number has more than nine bytes");
    }
    std::int64_t zigzag() {
        const std::uint64_t value = varint();
        const auto half = static_cast<std::int64_t>(value >> 1);
        return (value & 1U) == 0 ? half : -half - 1;
    }
    /// A name; what is no printable ASCII is shown as '?'.
    std::string text() {
        std::string name;
        for (const std::uint8_t byte : take(number<std::uint16_t>())) {
            name += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
        }
        return name;
    }
    /// A finite number in [low, high].
    template <class Number>
    double within(double low, double high, const char* what) {
        const double value = static_cast<double>(number<Number>());
        require(value >= low && value <= high, what);
        return value;
    }
    void end() const { require(left() == 0, "the section has bytes left over"); }

  private:
    std::string name_;
    std::span<const std::uint8_t> bytes_;
    std::uint64_t offset_ = 0;
    std::size_t at_ = 0;
};

}  // namespace axg::certcheck
