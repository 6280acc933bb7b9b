// SPDX-License-Identifier: Apache-2.0
// The checksum eight bytes at a time is the one of the definition, bit by bit, of every length and
// from every earlier part on.
#include "core/base/crc32.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace axg {
namespace {

std::uint32_t by_definition(std::span<const std::uint8_t> bytes) {
    std::uint32_t rest = ~0U;
    for (const std::uint8_t byte : bytes) {
        rest ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? 0xEDB88320U : 0U);
        }
    }
    return ~rest;
}

// IEEE 802.3's check value of "123456789".
TEST(Crc32, IsTheKnownOne) {
    constexpr std::string_view kText = "123456789";
    EXPECT_EQ(crc32({reinterpret_cast<const std::uint8_t*>(kText.data()), kText.size()}),
              0xCBF43926U);
    EXPECT_EQ(crc32({}), 0U);
}

TEST(Crc32, IsThatOfTheDefinitionInOnePieceAndInTwo) {
    std::vector<std::uint8_t> bytes;
    for (std::uint32_t i = 0; i < 67; ++i) {
        const std::span<const std::uint8_t> all(bytes);
        EXPECT_EQ(crc32(all), by_definition(all)) << i;
        for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
            ASSERT_EQ(crc32(all.subspan(cut), crc32(all.first(cut))), crc32(all)) << cut;
        }
        bytes.push_back(static_cast<std::uint8_t>(i * 151U + 87U));
    }
}

}  // namespace
}  // namespace axg
