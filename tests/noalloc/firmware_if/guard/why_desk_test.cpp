// SPDX-License-Identifier: Apache-2.0
// What the engine thread leaves for the status line, and what the status thread makes of it: no
// allocation on either side.
#include "firmware_if/guard/why_desk.hpp"

#include <gtest/gtest.h>

#include <array>

#include "firmware_if/live/status_line.hpp"
#include "tests/support/descending_chain.hpp"
#include "tests/support/malloc_count.hpp"

namespace axg {
namespace {

using test::allocations;

class WhyDeskMemory : public test::NoAllocation {};

TEST_F(WhyDeskMemory, NeitherThreadAllocates) {
    for (const bool is_stoppable : {true, false}) {
        test::DescendingChain chain(is_stoppable);
        chain.descend();
        const StatusLine line(chain.machine(), "m.yaml", "can0", "stoppable", "0");
        std::array<char, kStatusLineBytesMax> text{};
        LiveView view;
        view.phase = GuardPhase::stopped;
        view.cause = GuardFault::verdict;
        view.pair = chain.result.result.pair;
        view.stop_query = chain.result.number;
        view.withheld = chain.withheld();
        StatusWhy more;
        const std::uint64_t before = allocations;
        chain.step(true);  // engine, result and copy
        const GuardWhy why = chain.desk.why(view.stop_query, view.withheld);
        more.stop.why = why.stop;
        more.withheld = why.withheld;
        const std::size_t size = line.write(&view, more, 0, text);
        EXPECT_EQ(allocations - before, 0U);
        EXPECT_TRUE(why.stop && why.withheld);
        EXPECT_GT(size, 0U);
    }
}

}  // namespace
}  // namespace axg
