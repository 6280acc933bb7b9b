// SPDX-License-Identifier: Apache-2.0
// A trace through the whole chain: it stops at the first contact and not before, judges lost and
// damaged frames as the bus rules say, and counts late cycles exactly. The clock is scripted.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::int64_t kDeadlineUs = 500;

class Replay : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        paper = std::make_unique<test::PaperMachine>();
        shop = std::make_unique<test::Workshop>();
        demo = simulated(test::content_of(test::kDemoProgram));
        brief = simulated("T1 M6\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nG0 X-20\nM2\n");
    }
    static void TearDownTestSuite() {
        paper.reset();
        shop.reset();
    }
    void SetUp() override {
        ASSERT_TRUE(paper->engine.has_value());
        ASSERT_GT(demo.size(), 100'000U);
        ASSERT_GT(brief.size(), 4'000U);
    }

    static std::vector<CanFrame> simulated(const std::string& text) {
        const Machine& machine = paper->loaded.machine;
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(text, machine, options);
        EXPECT_TRUE(reading.faults.empty());
        const std::string path = shop->file("trace.log");
        EXPECT_EQ(simulate_trace(machine, reading.program, {}, path).error, "");
        return test::read_trace(path);
    }

    struct Seen {
        AxisSnapshot snapshot;
        CycleResult result;
        SnapshotStatus status;
        std::uint8_t sync_counter;
        ReceiverState state;
        bool sent_permit;
    };
    struct Outcome {
        std::unique_ptr<ReplayRun> run;
        std::vector<Seen> cycles;
        std::size_t frames = 0;  // taken before it said stop

        [[nodiscard]] std::uint64_t faults(ReceiverFault fault) const {
            return run->input().of(fault);
        }
    };

    static std::unique_ptr<Outcome> replay(const std::vector<CanFrame>& frames,
                                           bool keep_going = false) {
        auto out = std::make_unique<Outcome>();
        Outcome* const seen = out.get();
        ReplayOptions options;
        options.deadline_us = kDeadlineUs;
        options.keep_going = keep_going;
        options.clock.now_ns = [](void*) { return std::int64_t{0}; };  // nothing ever takes time
        out->run = std::make_unique<ReplayRun>(
            paper->loaded.machine, paper->engine->engine(), *paper->containment_test, options,
            [seen](const ReplayCycle& c) {
                seen->cycles.push_back({c.snapshot, c.result, c.pair_queries.status, c.sync_counter,
                                        seen->run->receiver_state(), c.sent_permit});
            });
        for (const CanFrame& frame : frames) {
            ++out->frames;
            if (!out->run->on_frame(frame)) {
                break;
            }
        }
        out->run->finish();
        for (const Seen& cycle : out->cycles) {  // of every replay in this file
            EXPECT_TRUE(!cycle.sent_permit || cycle.state == ReceiverState::valid);
            EXPECT_TRUE(!cycle.sent_permit || cycle.result.has_permit);
        }
        return out;
    }

    /// Every snapshot is one that the undamaged trace has at that sample: nothing torn, nothing
    /// mixed.
    static void expect_snapshots_of(const Outcome& whole, const Outcome& damaged) {
        std::map<std::uint64_t, const AxisSnapshot*> known;
        for (const Seen& cycle : whole.cycles) {
            known[cycle.snapshot.sample] = &cycle.snapshot;
        }
        for (const Seen& cycle : damaged.cycles) {
            const auto found = known.find(cycle.snapshot.sample);
            ASSERT_NE(found, known.end()) << cycle.snapshot.sample;
            ASSERT_EQ(cycle.snapshot.position, found->second->position);
        }
    }

    /// Frames of sample k, SYNC first.
    static std::size_t first_of(const std::vector<CanFrame>& frames, std::size_t sample) {
        std::size_t seen = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            seen += frames[i].id == paper->loaded.machine.can.sync_id ? 1 : 0;
            if (seen == sample + 1) {
                return i;
            }
        }
        ADD_FAILURE() << "no sample " << sample;
        return 0;
    }

    static std::unique_ptr<test::PaperMachine> paper;
    static std::unique_ptr<test::Workshop> shop;
    static std::vector<CanFrame> demo, brief;
};

