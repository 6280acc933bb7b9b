// SPDX-License-Identifier: Apache-2.0
// Sections with a chain of sums: what is written reads back, and any changed byte is refused.
#include "hil_replay/certify/section_file.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace axg {
namespace {

TEST(SectionFile, NumbersReadBack) {
    SectionBytes out;
    const std::int64_t ends[] = {
        0, 1, -1, 63, -64, 64, -65, 1000000000000, -1000000000000, (1LL << 62) - 1, -(1LL << 62)};
    for (const std::int64_t value : ends) {
        out.put_zigzag(value);
    }
    out.put_varint(127);
    out.put_varint(128);
    out.put_text("X");
    SectionReader in(out.bytes);
    for (const std::int64_t value : ends) {
        EXPECT_EQ(in.get_zigzag(), value);
    }
    EXPECT_EQ(in.get_varint(), 127U);
    EXPECT_EQ(in.get_varint(), 128U);
    EXPECT_EQ(in.get_text(), "X");
    EXPECT_TRUE(in.is_at_end());
    EXPECT_EQ(in.get<std::uint32_t>(), 0U);
    EXPECT_FALSE(in.ok());
}

TEST(SectionFile, AVarintHasNineBytesAtMost) {
    const std::string nine = std::string(8, '\xff') + '\x7f';
    SectionReader in(nine);
    EXPECT_EQ(in.get_varint(), UINT64_MAX >> 1);
    SectionReader longer(std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", 10));
    (void)longer.get_varint();
    EXPECT_FALSE(longer.ok());
}

// The sums of the empty text and of "abc", FIPS 180-2.
TEST(SectionFile, SumsAreSha256) {
    EXPECT_EQ(hex_of(sha256_of("")),
              "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(hex_of(sha256_of("abc")),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(SectionFile, EveryChangedByteIsRefused) {
    SectionFile file;
    file.add("HEAD", "one");
    file.add("PATH", std::string("\0two", 4));
    const std::string bytes = file.finish();
    const auto sections = read_sections(bytes);
    ASSERT_TRUE(sections);
    ASSERT_EQ(sections->size(), 2U);
    EXPECT_EQ((*sections)[1].letters, "PATH");
    EXPECT_EQ((*sections)[1].contents, std::string_view("\0two", 4));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string other = bytes;
        other[i] = static_cast<char>(other[i] ^ 4);
        EXPECT_FALSE(read_sections(other)) << i;
        EXPECT_FALSE(read_sections(bytes.substr(0, i))) << i;
    }
    EXPECT_FALSE(read_sections(bytes + '\0'));
}

}  // namespace
}  // namespace axg
