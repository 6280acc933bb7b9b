// SPDX-License-Identifier: Apache-2.0
// The hints byte by byte, and what they say of a cycle with and without a permit.
#include "firmware_if/protocol/hints_frame.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace axg {
namespace {

CycleResult permitted(std::uint32_t pair, double distance_mm) {
    CycleResult result{.has_permit = true};
    result.advisories.pair = pair;
    result.advisories.distance_mm = distance_mm;
    return result;
}

TEST(HintsFrame, FiveBytesLowByteFirst) {
    const CanFrame frame =
        encode_hints({}, {.sync_counter = 17, .pair = 0x0203, .distance_10um = 0x0405}, 9);
    EXPECT_EQ(frame.id, 0x682U);
    EXPECT_EQ(frame.length_bytes, 5);
    EXPECT_EQ(frame.time_us, 9);
    const std::array<std::uint8_t, 5> bytes{17, 3, 2, 5, 4};
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), frame.data.begin()));
}

TEST(HintsFrame, OfAPermitThePairThatIsNearest) {
    EXPECT_EQ(hints_of(permitted(2, 1.239), 40).pair, 2);
    EXPECT_EQ(hints_of(permitted(2, 1.239), 40).distance_10um, 123) << "a lower bound";
    EXPECT_EQ(hints_of(permitted(2, 1.239), 40).sync_counter, 40);
    EXPECT_EQ(hints_of(permitted(kNoIndex, 0), 1).pair, kHintNone);
}

TEST(HintsFrame, DistancesAreClampedToTheField) {
    EXPECT_EQ(hints_of(permitted(0, 655.34), 1).distance_10um, 65534);
    EXPECT_EQ(hints_of(permitted(0, 1e9), 1).distance_10um, 65535);
    EXPECT_EQ(hints_of(permitted(0, -1), 1).distance_10um, 0);
    EXPECT_EQ(hints_of(permitted(0, std::numeric_limits<double>::quiet_NaN()), 1).distance_10um, 0);
}

TEST(HintsFrame, WithoutAPermitThePairThatIsNotProven) {
    CycleResult result{.pair = 7};
    result.advisories.pair = 2;
    result.advisories.distance_mm = 5;
    EXPECT_EQ(hints_of(result, 1).pair, 7);
    EXPECT_EQ(hints_of(result, 1).distance_10um, 0);
}

}  // namespace
}  // namespace axg