std::unique_ptr<test::PaperMachine> Replay::paper;
std::unique_ptr<test::Workshop> Replay::shop;
std::vector<CanFrame> Replay::demo, Replay::brief;

/// Whether any pair of this snapshot is not proven farther apart than its margin.
bool touches(test::PaperMachine& paper, const AxisSnapshot& snapshot) {
    const auto pair_queries = std::make_unique<PairQueries>();
    make_contact_queries(paper.loaded.machine, snapshot, *pair_queries);
    std::vector<QueryResult> results(pair_queries->count);
    paper.engine->run(std::span(pair_queries->queries).first(pair_queries->count), results);
    return std::any_of(results.begin(), results.end(),
                       [](const QueryResult& a) { return a.proof != Proof::far; });
}

TEST_F(Replay, StopsAtTheFirstSampleInContactAndNotBefore) {
    const auto out = replay(demo);
    ASSERT_EQ(out->run->stops().size(), 1U);
    const StopEvent& stop = out->run->stops()[0];
    EXPECT_EQ(stop.reason, StopReason::contact);
    EXPECT_EQ(pair_name(paper->loaded.machine, stop.pair), "cutter-c");
    EXPECT_LT(out->frames, demo.size()) << "the rest of the trace was not read";
    AxisReceiver receiver(paper->loaded.machine);  // the same, queried beside the run
    std::uint64_t sample = 0, cycles = 0;
    for (const CanFrame& frame : demo) {
        const ReceiverEvent event = receiver.on_frame(frame);
        if (event.kind != ReceiverEvent::Kind::snapshot) {
            continue;
        }
        ++cycles;
        if (touches(*paper, event.snapshot)) {
            sample = event.snapshot.sample;
            EXPECT_EQ(stop.time_us, event.snapshot.arrived_us);
            EXPECT_EQ(stop.snapshot.position, event.snapshot.position);
            break;
        }
    }
    EXPECT_EQ(stop.snapshot.sample, sample);
    EXPECT_EQ(out->cycles.size(), cycles);
    EXPECT_TRUE(out->cycles.back().result.is_stop);
}

