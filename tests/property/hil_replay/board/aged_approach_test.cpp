// SPDX-License-Identifier: Apache-2.0
// Approaches in closed loop of a board whose frames carry positions of a SYNC or two before, as a
// pipelined register makes them. Where the machine file says so (can.latched_age_us) no approach
// touches, and no healthy board is stopped for its limits or its cap; where it does not, some do.
// AXG_COUNT: approaches of each kind; AXG_SEED: the first.
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "tests/support/approach_tally.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualAges = 150;
constexpr std::array<std::pair<const char*, Aim>, 6> kAims{{{"straight", Aim::straight},
                                                            {"crawl", Aim::crawl},
                                                            {"turn", Aim::turn},
                                                            {"tool", Aim::tool},
                                                            {"let go", Aim::let_go},
                                                            {"announce", Aim::announce}}};

TEST(AgedApproach, PositionsOfASyncBeforeAreCoveredWhereTheirAgeIsStated) {
    const std::uint64_t seed = printed_seed(20261204);
    const std::uint64_t count = count_from_environment(kUsualAges);
    std::uint64_t moved = 0;
    for (const auto& [name, aim] : kAims) {
        const ApproachTally tally = run_approaches(seed, count, Wrong::aged_and_said, aim);
        print(name, tally);
        EXPECT_EQ(tally.touched, 0U) << name;
        EXPECT_EQ(tally.left_limits, 0U) << name;
        EXPECT_EQ(tally.left_cap, 0U) << name;
        moved += tally.moved;
    }
    if (count >= kUsualAges) {
        EXPECT_GT(3 * moved, kAims.size() * count) << "too weak to tell anything";
    }
}

// Straight for the wall: what is wrong of the speed or the position is a way that no proof has.
TEST(AgedApproach, SomeTouchWhereTheAgeIsNotStated) {
    const std::uint64_t count = count_from_environment(kUsualAges);
    const ApproachTally tally =
        run_approaches(printed_seed(20261204), 3 * count, Wrong::aged, Aim::straight);
    print("straight", tally);
    if (count >= kUsualAges) {
        EXPECT_GT(tally.touched, 0U);
    }
}

}  // namespace
}  // namespace axg::test
