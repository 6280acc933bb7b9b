// SPDX-License-Identifier: Apache-2.0
// The guard on a clock that is passed in never touches the heap after construction: healthy, with
// results that come later, stopped, and without echoes. A restart allocates nothing either.
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/malloc_count.hpp"
#include "tests/support/timed_world.hpp"

namespace axg {
namespace {

using test::allocations;
using test::NoAllocation;

TEST_F(NoAllocation, InATimedGuardFromStartToStopAndAgain) {
    for (const bool echoes : {true, false}) {
        test::TimedWorld world;
        std::uint64_t sent = 0;
        world.options.echoes = echoes;
        world.options.sent = [&sent](const CanFrame&) { ++sent; };
        world.response_us = 200;
        world.start();
        std::vector<CanFrame> frames;
        for (int k = 0; k < 400; ++k) {
            const std::vector<CanFrame> sample = world.next_sample();
            frames.insert(frames.end(), sample.begin(), sample.end());
        }
        const std::uint64_t before = allocations;
        for (std::size_t i = 0; i < frames.size() / 2; ++i) {
            world.guard->arrive({.frame = frames[i]});
        }
        const bool was_armed = world.guard->was_armed();
        const std::uint64_t sent_healthy = sent;
        world.answers.is_well = false;
        for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
            world.guard->arrive({.frame = frames[i]});
        }
        const bool is_stopped = world.guard->is_stopped();
        world.guard->restart(world.guard->now_us());
        world.guard->run_before(world.guard->now_us() + 50'000);
        EXPECT_EQ(allocations - before, 0U) << echoes;
        EXPECT_EQ(was_armed, echoes) << "without an echo it is never ready";
        EXPECT_TRUE(is_stopped);
        EXPECT_GT(sent_healthy, echoes ? 300U : 10U);
    }
}

}  // namespace
}  // namespace axg