TEST_F(Replay, PermitsEverySampleFromArmingToTheStop) {
    const auto out = replay(demo);
    std::uint64_t permits = 0, before = 0;
    for (const Seen& cycle : out->cycles) {
        const bool is_proven =
            cycle.state == ReceiverState::valid && cycle.result.reason == StopReason::none;
        ASSERT_EQ(cycle.result.has_permit, is_proven) << cycle.snapshot.sample;
        const bool is_armed = cycle.snapshot.arrived_us > out->run->armed_us();
        ASSERT_EQ(cycle.sent_permit, is_proven && is_armed) << cycle.snapshot.sample;
        permits += cycle.sent_permit ? 1 : 0;
        before += is_armed ? 0 : 1;
    }
    EXPECT_GE(before, GuardLimits{}.snapshots_min);
    // The four hashes take three repetitions; a sample a millisecond.
    const auto hashes_us = static_cast<std::uint64_t>((kHashParts - 1) * Handshake::kRepeatUs);
    EXPECT_LE(before, 2 * GuardLimits{}.snapshots_min + hashes_us / 1000);
    EXPECT_GT(permits, 10'000U);
    EXPECT_EQ(out->run->permits(), permits);
}

TEST_F(Replay, ThePermitEchoesTheSyncCounterOfItsSample) {
    const auto out = replay(brief);
    std::map<std::int64_t, std::uint8_t> sync;
    for (const CanFrame& frame : brief) {
        if (frame.id == paper->loaded.machine.can.sync_id) {
            sync[frame.time_us] = frame.data[0];
        }
    }
    ASSERT_GT(out->cycles.size(), 1000U);
    for (const Seen& cycle : out->cycles) {
        ASSERT_EQ(cycle.sync_counter, sync.at(cycle.snapshot.latched_us));
    }
}

TEST_F(Replay, KeepGoingCountsEverySampleInContactAndNamesTheEpisodes) {
    // Down into the plate twice: two episodes with clear air between them.
    const std::vector<CanFrame> twice =
        simulated("T1 M6\nG0 Y107.2 A-19.3 C95\nZ-200\nG1 Z-224 F3000\nZ-200\nZ-225\nZ-200\nM2\n");
    const auto out = replay(twice, true);
    EXPECT_EQ(out->frames, twice.size());
    std::uint64_t in_contact = 0, episodes = 0, listed = 0;
    bool before = false, stopped = false;
    std::vector<std::uint64_t> first_samples;
    for (const Seen& cycle : out->cycles) {
        const bool now = cycle.result.reason != StopReason::none;
        stopped = stopped || now;
        EXPECT_FALSE(stopped && cycle.sent_permit) << "a stop stays";
        in_contact += now ? 1 : 0;
        if (now && !before) {
            ++episodes;
            first_samples.push_back(cycle.snapshot.sample);
        }
        before = now;
    }
    EXPECT_GT(in_contact, 10U);
    EXPECT_EQ(episodes, 2U);
    EXPECT_EQ(out->run->stop_count(), episodes);
    ASSERT_EQ(out->run->stops().size(), episodes);
    for (std::size_t i = 0; i < out->run->stops().size(); ++i) {
        EXPECT_EQ(out->run->stops()[i].snapshot.sample, first_samples[i]);
        listed += out->run->stops()[i].samples;
    }
    EXPECT_EQ(listed, in_contact);
    EXPECT_EQ(out->run->pairs()[3].not_proven, in_contact) << "cutter-c alone";
    const auto until_stop = replay(twice);
    EXPECT_EQ(until_stop->run->stops()[0].time_us, out->run->stops()[0].time_us);
}

TEST_F(Replay, ALostFrameIsALostSampleAndNoStop) {
    const auto whole = replay(brief);
    for (const std::size_t which : {1U, 2U, 3U}) {
        auto frames = brief;
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(first_of(brief, 200) + which));
        const auto out = replay(frames);
        EXPECT_EQ(out->run->stop_count(), 0U);
        EXPECT_EQ(out->run->input().samples_lost, 1U);
        EXPECT_EQ(out->cycles.size() + 1, whole->cycles.size());
        expect_snapshots_of(*whole, *out);
    }
}

TEST_F(Replay, ACorruptedFrameIsCountedAndNeverUsed) {
    const auto whole = replay(brief);
    for (const std::size_t which : {1U, 2U, 3U}) {
        for (const std::size_t byte : {0U, 2U, 7U}) {
            auto frames = brief;
            frames[first_of(brief, 300) + which].data[byte] ^= 0x10;
            const auto out = replay(frames);
            EXPECT_EQ(out->run->stop_count(), 0U);
            EXPECT_EQ(out->faults(ReceiverFault::bad_crc), 1U);
            EXPECT_EQ(out->cycles.size() + 1, whole->cycles.size());
            expect_snapshots_of(*whole, *out);
        }
    }
}

TEST_F(Replay, FramesOfTwoSamplesNeverBecomeOneSnapshot) {
    const auto whole = replay(brief);
    for (const std::size_t which : {1U, 2U, 3U}) {
        auto frames = brief;
        const std::size_t one = first_of(brief, 400) + which, two = first_of(brief, 401) + which;
        std::swap(frames[one].data, frames[two].data);
        const auto out = replay(frames);
        EXPECT_EQ(out->run->stop_count(), 0U);
        EXPECT_LT(out->cycles.size(), whole->cycles.size());
        expect_snapshots_of(*whole, *out);
    }
}

