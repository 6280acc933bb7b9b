// SPDX-License-Identifier: Apache-2.0
// The timed guard beside the same guard on a clock that ticks every microsecond, as a thread that
// sleeps would live: over frames that are lost, late and silent for a while, and an engine that
// takes more or less long, both send the same frames at the same instants.
// AXG_COUNT: runs; AXG_SEED: which.
#include "hil_replay/guard/timed_guard.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/timed_world.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kSamples = 160;

/// GuardNode with echoes at once, woken when a frame, a result or a timer is there.
class TickedGuard {
  public:
    TickedGuard(const LiveEngine& live, std::int64_t now_us)
        : live_(live),
          now_us_(now_us),
          guard_(live.machine, {.supposes_arming = true, .ignores_period = true}, wire_, queues_,
                 latch_, now_us) {
        tick();
    }

    std::int64_t response_us = 0;
    std::vector<CanFrame> sent;

    void arrive(const CanFrame& frame) {
        run_before(frame.time_us);
        EXPECT_TRUE(wire_.arrive({.frame = frame}));
        now_us_ = frame.time_us;
        wake();
    }
    void run_before(std::int64_t until_us) {
        for (; now_us_ < until_us; ++now_us_) {
            tick();
        }
    }

  private:
    void tick() {
        const bool has_result = has_result_ && result_.done_us <= now_us_;
        if (has_result || now_us_ >= guard_.next_due_us()) {
            wake();
        }
    }
    /// Until nothing is left to do at this instant.
    void wake() {
        for (bool again = true; again;) {
            if (has_result_ && result_.done_us <= now_us_) {
                has_result_ = false;
                EXPECT_TRUE(queues_.results.push(result_));
            }
            guard_.turn(now_us_);
            if (guard_.guard().phase == GuardPhase::ready) {
                guard_.arm(now_us_);
            }
            again = serve();
            again = again || (has_result_ && result_.done_us <= now_us_);
        }
    }
    /// True: there is something to turn for.
    bool serve() {
        LiveNote note;
        while (queues_.notes.pop(note)) {
        }
        bool has_more = false;
        CanFrame frame;
        while (wire_.take(frame)) {
            frame.time_us = now_us_;
            sent.push_back(frame);
            has_more = wire_.arrive({.frame = frame, .is_own = true}) || has_more;
        }
        if (!has_result_) {
            run_queries(live_, queues_, [&](LiveResult made) {
                made.done_us = now_us_;
                if (made.kind == LiveQuery::Kind::self_test) {
                    EXPECT_TRUE(queues_.results.push(made));
                    has_more = true;
                    return;
                }
                made.done_us += response_us;
                result_ = made;
                has_result_ = true;
            });
        }
        return has_more;
    }

    LiveEngine live_;
    std::int64_t now_us_;
    HostWire wire_;
    LiveQueues queues_;
    LatchCell latch_{kLatchClear, ~kLatchClear};
    GuardNode guard_;
    bool has_result_ = false;
    LiveResult result_{};
};

/// A board whose frames are lost and late, and that is silent for a while now and then.
std::vector<CanFrame> disturbed_frames(test::TimedWorld& world, test::Dice& dice) {
    std::vector<CanFrame> frames;
    std::int64_t last_us = 0;
    const double lost = dice.chance(0.5) ? 0 : dice.in(0, 0.01);
    const std::uint64_t silent_from = static_cast<std::uint64_t>(dice.in(40, 2 * kSamples));
    const std::uint64_t silent = static_cast<std::uint64_t>(dice.in(0, 8));
    for (std::uint64_t k = 0; k < kSamples; ++k) {
        const std::int64_t late_us =
            dice.chance(0.2) ? static_cast<std::int64_t>(dice.in(0, 300)) : 0;
        for (CanFrame frame : world.next_sample()) {
            frame.time_us = last_us = std::max(last_us, frame.time_us + late_us);
            const bool is_silent = k >= silent_from && k < silent_from + silent;
            if (!is_silent && !dice.chance(lost)) {
                frames.push_back(frame);
            }
        }
    }
    return frames;
}

void expect_equal(const std::vector<CanFrame>& timed, const std::vector<CanFrame>& ticked) {
    const std::size_t count = std::min(timed.size(), ticked.size());
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(timed[i].time_us, ticked[i].time_us) << "frame " << i;
        ASSERT_EQ(timed[i].id, ticked[i].id) << "frame " << i;
        ASSERT_EQ(timed[i].data, ticked[i].data) << "frame " << i;
    }
    EXPECT_EQ(timed.size(), ticked.size());
}

TEST(TimedGuardProperty, SendsWhatAGuardNodeSendsWhenItSendsIt) {
    const std::uint64_t seed = test::printed_seed(20261123);
    const std::uint64_t runs = test::count_from_environment(60);
    std::uint64_t stopped = 0, permits = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        test::Dice dice(seed + run);
        test::TimedWorld world(dice.chance(0.5) ? CanFormat::classical : CanFormat::fd);
        // In time, late, and later than the next snapshot.
        const double response_max = dice.chance(0.8) ? 1.1 * world.machine.deadline_us : 2500;
        world.response_us = static_cast<std::int64_t>(dice.in(0, response_max));
        const std::int64_t start_us =
            test::TimedWorld::kBeginUs - static_cast<std::int64_t>(dice.in(0, 5000));
        world.start(start_us);
        test::KnownAnswerEngine answers;
        GuardChain chain(world.machine, answers.engine(), answers.containment_test(), {});
        TickedGuard ticked({.machine = world.machine, .chain = chain}, start_us);
        ticked.response_us = world.response_us;
        std::int64_t now_us = world.guard->now_us();
        for (const CanFrame& frame : disturbed_frames(world, dice)) {
            world.guard->arrive({.frame = frame});
            ticked.arrive(frame);
            ASSERT_EQ(world.guard->now_us(), frame.time_us) << "run " << run;
            ASSERT_GE(world.guard->next_due_us(), world.guard->now_us()) << "run " << run;
            ASSERT_GE(world.guard->now_us(), now_us);
            now_us = world.guard->now_us();
        }
        stopped += world.guard->is_stopped() ? 1U : 0U;
        world.guard->run_before(now_us + 20'000);
        ticked.run_before(now_us + 20'000);
        EXPECT_GE(world.guard->next_due_us(), now_us + 20'000);
        expect_equal(world.sent, ticked.sent);
        if (testing::Test::HasFailure()) {
            FAIL() << "run " << run;
        }
        permits += world.guard->guard().counters().permits;
    }
    std::printf("%llu runs, %llu stopped before the end, %llu permits\n",
                static_cast<unsigned long long>(runs), static_cast<unsigned long long>(stopped),
                static_cast<unsigned long long>(permits));
    EXPECT_GT(permits, 20 * runs);
    EXPECT_GT(stopped, runs / 20);
    EXPECT_LT(stopped, runs - runs / 20);
}

}  // namespace
}  // namespace axg
