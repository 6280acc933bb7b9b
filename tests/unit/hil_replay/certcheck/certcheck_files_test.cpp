// SPDX-License-Identifier: Apache-2.0
// How axguard-certcheck reads bytes: sums against FIPS 180-4, and no read beyond a section.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hil_replay/certcheck/sections.hpp"

namespace axg::certcheck {
namespace {

std::vector<std::uint8_t> bytes_of(const std::string& text) {
    return {text.begin(), text.end()};
}

std::string hex(const Digest& digest) {
    std::string text;
    for (const std::uint8_t byte : digest) {
        text += "0123456789abcdef"[byte >> 4U];
        text += "0123456789abcdef"[byte & 15U];
    }
    return text;
}

TEST(CertcheckSum, IsThatOfTheStandard) {
    EXPECT_EQ(hex(sha256(bytes_of("abc"))),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(hex(sha256({})), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(hex(sha256(bytes_of(std::string(1000000, 'a')))),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Every length around a block, in two pieces and in one.
TEST(CertcheckSum, DoesNotDependOnThePieces) {
    for (std::size_t size = 0; size < 200; ++size) {
        const auto bytes = bytes_of(std::string(size, 'x'));
        for (std::size_t cut = 0; cut <= size; cut += 7) {
            Sha256 sum;
            sum.add(std::span(bytes).first(cut));
            sum.add(std::span(bytes).subspan(cut));
            EXPECT_EQ(sum.finish(), sha256(bytes)) << size << " " << cut;
        }
    }
}

TEST(CertcheckReader, ReadsNumbersOfTheFormat) {
    const std::vector<std::uint8_t> bytes{0x7f, 0x80, 0x01, 0x00, 0x01, 0x02, 0xff, 0xff,
                                          0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f};
    ByteReader in("x", bytes, 0);
    EXPECT_EQ(in.varint(), 127U);
    EXPECT_EQ(in.varint(), 128U);
    EXPECT_EQ(in.zigzag(), 0);
    EXPECT_EQ(in.zigzag(), -1);
    EXPECT_EQ(in.zigzag(), 1);
    EXPECT_EQ(in.varint(), (std::uint64_t{1} << 63U) - 1);
    in.end();
}

TEST(CertcheckReader, NeverReadsBeyondItsBytes) {
    const std::vector<std::uint8_t> bytes{0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0};
    EXPECT_THROW(ByteReader("x", bytes, 0).varint(), Refusal);  // ten bytes
    EXPECT_THROW(ByteReader("x", std::span(bytes).first(3), 0).varint(), Refusal);
    EXPECT_THROW(ByteReader("x", std::span(bytes).first(3), 0).number<std::uint32_t>(), Refusal);
    EXPECT_THROW(ByteReader("x", std::span(bytes).first(1), 0).text(), Refusal);
    EXPECT_THROW(ByteReader("x", std::span(bytes).first(3), 0).text(), Refusal);
    EXPECT_THROW(ByteReader("x", bytes, 0).end(), Refusal);
    EXPECT_THROW(ByteReader("x", bytes, 0).take(~std::size_t{0}), Refusal);
    try {
        ByteReader("x", bytes, 40).unreadable("why");
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.exit_code, 12);
        EXPECT_EQ(refusal.text, "x, byte 40: why");
    }
}

TEST(CertcheckReader, TakesNoNumberThatIsNone) {
    const double nan = std::nan("");
    std::vector<std::uint8_t> bytes(8);
    std::memcpy(bytes.data(), &nan, 8);
    EXPECT_THROW(ByteReader("x", bytes, 0).within<double>(-1e300, 1e300, "why"), Refusal);
}

TEST(CertcheckSections, RefusesWhatIsNoRowOfSections) {
    const auto code = [](const std::string& text) {
        const auto bytes = bytes_of(text);
        try {
            const Sections sections("x", bytes);
        } catch (const Refusal& refusal) {
            return refusal.exit_code;
        }
        return 0;
    };
    const std::string eight(8, '\0');
    const std::string zeros(32, '\0');
    const std::string length = std::string(1, ' ') + std::string(7, '\0');  // 32
    EXPECT_EQ(code("DONE" + length + zeros), 0);                            // the sum of nothing
    EXPECT_EQ(code("DONE" + length + zeros + "x"), 12);
    EXPECT_EQ(code("HEAD" + eight + "DONE" + length + zeros), 10);
    EXPECT_EQ(code("HEAD" + eight), 12);
    EXPECT_EQ(code("HE"), 12);
    EXPECT_EQ(code(""), 12);
    EXPECT_EQ(code("head" + eight + "DONE" + length + zeros), 12);
    EXPECT_EQ(code("HEAD" + std::string(8, '\xff') + "DONE" + length + zeros), 12);
    EXPECT_EQ(code("DONE" + eight), 12);
}

}  // namespace
}  // namespace axg::certcheck
