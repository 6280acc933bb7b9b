// SPDX-License-Identifier: Apache-2.0
// Files of sections with a chain of SHA-256, for certificates and models.
// Source: docs/reference/certificate-file.md, "Bytes".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"

namespace axg {

using Sha256 = std::array<std::uint8_t, 32>;
[[nodiscard]] Sha256 sha256_of(std::string_view bytes);
[[nodiscard]] std::string hex_of(const Sha256& sum);

inline constexpr std::uint32_t kVarintBytesMax = 9;

/// The contents of a section.
class SectionBytes {
  public:
    std::string bytes;

    template <class T>
    void put(const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void put_varint(std::uint64_t value);
    void put_zigzag(std::int64_t value);
    /// Precondition: fewer than 2^16 bytes.
    void put_text(std::string_view text);
    void put_vector(const Vec3d& v);
    void put_pose(const Pose& pose);
};

/// Reads what SectionBytes wrote. After a read beyond the end ok() is false and every value zero.
class SectionReader {
  public:
    explicit SectionReader(std::string_view bytes) noexcept : rest_(bytes) {}

    [[nodiscard]] bool ok() const noexcept { return ok_; }
    [[nodiscard]] bool is_at_end() const noexcept { return ok_ && rest_.empty(); }
    template <class T>
    [[nodiscard]] T get() noexcept {
        static_assert(std::is_arithmetic_v<T>);
        T value{};
        if (const std::string_view bytes = take(sizeof value); ok_) {
            bytes.copy(reinterpret_cast<char*>(&value), sizeof value);
        }
        return value;
    }
    [[nodiscard]] std::uint64_t get_varint() noexcept;
    [[nodiscard]] std::int64_t get_zigzag() noexcept;
    [[nodiscard]] std::string get_text();
    [[nodiscard]] std::string_view take(std::uint64_t count) noexcept;

  private:
    std::string_view rest_;
    bool ok_ = true;
};

/// The bytes of a file: sections one after the other, then DONE with their sum.
class SectionFile {
  public:
    /// @param letters  four
    void add(std::string_view letters, std::string_view contents);
    /// Ends the file.
    [[nodiscard]] std::string finish();

  private:
    std::string bytes_;
    Sha256 sum_{};
};

struct Section {
    std::string letters;
    std::string_view contents;
};
/// The sections before DONE. Empty: no such file, or the sums do not fit.
[[nodiscard]] std::optional<std::vector<Section>> read_sections(std::string_view file);

}  // namespace axg
