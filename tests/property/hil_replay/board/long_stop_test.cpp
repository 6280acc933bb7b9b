// SPDX-License-Identifier: Apache-2.0
// Approaches in closed loop of boards that brake as they promise, more softly, or later: the guard
// names those stops that lead farther than their permit was proven for, and no other. AXG_COUNT:
// approaches of each kind; AXG_SEED: the first.
#include <gtest/gtest.h>

#include "tests/support/approach_tally.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualStops = 300;

TEST(LongStop, NoStopThatKeepsItsPromiseLeavesItsReach) {
    const std::uint64_t seed = printed_seed(20261201);
    const std::uint64_t count = count_from_environment(kUsualStops);
    std::uint64_t stopped = 0;
    for (const Aim aim :
         {Aim::straight, Aim::crawl, Aim::turn, Aim::tool, Aim::let_go, Aim::announce}) {
        const ApproachTally tally = run_approaches(seed, count, Wrong::nothing, aim);
        EXPECT_EQ(tally.left_reach, 0U) << static_cast<int>(aim);
        stopped += tally.stopped;
    }
    if (count >= kUsualStops) {
        EXPECT_GT(stopped, count) << "too weak to tell anything";
    }
}

TEST(LongStop, OnesThatAreSofterOrLaterAreNamed) {
    const std::uint64_t seed = printed_seed(20261202);
    const std::uint64_t count = count_from_environment(kUsualStops);
    for (const Wrong wrong : {Wrong::soft_stop, Wrong::late_stop}) {
        const ApproachTally tally = run_approaches(seed, count, wrong, Aim::straight);
        std::printf("%s: %llu stopped, %llu touch, %llu named\n",
                    wrong == Wrong::soft_stop ? "softer" : "later",
                    static_cast<unsigned long long>(tally.stopped),
                    static_cast<unsigned long long>(tally.touched),
                    static_cast<unsigned long long>(tally.left_reach));
        if (count >= kUsualStops) {
            EXPECT_GT(4 * tally.left_reach, tally.stopped + tally.touched);
        }
    }
}

}  // namespace
}  // namespace axg::test
