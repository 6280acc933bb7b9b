// SPDX-License-Identifier: Apache-2.0
// Random approaches in which the count of one axis freezes above its blind speed, while the axis
// goes on: tool and plate never touch. They do where the guard believes such a count. AXG_COUNT:
// approaches; AXG_SEED: the first; each has a seed of its own.
#include <gtest/gtest.h>

#include "tests/support/approach_tally.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualFreezes = 1200;

TEST(FrozenAxis, StopsTheBoardBeforeItTouches) {
    const std::uint64_t seed = printed_seed(20261130);
    const std::uint64_t count = count_from_environment(kUsualFreezes);
    const ApproachTally whole = run_approaches(seed, count, Wrong::frozen, Aim::any);
    print("frozen", whole);
    std::printf("  %llu frozen, %llu touch\n", static_cast<unsigned long long>(whole.frozen),
                static_cast<unsigned long long>(whole.frozen_touched));
    EXPECT_EQ(whole.touched, 0U);
    const ApproachTally trusted = run_approaches(seed, count, Wrong::frozen_trusted, Aim::any);
    print("frozen, and believed", trusted);
    if (count >= kUsualFreezes) {
        EXPECT_GT(3 * whole.frozen, count) << "too weak to tell anything";
        EXPECT_GT(trusted.frozen_touched, 0U) << "too weak to tell anything";
    }
}

}  // namespace
}  // namespace axg::test
