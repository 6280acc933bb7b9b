// SPDX-License-Identifier: Apache-2.0
// The frames of tests/vectors/permit2.json with the guard's own checksums, which share no code with
// the library for boards nor with the script that wrote the file.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/support/json_value.hpp"

namespace axg {
namespace {

using Bytes = std::vector<std::uint8_t>;

const test::Json& vectors() {
    static const test::Json all =
        test::Json::parse_file(AXG_SOURCE_DIR "/tests/vectors/permit2.json");
    return all;
}

Bytes bytes_of(const test::Json& text) {
    const auto hex = text.get<std::string>();
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

void put(Bytes& to, std::uint32_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
        to.push_back(static_cast<std::uint8_t>(value >> (8U * i)));
    }
}

TEST(BoardVectors, ChecksumsAreTheGuards) {
    const std::string digits = "123456789";
    const Bytes bytes(digits.begin(), digits.end());
    EXPECT_EQ(std::stoul(vectors()["checks"]["crc16"].get<std::string>(), nullptr, 16),
              crc16_ccitt(bytes));
    EXPECT_EQ(std::stoul(vectors()["checks"]["crc8"].get<std::string>(), nullptr, 16),
              crc8_h2f(bytes));
}

TEST(BoardVectors, PermitsHaveTheAnswerForTheirNonceAndLap) {
    ASSERT_GE(vectors()["permits"].size(), 6U);
    for (const auto& one : vectors()["permits"]) {
        SCOPED_TRACE(one["name"].get<std::string>());
        const Bytes plain = bytes_of(one["plain"]), twin = bytes_of(one["twin"]);
        Bytes content;
        for (const char* const key : {"word", "echo", "live", "cap", "mask"}) {
            content.push_back(one[key].get<std::uint8_t>());
        }
        content.push_back(static_cast<std::uint8_t>(one["n"].get<unsigned>() << 4U |
                                                    one["level"].get<unsigned>()));
        Bytes covered = content;
        put(covered, one["nonce"].get<std::uint32_t>(), 3);
        put(covered, one["lap"].get<std::uint32_t>(), 2);
        const unsigned answer = crc16_ccitt(covered) ^ 0xC5A3U;
        const Bytes made{content[0],
                         content[1],
                         content[2],
                         static_cast<std::uint8_t>(answer),
                         static_cast<std::uint8_t>(answer >> 8U),
                         content[3],
                         content[4],
                         content[5]};
        EXPECT_EQ(made, plain);
        ASSERT_EQ(twin.size(), 8U);
        for (std::size_t i = 0; i < 8; ++i) {
            EXPECT_EQ(twin[i], static_cast<std::uint8_t>(~plain[i]));
        }
    }
}

TEST(BoardVectors, SessionsAreSealedWithTheirDataId) {
    for (const auto& one : vectors()["sessions"]) {
        const Bytes frame = bytes_of(one["frame"]);
        ASSERT_EQ(frame.size(), 8U);
        const std::span<const std::uint8_t, 8> bytes(frame.data(), 8);
        EXPECT_EQ(frame[0], classical_crc(bytes, 0x583));
        EXPECT_EQ(frame[1], 0x10U | one["counter"].get<unsigned>());
        EXPECT_EQ(frame[2], one["sync"].get<unsigned>());
        EXPECT_EQ(frame[3] | frame[4] << 8, one["lap"].get<int>());
        EXPECT_EQ(frame[5] | frame[6] << 8 | frame[7] << 16, one["nonce"].get<int>());
    }
}

// A reader of the file may rely on it: each refusal that a board knows is in a script.
TEST(BoardVectors, EveryRefusalIsInAScript) {
    std::set<std::string> found;
    for (const auto& script : vectors()["scripts"]) {
        for (const auto& step : script["steps"]) {
            if (step["do"] == "frame" && step["want"] == "refused") {
                found.insert(step["why"].get<std::string>());
            }
        }
    }
    EXPECT_EQ(found,
              (std::set<std::string>{"answer", "cap", "echo", "jog", "late", "live", "old_echo",
                                     "samples", "shape", "stopped", "twin_alone", "twin_differs",
                                     "twin_late", "twin_missing", "value", "word"}));
}

}  // namespace
}  // namespace axg
