// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/section_file.hpp"

#include <sha2.h>

#include <bit>
#include <cstring>

#include "core/base/assert.hpp"

namespace axg {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kLetters = 4;
constexpr std::string_view kEnd = "DONE";

class Sum {
  public:
    Sum() { SHA256Init(&context_); }
    void add(std::string_view bytes) {
        SHA256Update(&context_, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    [[nodiscard]] Sha256 finish() {
        Sha256 out{};
        SHA256Final(out.data(), &context_);
        return out;
    }

  private:
    SHA2_CTX context_{};
};

std::string_view view_of(const Sha256& sum) {
    return {reinterpret_cast<const char*>(sum.data()), sum.size()};
}

/// @param section  letters, length and contents
Sha256 next_sum(const Sha256& before, std::string_view section) {
    Sum sum;
    sum.add(view_of(before));
    sum.add(section);
    return sum.finish();
}

}  // namespace

Sha256 sha256_of(std::string_view bytes) {
    Sum sum;
    sum.add(bytes);
    return sum.finish();
}

std::string hex_of(const Sha256& sum) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string out;
    for (const std::uint8_t byte : sum) {
        out += kDigits[byte >> 4];
        out += kDigits[byte & 15U];
    }
    return out;
}

void SectionBytes::put_varint(std::uint64_t value) {
    AXG_ASSERT(value >> 63 == 0);  // nine bytes hold 63 bits
    while (value >= 0x80) {
        bytes += static_cast<char>(static_cast<std::uint8_t>(value | 0x80));
        value >>= 7;
    }
    bytes += static_cast<char>(static_cast<std::uint8_t>(value));
}

void SectionBytes::put_zigzag(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    put_varint((bits << 1) ^ (value < 0 ? ~std::uint64_t{0} : 0));
}

void SectionBytes::put_text(std::string_view text) {
    AXG_ASSERT(text.size() <= UINT16_MAX);
    put(static_cast<std::uint16_t>(text.size()));
    bytes += text;
}

void SectionBytes::put_vector(const Vec3d& v) {
    put(v.x);
    put(v.y);
    put(v.z);
}

void SectionBytes::put_pose(const Pose& pose) {
    for (const auto& row : pose.r) {
        for (const double value : row) {
            put(value);
        }
    }
    for (const double value : pose.t) {
        put(value);
    }
}

std::string_view SectionReader::take(std::uint64_t count) noexcept {
    ok_ = ok_ && count <= rest_.size();
    if (!ok_) {
        return {};
    }
    const std::string_view out = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(out.size());
    return out;
}

std::uint64_t SectionReader::get_varint() noexcept {
    std::uint64_t value = 0;
    for (std::uint32_t i = 0; i < kVarintBytesMax; ++i) {
        const auto byte = get<std::uint8_t>();
        value |= static_cast<std::uint64_t>(byte & 0x7fU) << (7 * i);
        if ((byte & 0x80U) == 0) {
            return ok_ ? value : 0;
        }
    }
    ok_ = false;
    return 0;
}

std::int64_t SectionReader::get_zigzag() noexcept {
    const std::uint64_t bits = get_varint();
    const auto half = static_cast<std::int64_t>(bits >> 1);
    return (bits & 1U) != 0 ? -half - 1 : half;
}

std::string SectionReader::get_text() {
    return std::string(take(get<std::uint16_t>()));
}

void SectionFile::add(std::string_view letters, std::string_view contents) {
    AXG_ASSERT(letters.size() == kLetters);
    SectionBytes section;
    section.bytes = letters;
    section.put(static_cast<std::uint64_t>(contents.size()));
    section.bytes += contents;
    sum_ = next_sum(sum_, section.bytes);
    bytes_ += section.bytes;
}

std::string SectionFile::finish() {
    SectionBytes end;
    end.bytes = kEnd;
    end.put(static_cast<std::uint64_t>(sum_.size()));
    end.bytes += view_of(sum_);
    return bytes_ + end.bytes;
}

std::optional<std::vector<Section>> read_sections(std::string_view file) {
    std::vector<Section> out;
    SectionReader reader(file);
    Sha256 sum{};
    for (;;) {
        const std::string_view letters = reader.take(kLetters);
        const auto length = reader.get<std::uint64_t>();
        const std::string_view contents = reader.take(length);
        if (!reader.ok()) {
            return std::nullopt;
        }
        if (letters == kEnd) {
            const bool is_right = contents == view_of(sum) && reader.is_at_end();
            return is_right ? std::optional(std::move(out)) : std::nullopt;
        }
        sum = next_sum(sum, {letters.data(), kLetters + sizeof length + contents.size()});
        out.push_back({std::string(letters), contents});
    }
}

}  // namespace axg