// In contact mode every permit has the least n, and its end comes before the age limit.
TEST_F(Replay, SilenceStopsWhenTheLastPermitEndsAndNotAtTheNextFrame) {
    const CanLayout& can = paper->loaded.machine.can;
    const std::int64_t permit_us = can.permit_samples.least * can.sample_us;
    ASSERT_LT(permit_us + 2 * can.sample_us, can.stale_after_us);
    auto frames = brief;  // position frames stop at sample 500; SYNC goes on
    const std::size_t from = first_of(brief, 500);
    frames.erase(std::remove_if(frames.begin() + static_cast<std::ptrdiff_t>(from), frames.end(),
                                [&can](const CanFrame& f) { return f.id != can.sync_id; }),
                 frames.end());
    const auto out = replay(frames);
    ASSERT_EQ(out->run->stops().size(), 1U);
    const StopEvent& stop = out->run->stops()[0];
    EXPECT_EQ(stop.cause, GuardFault::silence);
    EXPECT_EQ(stop.reason, StopReason::none);
    EXPECT_EQ(stop.snapshot.latched_us, out->cycles.back().snapshot.latched_us);
    const std::int64_t age_us = stop.time_us - stop.snapshot.latched_us;
    EXPECT_GT(age_us, permit_us);
    EXPECT_LE(age_us, permit_us + 2 * can.sample_us);
    // Without any frame at all, too.
    frames = brief;
    frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(from),
                 frames.begin() + static_cast<std::ptrdiff_t>(first_of(brief, 520)));
    const auto gap = replay(frames, true);
    ASSERT_FALSE(gap->run->stops().empty());
    EXPECT_EQ(gap->run->stops()[0].time_us, stop.time_us);
    EXPECT_LT(gap->run->stops()[0].time_us, frames[from].time_us);
    EXPECT_GT(gap->cycles.size(), 1000U) << "judged on, as asked";
}

// A log does not say which frames were the guard's own: a stop is, where a guard is heard and the
// log states no other direction.
TEST_F(Replay, AStopOfAnotherSenderStopsAndThatOfTheGuardInTheTraceDoesNot) {
    const CanLayout& can = paper->loaded.machine.can;
    const auto with = [&](const std::vector<CanFrame>& more) {
        auto frames = brief;
        const auto at = static_cast<std::ptrdiff_t>(first_of(brief, 500));
        const std::int64_t time_us = frames[static_cast<std::size_t>(at)].time_us;
        frames.insert(frames.begin() + at, more.begin(), more.end());
        for (std::size_t i = 0; i < more.size(); ++i) {
            frames[static_cast<std::size_t>(at) + i].time_us = time_us;
        }
        return frames;
    };
    const auto expect_stop = [&](const std::vector<CanFrame>& frames) {
        const auto out = replay(frames);
        ASSERT_EQ(out->run->stops().size(), 1U);
        EXPECT_EQ(out->run->stops()[0].cause, GuardFault::foreign_stop);
        EXPECT_STREQ(reason_text(out->run->stops()[0]), "foreign_stop");
    };
    const CanFrame stop = encode_stop(can, 0);
    CanFrame stop_sent = stop, beat = encode_guard_heartbeat(can, GuardHeartbeat::tripped, 0);
    stop_sent.sent_by_host = true;
    expect_stop(with({stop}));
    EXPECT_EQ(replay(with({beat, stop}))->run->stop_count(), 0U);
    EXPECT_EQ(replay(with({stop_sent}))->run->stop_count(), 0U);
    beat.sent_by_host = true;
    EXPECT_EQ(replay(with({beat, stop_sent}))->run->stop_count(), 0U);
    expect_stop(with({beat, stop}));
    auto early = brief;
    early.insert(early.begin(), stop);
    early.front().time_us = brief.front().time_us;
    EXPECT_EQ(replay(early)->run->stop_count(), 0U) << "nothing is permitted yet";
}

