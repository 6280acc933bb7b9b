// SPDX-License-Identifier: Apache-2.0
// The C interface allocates nothing between start and destroy: in health, at a stop, at a reset,
// through faults.
#include "tests/support/c_host.hpp"
#include "tests/support/malloc_count.hpp"
#include "tests/support/simulated_frames.hpp"

namespace axg {
namespace {

using test::allocations;
using test::NoAllocation;

void expect_none(const axg_options& options, const std::vector<CanFrame>& frames) {
    test::CHost host(options);
    ASSERT_NE(host.guard, nullptr);
    const std::uint64_t before = allocations;
    const std::size_t played = host.play(frames);
    const std::uint64_t permits = host.state.permits;
    const bool was_stopped = host.state.phase == AXG_PHASE_STOPPED;
    for (int i = 0; i < 3000; ++i) {  // silence: it goes on by its clock
        host.cycle(host.now + 1000);
    }
    (void)axg_guard_notify(host.guard, AXG_EVENT_RESET, host.now);
    (void)axg_guard_notify(host.guard, AXG_EVENT_FRAMES_LOST, host.now);
    (void)axg_guard_notify(host.guard, AXG_EVENT_BUS_DOWN, host.now);
    host.echoes = false;
    for (int i = 0; i < 100; ++i) {
        host.cycle(host.now + 1000);
    }
    const std::uint64_t spent = allocations - before;
    EXPECT_EQ(spent, 0U);
    EXPECT_TRUE(host.ok);
    EXPECT_TRUE(was_stopped);
    EXPECT_GT(played, 20'000U);
    EXPECT_GT(permits, 5'000U);
}

TEST_F(NoAllocation, BetweenStartAndDestroyOfTheCInterface) {
    const test::Workshop shop;
    const std::vector<CanFrame> frames = test::simulated_frames(
        test::load_paper_machine().machine, test::after_rest(shop, test::kDemoProgram));
    expect_none(test::c_options(AXG_MODE_CONTACT), frames);
    expect_none(test::c_options(AXG_MODE_STOPPABLE), frames);
    const std::string capped = test::capped_machine(shop);
    axg_options options = test::c_options(AXG_MODE_STOPPABLE);
    options.machine_file = capped.c_str();
    options.mesh_root = test::kPaperMeshes.c_str();
    expect_none(options, frames);
}

TEST_F(NoAllocation, ForSamplesInPlaceOfFrames) {
    test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
    ASSERT_NE(host.guard, nullptr);
    axg_terms terms{};
    const std::uint64_t before = allocations;
    ASSERT_EQ(axg_guard_start(host.guard, 0), AXG_STATUS_OK);
    axg_sample sample{};
    sample.axis_count = 5;
    for (sample.number = 1; sample.number <= 600; ++sample.number) {
        sample.latched_us = static_cast<std::int64_t>(sample.number) * 1000;
        EXPECT_EQ(axg_guard_put_sample(host.guard, &sample, sample.latched_us), AXG_STATUS_OK);
        host.cycle(sample.latched_us);
    }
    (void)axg_guard_terms(host.guard, &terms);
    const std::uint64_t spent = allocations - before;
    EXPECT_EQ(spent, 0U);
    EXPECT_TRUE(host.ok);
    EXPECT_GT(host.state.proof.samples_evaluated, 500U);
}

TEST_F(NoAllocation, IsCounted) {
    const std::uint64_t before = allocations;
    int* volatile number = new int(1);  // volatile: the compiler may otherwise leave both out
    delete number;
    EXPECT_GT(allocations, before);
}

}  // namespace
}  // namespace axg
