// SPDX-License-Identifier: Apache-2.0
// What an arena hands out is zeroed, aligned and nobody else's; after the seal, and beyond its end,
// the program stops.
#include "core/base/arena.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>

namespace axg {
namespace {

TEST(Arena, HandsOutZeroedAlignedRoomThatDoesNotOverlap) {
    Arena arena(Arena::size_bytes<char>(3) + Arena::size_bytes<double>(9));
    ASSERT_TRUE(arena.ok());
    const std::span<char> first = arena.take<char>(3);
    const std::span<double> second = arena.take<double>(9);
    EXPECT_EQ(first.size(), 3U);
    EXPECT_EQ(second.size(), 9U);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first.data()) % Arena::kAlignment, 0U);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(second.data()) % Arena::kAlignment, 0U);
    EXPECT_GE(reinterpret_cast<char*>(second.data()), first.data() + first.size());
    for (const char c : first) {
        EXPECT_EQ(c, 0);
    }
    for (const double d : second) {
        EXPECT_EQ(d, 0);
    }
}

TEST(Arena, RoundsEveryRoomUpToTheAlignment) {
    EXPECT_EQ(Arena::size_bytes<char>(0), 0U);
    EXPECT_EQ(Arena::size_bytes<char>(1), Arena::kAlignment);
    EXPECT_EQ(Arena::size_bytes<char>(Arena::kAlignment), Arena::kAlignment);
    EXPECT_EQ(Arena::size_bytes<char>(Arena::kAlignment + 1), 2 * Arena::kAlignment);
}

TEST(ArenaDeathTest, TakingMoreThanThereIsStopsTheProgram) {
    Arena exact(Arena::size_bytes<double>(8));
    EXPECT_EQ(exact.take<double>(8).size(), 8U);
    EXPECT_DEATH((void)exact.take<double>(1), "");
    Arena fresh(Arena::size_bytes<double>(8));
    EXPECT_DEATH((void)fresh.take<double>(9), "");
}

TEST(ArenaDeathTest, ACountWhoseBytesWrapAroundStopsTheProgram) {
    Arena arena(64);
    const std::size_t wraps = std::numeric_limits<std::size_t>::max() / sizeof(double) + 2;
    EXPECT_DEATH((void)arena.take<double>(wraps), "");
}

TEST(ArenaDeathTest, TakingAfterTheSealStopsTheProgram) {
    Arena arena(256);
    (void)arena.take<char>(1);
    arena.seal();
    EXPECT_DEATH((void)arena.take<char>(1), "");
}

TEST(ArenaDeathTest, AMovedArenaStaysSealedAndLeavesNothingBehind) {
    Arena arena(256);
    arena.seal();
    Arena moved(std::move(arena));
    EXPECT_TRUE(moved.ok());
    EXPECT_FALSE(arena.ok());  // NOLINT(bugprone-use-after-move): that is the question
    EXPECT_DEATH((void)moved.take<char>(1), "");
}

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kHugeEndsTheProgram = true;
#elif defined(__has_feature)
constexpr bool kHugeEndsTheProgram = __has_feature(address_sanitizer);
#else
constexpr bool kHugeEndsTheProgram = false;
#endif

TEST(Arena, SaysWhenThereIsNotThatMuchMemory) {
    if (kHugeEndsTheProgram) {
        GTEST_SKIP() << "the address sanitizer ends a program that asks for this much";
    }
    Arena arena(std::size_t{1} << 60U);
    EXPECT_FALSE(arena.ok());
}

void log_failure(const char*, const char*, int) noexcept {
    std::fputs("handler was called\n", stderr);
}

TEST(AssertDeathTest, CallsTheHandlerOnceThenEndsTheProcess) {
    EXPECT_DEATH(
        {
            (void)set_fail_stop(&log_failure);
            AXG_ASSERT(1 > 2);
        },
        "handler was called");
    const FailStop before = set_fail_stop(&log_failure);
    EXPECT_EQ(set_fail_stop(before), &log_failure);
}

}  // namespace
}  // namespace axg