TEST_F(Replay, LostInputDuringContactIsAStopOfItsOwn) {
    const auto contact = replay(demo);
    auto frames = demo;  // silence in the third sample of the contact
    const std::size_t at = first_of(demo, contact->cycles.size() + 2);
    frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(at),
                 frames.begin() + static_cast<std::ptrdiff_t>(at + 100));
    const auto out = replay(frames, true);
    ASSERT_GE(out->run->stops().size(), 2U);
    const StopEvent &first = out->run->stops()[0], &second = out->run->stops()[1];
    EXPECT_EQ(first.reason, StopReason::contact);
    EXPECT_EQ(first.samples, 3U) << "the fault is no sample";
    EXPECT_EQ(second.reason, StopReason::input);
    EXPECT_NE(second.fault, ReceiverFault::none);
    EXPECT_EQ(second.samples, 1U);
}

TEST_F(Replay, AToolWithoutASlotStops) {
    const Machine& machine = paper->loaded.machine;
    AxisEncoder encoder(machine);
    std::vector<CanFrame> frames;
    for (std::int64_t k = 0; k < 40; ++k) {
        AxisSnapshot snapshot;
        snapshot.latched_us = 1'000'000 + k * machine.can.sample_us;
        snapshot.axis_count = 5;
        snapshot.mode = k == 20 ? kModeToolChange : kModeStandstill;
        snapshot.tool = k < 20 ? 1 : 9;
        std::array<CanFrame, kFramesPerSnapshotMax> set;
        const EncodeResult result = encoder.encode(snapshot, set);
        ASSERT_EQ(result.status, EncodeStatus::ok);
        frames.insert(frames.end(), set.begin(), set.begin() + result.frame_count);
    }
    const auto out = replay(frames);
    ASSERT_EQ(out->run->stops().size(), 1U);
    EXPECT_EQ(out->run->stops()[0].reason, StopReason::tool);
    // Without a heartbeat a sample is evaluated only when the one before is too old.
    const std::uint64_t stopped_at = out->run->stops()[0].snapshot.sample;
    ASSERT_GE(out->cycles.size(), 2U);
    EXPECT_GE(stopped_at, 20U);
    EXPECT_LT(out->cycles[out->cycles.size() - 2].snapshot.sample, 20U) << "the first such";
    EXPECT_EQ(out->cycles.back().snapshot.sample, stopped_at);
    EXPECT_EQ(out->cycles.back().status, SnapshotStatus::unknown_tool);
    EXPECT_EQ(out->cycles.back().result.known_answer_signature, 0);
}

// ---- Deadline: a clock that runs only where the test lets it.

class ReplayClock : public Replay {
  protected:
    /// One evaluation of all pairs reads the clock at its start, before the first pair, after each,
    /// and at its end.
    static constexpr std::int64_t kSteps = 8 + 2;

    template <class SetUp>  // (clock, cycles before) before each frame
    static std::unique_ptr<ReplayRun> run(SetUp set_up, std::size_t frame_count = 2000) {
        struct Clock {
            std::int64_t ns = 0, step_ns = 0, steps_left = 0;
            static std::int64_t now(void* self) {
                auto& c = *static_cast<Clock*>(self);
                c.ns += c.steps_left > 0 ? c.step_ns : 0;
                c.steps_left -= c.steps_left > 0 ? 1 : 0;
                return c.ns;
            }
        } clock;
        ReplayOptions options;
        options.deadline_us = kDeadlineUs;
        options.clock.now_ns = &Clock::now;
        options.clock.clock = &clock;
        auto run = std::make_unique<ReplayRun>(paper->loaded.machine, paper->engine->engine(),
                                               *paper->containment_test, options, nullptr);
        for (std::size_t i = 0; i < frame_count; ++i) {
            set_up(clock, run->cycles().count());
            EXPECT_TRUE(run->on_frame(brief[i]));
        }
        return run;
    }
    static constexpr std::int64_t kForEver = 1'000'000;
};

