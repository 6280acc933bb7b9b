// SPDX-License-Identifier: Apache-2.0
// The latch in memory: one pattern of two words says clear, and every other says stopped.
#include <gtest/gtest.h>

#include "firmware_if/guard/guard_node.hpp"

namespace axg {
namespace {

TEST(Latch, OnlyTheExactPatternIsClear) {
    LatchCell cell;
    EXPECT_TRUE(is_latched(cell)) << "a new page is zeros";
    set_latch(cell, false);
    EXPECT_FALSE(is_latched(cell));
    const LatchCell clear = cell;
    for (int bit = 0; bit < 64; ++bit) {
        cell = clear;
        cell.word ^= std::uint64_t{1} << bit;
        EXPECT_TRUE(is_latched(cell));
        cell = clear;
        cell.inverse ^= std::uint64_t{1} << bit;
        EXPECT_TRUE(is_latched(cell));
    }
    set_latch(cell, true);
    EXPECT_TRUE(is_latched(cell));
}

}  // namespace
}  // namespace axg
