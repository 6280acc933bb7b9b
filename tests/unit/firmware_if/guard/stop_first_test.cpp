// SPDX-License-Identifier: Apache-2.0
// The stop leaves before everything else: when its frame reaches the wire nothing was written down,
// no line was set, and the latch was not touched. The latch of an armed guard is stored already, in
// memory that is made read-only here.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/live_world.hpp"

namespace axg {
namespace {

constexpr std::size_t kPageBytes = 4096;

/// A latch in a page of its own, clear; read-only on demand, so that a store ends the test.
class LatchPage {
  public:
    LatchPage()
        : page_(mmap(nullptr, kPageBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
                     0)) {
        set_latch(cell(), false);
    }
    ~LatchPage() { munmap(page_, kPageBytes); }
    LatchPage(const LatchPage&) = delete;
    LatchPage& operator=(const LatchPage&) = delete;

    LatchCell& cell() { return *static_cast<LatchCell*>(page_); }
    void set_writable(bool is_writable) {
        ASSERT_EQ(mprotect(page_, kPageBytes, is_writable ? PROT_READ | PROT_WRITE : PROT_READ), 0);
    }

  private:
    void* page_;
};

class Line final : public PulseLine {
  public:
    [[nodiscard]] bool set(bool is_high) noexcept override {
        level = is_high;
        ++sets;
        return true;
    }
    bool level = false;
    std::uint64_t sets = 0;
};

Machine machine_with_drives() {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    machine.can.quick_stop_ids = {0x303, 0x304};
    return machine;
}

class StopFirst : public testing::Test {
  protected:
    StopFirst() {
        world.options.line = &line;
        world.options.black_box = records.get();
        world.start();
        world.each_step = [this] {
            take_notes();
            phases = sent_records = 0;
        };
    }
    void take_notes() {
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            phases += note.kind == LiveNote::Kind::phase ? 1U : 0U;
        }
        BlackBoxEntry record;
        while (records->pop(record)) {
            sent_records += std::holds_alternative<SentFrame>(record.content) ? 1U : 0U;
        }
    }
    void arm() {
        world.run_periods(120);  // a session frame comes
        world.run_to_armed();
        world.run_periods(21);
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    }
    const Guard& guard() const { return world.guard->guard(); }
    /// What leaves the wire in the turn that stops, by id; the first stop is looked at.
    std::vector<std::uint32_t> stop_by(const std::function<void()>& breaks) {
        std::vector<std::uint32_t> ids;
        std::int64_t stop_us = 0;
        const std::uint64_t sets = line.sets;
        world.wire.on_send = [&, sets](const CanFrame& frame) {
            if (frame.id == world.machine.can.stop_id && stop_us == 0) {
                stop_us = world.wire.now_us;
                take_notes();
                EXPECT_EQ(phases, 0U) << "said before it was sent";
                EXPECT_EQ(sent_records, 0U);
                EXPECT_LE(line.sets - sets, 1U) << "that of a permit of this step at most";
                was_latched = is_latched(latch.cell());
                was_high = line.level;
            }
            if (stop_us == world.wire.now_us) {
                ids.push_back(frame.id);
            }
        };
        take_notes();
        phases = sent_records = 0;
        breaks();
        world.run_periods(6);
        world.wire.on_send = nullptr;
        EXPECT_EQ(guard().phase, GuardPhase::stopped);
        EXPECT_FALSE(line.level);
        return ids;
    }

    LatchPage latch;
    std::unique_ptr<BlackBoxQueue> records = std::make_unique<BlackBoxQueue>();
    Line line;
    test::LiveWorld world{machine_with_drives(), latch.cell()};
    std::uint64_t phases = 0, sent_records = 0;
    bool was_latched = false, was_high = false;
};

const std::vector<std::pair<const char*, void (*)(test::LiveWorld&)>> kStops{
    {"verdict",
     [](test::LiveWorld& world) {
         world.verdict = [](std::uint64_t) {
             return CycleResult{.is_stop = true, .reason = StopReason::predicted, .pair = 3};
         };
     }},
    {"silence", [](test::LiveWorld& world) { world.engine_runs = false; }},
    {"input", [](test::LiveWorld& world) { world.passes = [](const CanFrame&) { return false; }; }},
    {"interface", [](test::LiveWorld& world) { world.wire.inject(ReadStatus::down); }},
    {"gap",
     [](test::LiveWorld& world) {
         world.is_held = true;
         world.run_periods(10);
         world.is_held = false;
     }},
    {"suspended",
     [](test::LiveWorld& world) { world.guard->report(GuardFault::gap, world.wire.now_us); }},
    {"foreign stop",
     [](test::LiveWorld& world) {
         world.wire.arrive(encode_stop(world.machine.can, world.wire.now_us));
     }},
};

TEST_F(StopFirst, NothingGoesBeforeItAndTheLatchOfAnArmedGuardIsNotWritten) {
    for (const auto& [name, breaks] : kStops) {
        SCOPED_TRACE(name);
        arm();
        latch.set_writable(false);
        const auto ids = stop_by([&, &breaks = breaks] { breaks(world); });
        EXPECT_TRUE(is_latched(latch.cell()));
        latch.set_writable(true);
        ASSERT_GE(ids.size(), 5U);
        EXPECT_EQ(std::vector(ids.begin(), ids.begin() + 5),
                  (std::vector<std::uint32_t>{0x001, 0x303, 0x304, 0x103, 0x104}))
            << "the word stop right behind, without waiting for an echo";
        world.verdict = [](std::uint64_t) {
            return CycleResult{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        };
        world.engine_runs = true;
        world.passes = [](const CanFrame&) { return true; };
        set_latch(latch.cell(), false);
        world.start();
    }
}

TEST_F(StopFirst, AStopBeforeArmingIsSentFirstAndThenStored) {
    world.run_periods(150);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    (void)stop_by([&] { world.guard->report(GuardFault::refused, world.wire.now_us); });
    EXPECT_FALSE(was_latched) << "not before it is sent";
    EXPECT_TRUE(is_latched(latch.cell()));
}

TEST_F(StopFirst, TheLineFallsAfterTheFrames) {
    arm();
    while (!line.level) {
        world.run_periods(1);
    }
    (void)stop_by([&] { world.guard->report(GuardFault::engine, world.wire.now_us); });
    EXPECT_TRUE(was_high);
}

TEST_F(StopFirst, AGuardThatDiesArmedIsStoppedWhenItComesBack) {
    world.run_periods(150);
    EXPECT_FALSE(is_latched(latch.cell())) << "nobody has armed";
    std::size_t permits = 0;
    world.wire.on_send = [&](const CanFrame& frame) {
        permits += frame.id == world.machine.can.permit_id ? 1U : 0U;
        EXPECT_TRUE(frame.id != world.machine.can.permit_id || is_latched(latch.cell()))
            << "before the first permit";
    };
    world.guard->arm(world.wire.now_us);
    world.run_periods(20);
    EXPECT_GT(permits, 15U);
    world.start();  // the one before had no end
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::latched);
}

TEST_F(StopFirst, AnEndAsPlannedClearsTheLatchOfAnArmingAndOfNothingElse) {
    arm();
    world.guard->end();
    EXPECT_FALSE(is_latched(latch.cell()));
    world.start();
    EXPECT_NE(guard().phase, GuardPhase::stopped);
    arm();
    world.guard->report(GuardFault::refused, world.wire.now_us);
    world.guard->end();
    EXPECT_TRUE(is_latched(latch.cell())) << "a stop remains";
}

}  // namespace
}  // namespace axg