// In real time a result is heard when the engine is done, that of the last sample after the trace.
TEST_F(ReplayClock, RealTimeObservesAsManyCyclesAsSamples) {
    std::size_t counts[2] = {0, 0};
    for (const bool is_realtime : {false, true}) {
        ReplayOptions options;
        options.deadline_us = kDeadlineUs;
        options.is_realtime = is_realtime;
        std::int64_t now_ns = 0;
        options.clock.clock = &now_ns;
        options.clock.now_ns = [](void* now) { return *static_cast<std::int64_t*>(now) += 3'000; };
        std::size_t& count = counts[is_realtime ? 1 : 0];
        ReplayRun run(paper->loaded.machine, paper->engine->engine(), *paper->containment_test,
                      options, [&count](const ReplayCycle&) { ++count; });
        for (const CanFrame& frame : brief) {
            EXPECT_TRUE(run.on_frame(frame));
        }
        run.finish();
        EXPECT_EQ(run.stop_count(), 0U);
        EXPECT_EQ(count, run.cycles().count()) << is_realtime;
    }
    EXPECT_EQ(counts[0], counts[1]);
}

TEST_F(ReplayClock, EveryThirdCycleTooLongIsCountedExactlyAndListedWithItsInput) {
    const auto out = run([](auto& clock, std::uint64_t cycle) {
        clock.steps_left = kForEver;
        clock.step_ns = cycle % 3 == 2 ? 60'000 + static_cast<std::int64_t>(cycle) : 1'000;
    });
    const std::uint64_t cycles = out->cycles().count();
    ASSERT_GT(cycles, 400U);
    EXPECT_EQ(out->overruns(), cycles / 3);
    ASSERT_EQ(out->slowest().size(), kSlowCyclesKept);
    const auto whole = replay(brief);
    std::uint64_t late = cycles / 3 * 3 - 1;  // the last with remainder 2: each is a little slower
    for (const SlowCycle& slow : out->slowest()) {
        EXPECT_EQ(slow.spent_ns, kSteps * (60'000 + static_cast<std::int64_t>(late)));
        EXPECT_EQ(slow.snapshot.position, whole->cycles[late].snapshot.position);
        EXPECT_EQ(slow.snapshot.sample, whole->cycles[late].snapshot.sample);
        late -= 3;
    }
    EXPECT_EQ(out->cycles().least_ns(), kSteps * 1'000);
}

TEST_F(ReplayClock, TheDeadlineItselfIsInTime) {
    const auto exact = run([](auto& clock, std::uint64_t) {
        clock.steps_left = kForEver;
        clock.step_ns = kDeadlineUs * 1000 / kSteps;
    });
    EXPECT_EQ(exact->overruns(), 0U);
    const auto beyond = run([](auto& clock, std::uint64_t) {
        clock.steps_left = kForEver;
        clock.step_ns = kDeadlineUs * 1000 / kSteps + 1;
    });
    EXPECT_EQ(beyond->overruns(), beyond->cycles().count());
}

TEST_F(ReplayClock, ALateCycleIsCountedOnceAndNotRunAgain) {
    const auto out = run([](auto& clock, std::uint64_t cycle) {
        clock.step_ns = 100'000;
        clock.steps_left = cycle == 10 ? kSteps + 1 : 0;
    });
    EXPECT_EQ(out->overruns(), 1U);
    EXPECT_EQ(out->cycles().most_ns(), kSteps * 100'000);
    EXPECT_EQ(out->stop_count(), 0U) << "on a computer that is not the guard's it is not judged";
}

TEST_F(ReplayClock, PairTimesAddUpToTheirCycle) {
    const auto out = run([](auto& clock, std::uint64_t) {
        clock.steps_left = kForEver;
        clock.step_ns = 1'000;
    });
    ASSERT_EQ(out->pairs().size(), 8U);
    for (const PairStatistics& pair : out->pairs()) {
        EXPECT_EQ(pair.time.count(), out->cycles().count());
        EXPECT_EQ(pair.time.mean_ns(), 1'000);
        EXPECT_EQ(pair.not_proven, 0U);
    }
    EXPECT_EQ(out->cycles().mean_ns(), kSteps * 1'000);
}

}  // namespace
}  // namespace axg
