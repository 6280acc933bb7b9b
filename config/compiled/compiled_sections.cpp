// SPDX-License-Identifier: Apache-2.0
#include "config/compiled/compiled_sections.hpp"

#include <fmt/format.h>
#include <sha2.h>

#include <array>
#include <span>

#include "config/compiled/byte_fields.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/crc32.hpp"
#include "core/base/limits.hpp"

namespace axg {
namespace {

/// Like PNG's: the first byte is not ASCII, and a transfer in text mode changes the others.
constexpr std::string_view kMagic{
    "\x89"
    "AXG\r\n\x1a\n",
    8};
constexpr std::string_view kEndTag = "DONE";
constexpr std::size_t kHeadBytes = kMagic.size() + 12;  // version, width, checksum
constexpr std::size_t kSectionBytes = kTagBytes + sizeof(std::uint64_t);  // before the payload
constexpr std::size_t kSumBytes = 4;

std::uint32_t crc_of(std::string_view bytes) noexcept {
    return crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string sha256_of(std::string_view bytes) {
    SHA2_CTX context;
    SHA256Init(&context);
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
    SHA256Final(digest.data(), &context);
    return {digest.begin(), digest.end()};
}

/// The checksum of everything from `begin` on, behind it.
void put_sum(ByteWriter& out, std::size_t begin) {
    out.put(crc_of(std::string_view(out.bytes).substr(begin)));
}

void put_section(ByteWriter& out, std::string_view tag, std::string_view payload) {
    const std::size_t begin = out.bytes.size();
    out.bytes += tag;
    out.put(static_cast<std::uint64_t>(payload.size()));
    out.bytes += payload;
    put_sum(out, begin);
}

SectionFault check_head(std::string_view bytes, Sums sums) {
    if (bytes.size() < kHeadBytes || !bytes.starts_with(kMagic)) {
        return {"head", 0, "a file that is not a compiled machine"};
    }
    ByteReader in(bytes.substr(kMagic.size(), kHeadBytes - kMagic.size()));
    const auto version = in.get<std::uint32_t>();
    const auto width = in.get<std::uint32_t>();
    const auto sum = in.get<std::uint32_t>();
    if (sums == Sums::checked && sum != crc_of(bytes.substr(0, kHeadBytes - kSumBytes))) {
        return {"head", 0, "a wrong checksum"};
    }
    if (version != kCompiledVersion) {
        return {"head", 0,
                fmt::format("format {}, this axguard reads format {}", version, kCompiledVersion)};
    }
    if (width != kNodeWidth) {
        return {"head", 0,
                fmt::format("trees {} wide, this axguard's are {} wide", width, kNodeWidth)};
    }
    return {};
}

/// The section at `at`, and behind it the next one in `at`.
SectionFault take_one(std::string_view bytes, Sums sums, std::size_t& at, SectionView& out) {
    const std::string_view rest = bytes.substr(at);
    if (rest.size() < kSectionBytes + kSumBytes) {
        return {"end", at, "a truncated file"};
    }
    const std::string_view tag = rest.substr(0, kTagBytes);
    const auto size =
        ByteReader(rest.substr(kTagBytes, kSectionBytes - kTagBytes)).get<std::uint64_t>();
    if (size > rest.size() - kSectionBytes - kSumBytes) {
        return {escaped(tag), at, fmt::format("{} bytes, beyond the end of the file", size)};
    }
    const std::size_t whole = kSectionBytes + static_cast<std::size_t>(size);
    const auto sum = ByteReader(rest.substr(whole, kSumBytes)).get<std::uint32_t>();
    if (sums == Sums::checked && sum != crc_of(rest.substr(0, whole))) {
        return {escaped(tag), at, "a wrong checksum"};
    }
    out = {tag, rest.substr(kSectionBytes, static_cast<std::size_t>(size)), at};
    at += whole + kSumBytes;
    return {};
}

}  // namespace

std::string put_sections(const std::vector<CompiledSection>& sections) {
    ByteWriter out;
    out.bytes = kMagic;
    out.put(kCompiledVersion);
    out.put(kNodeWidth);
    put_sum(out, 0);
    for (const CompiledSection& section : sections) {
        put_section(out, section.tag, section.payload);
    }
    put_section(out, kEndTag, sha256_of(out.bytes));
    return std::move(out.bytes);
}

SectionFault take_sections(std::string_view bytes, Sums sums, std::vector<SectionView>& out) {
    out.clear();
    SectionFault fault = check_head(bytes, sums);
    std::size_t at = kHeadBytes;
    while (fault.got.empty()) {
        SectionView section;
        fault = take_one(bytes, sums, at, section);
        if (!fault.got.empty()) {
            break;
        }
        if (section.tag != kEndTag) {
            out.push_back(section);
            continue;
        }
        if (at != bytes.size()) {
            return {"end", at, fmt::format("{} bytes after the last section", bytes.size() - at)};
        }
        if (sums == Sums::checked && section.payload != sha256_of(bytes.substr(0, section.at))) {
            return {"end", section.at, "a wrong hash of the file"};
        }
        return {};
    }
    return fault;
}

}  // namespace axg
