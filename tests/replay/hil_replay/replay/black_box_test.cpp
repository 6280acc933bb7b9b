// SPDX-License-Identifier: Apache-2.0
// A stop on the live guard's own code, with the paper's machine and a wire in memory, and the dump
// that it leaves: `axguard replay` finds the same stop in it, at the same sample, from the dump
// alone. Runs the program itself for that.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>

#include "config/machine/effective_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/live_engine.hpp"
#include "firmware_if/live/black_box_dump.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/operator_panel.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/test_wire.hpp"

namespace axg {
namespace {

const std::string kProgram = "T1 M6\nG4 P1\nG0 X20 Y50\nG0 X0 Y107.132 A-19.2 C97\nG0 Z-230\nM2\n";

/// The live guard, the engine's thread and the logger over one wire, by a counter for time.
class RecordedWorld {
  public:
    explicit RecordedWorld(const LoadedMachine& loaded_machine, std::size_t size_bytes)
        : loaded(loaded_machine),
          black_box(size_bytes),
          cpu_(make_engine(loaded)),
          containment_test_(make_containment_test(loaded, *cpu_)),
          certificate_(make_stop_certificate(loaded)),
          chain_(loaded.machine, cpu_->engine(), *containment_test_, {&*certificate_}) {
        std::copy_n(configuration_hash(loaded.machine, loaded.meshes).begin(), 64,
                    header.configuration.begin());
        header.is_stoppable = true;
        header.plan = certificate_->plan();
    }

    /// The trace, later by `later_us`; `each` is called after every frame.
    void play(const std::vector<CanFrame>& trace, std::int64_t later_us,
              const std::function<bool()>& each) {
        if (!guard) {
            wire.now_us = trace.front().time_us + later_us - 5000;
            const LiveOptions options{
                .black_box = &records,
                .hashes = configuration_hashes(loaded.machine, loaded.meshes)};
            guard = std::make_unique<GuardNode>(loaded.machine, options, wire, queues, latch,
                                                wire.now_us);
        }
        for (const CanFrame& frame : trace) {
            CanFrame later = frame;
            later.time_us += later_us;
            run_until(later.time_us);
            wire.arrive(later);
            if (!each()) {
                return;
            }
        }
    }
    void run_until(std::int64_t until_us) {
        for (; wire.now_us < until_us; wire.now_us += 50) {
            engine();
            guard->turn(wire.now_us);
            answer_hashes();
            logger();
        }
    }

    const LoadedMachine& loaded;
    test::TestWire wire;
    BlackBox black_box;
    BlackBoxHeader header;
    LatchCell latch{kLatchClear, ~kLatchClear};
    std::unique_ptr<GuardNode> guard;
    std::int64_t response_us = 150;
    std::function<void(BlackBoxEntry&)> alters = [](BlackBoxEntry&) {};
    bool is_engine_asleep = false;  // and then queries the newest of what waits

  private:
    void engine() {
        while (!results_.empty() && results_.front().done_us <= wire.now_us) {
            ASSERT_TRUE(queues.results.push(results_.front()));
            results_.pop_front();
        }
        if (!is_engine_asleep) {
            run_queries(engine_, queues, [this](LiveResult live_result) {
                live_result.done_us = wire.now_us + response_us;
                results_.push_back(live_result);
            });
        }
    }
    /// The board of the trace was given the same machine.
    void answer_hashes() {
        for (; heard_ < wire.sent.size(); ++heard_) {
            HashFrame hash;
            if (wire.sent[heard_].id == loaded.machine.can.hashes_out_id &&
                decode_hash(wire.sent[heard_], hash)) {
                wire.arrive(encode_hash(loaded.machine.can.hashes_in_id, hash, wire.now_us));
            }
        }
    }
    void logger() {
        BlackBoxEntry record;
        while (records.pop(record)) {
            alters(record);
            black_box.add(record);
        }
        LiveNote note;
        while (queues.notes.pop(note)) {
        }
    }

    std::size_t heard_ = 0;  // of the frames sent
    LiveQueues queues;
    BlackBoxQueue records;
    std::optional<CpuEngine> cpu_;
    std::optional<ContainmentTest> containment_test_;
    std::optional<StopCertificate> certificate_;
    GuardChain chain_;
    LiveEngine engine_{loaded.machine, chain_};
    std::deque<LiveResult> results_;
};

class BlackBoxReplayTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<test::Workshop>();
        loaded = std::make_unique<LoadedMachine>();
        ASSERT_TRUE(load(test::kPaperMachine, "", *loaded, stderr));
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            return;
        }
        const std::string program = shop->write("a.ngc", kProgram);
        ASSERT_EQ(shop->run("simulate " + test::kPaperMachine + " a.ngc -o trace.log"), kExitClean)
            << program << shop->err;
        trace = test::read_trace(shop->file("trace.log"));
    }
    static void TearDownTestSuite() {
        shop.reset();
        loaded.reset();
    }
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
        ASSERT_GT(trace.size(), 1000U);
    }
    GuardPhase phase() const { return world->guard->guard().phase; }
    void make_world(std::size_t size_bytes = 0) {
        const Machine& machine = loaded->machine;
        world = std::make_unique<RecordedWorld>(
            *loaded, size_bytes != 0 ? size_bytes : black_box_bytes(machine));
    }
    /// What a person does who waits until the axes stand. Whether the guard is armed.
    bool arm() {
        if (phase() == GuardPhase::ready) {
            world->guard->arm(world->wire.now_us);
        }
        return phase() == GuardPhase::armed;
    }
    /// The same by a panel's frames, which asks again where it is refused.
    bool arm_by_frames(test::OperatorPanel& panel) {
        const std::int64_t now_us = world->wire.now_us;
        if (phase() != GuardPhase::ready || now_us < panel_due_us) {
            return phase() == GuardPhase::armed;
        }
        panel_due_us = now_us + 20'000;
        std::uint32_t nonce = 0;
        for (const CanFrame& frame : world->wire.sent) {
            const auto status = test::status_in(frame);
            nonce = status ? status->nonce : nonce;
        }
        world->wire.arrive(nonce == 0 ? panel.request(AXG_OPERATOR_ARM, now_us)
                                      : panel.confirm(AXG_OPERATOR_ARM, nonce, now_us));
        return false;
    }
    /// Plays until a stop after arming, and 50 ms on.
    void play_to_stop(std::int64_t later_us = 0) {
        bool was_armed = false;
        world->play(trace, later_us, [&] {
            was_armed = arm() || was_armed;
            return !was_armed || phase() != GuardPhase::stopped;
        });
        ASSERT_TRUE(was_armed);
        ASSERT_EQ(phase(), GuardPhase::stopped);
        world->run_until(world->wire.now_us + 50'000);
    }
    /// Plays 400 frames to an armed guard, less where it stops before, and silence. `breaks` is
    /// called once on the way.
    void play_to_silence(const std::function<void(RecordedWorld&)>& breaks) {
        std::size_t armed_frames = 0;
        world->play(trace, 0, [&] {
            armed_frames += arm() ? 1 : 0;
            if (armed_frames == 300) {
                ++armed_frames;
                breaks(*world);
            }
            return armed_frames < 400 && !(armed_frames > 300 && phase() == GuardPhase::stopped);
        });
        world->run_until(world->wire.now_us + 20'000);
    }
    /// Writes the dump and has the program replay it: its document.
    test::Json replay(int wanted_code, const std::string& more = "") {
        std::string fault;
        const std::string path = write_black_box(world->black_box, world->header,
                                                 {.folder = shop->file("."), .bus = "can0"}, fault);
        EXPECT_NE(path, "") << fault;
        EXPECT_EQ(
            shop->run("replay " + test::kPaperMachine + " " + path + " --json=box.json " + more),
            wanted_code)
            << shop->out << shop->err;
        return test::Json::parse(test::content_of(shop->file("box.json")));
    }
    /// Of a dump that goes back to the start.
    static void expect_same_frames(const test::Json& all) {
        ASSERT_FALSE(all["sent"].is_null()) << all.dump(1);
        EXPECT_EQ(all["sent"]["different"], 0) << shop->out;
        EXPECT_EQ(all["sent"]["same"].get<long>(),
                  all["frames_sent"].get<long>() + all["frames_refused"].get<long>());
    }
    static std::unique_ptr<test::Workshop> shop;
    static std::unique_ptr<LoadedMachine> loaded;
    static std::vector<CanFrame> trace;
    std::unique_ptr<RecordedWorld> world;
    std::int64_t panel_due_us = 0;
};

std::unique_ptr<test::Workshop> BlackBoxReplayTest::shop;
std::unique_ptr<LoadedMachine> BlackBoxReplayTest::loaded;
std::vector<CanFrame> BlackBoxReplayTest::trace;

TEST_F(BlackBoxReplayTest, AStopIsFoundAgainAtTheSameSampleForTheSameReasonAndPair) {
    make_world();
    play_to_stop();
    ASSERT_EQ(world->guard->guard().cause, GuardFault::verdict);
    const auto all = replay(kExitCollision);
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    EXPECT_EQ(all["recorded"]["reason"], "predicted");
    EXPECT_EQ(all["recorded"]["pair"], "cutter-c");
    EXPECT_EQ(all["replayed"]["reason"], all["recorded"]["reason"]);
    EXPECT_EQ(all["replayed"]["pair"], all["recorded"]["pair"]);
    EXPECT_EQ(all["replayed"]["latched_us"], all["recorded"]["latched_us"]);
    EXPECT_GT(all["recorded"]["latched_us"].get<long>(), 0);
    EXPECT_EQ(all["why"]["pair"], "cutter-c");
    EXPECT_GT(all["why"]["needed_mm"].get<double>(), all["why"]["available_mm"].get<double>());
    EXPECT_EQ(replay(kExitCollision, "--program a.ngc")["program_block"], "G0 Z-230");
    // It goes back to the start, so everything is compared.
    EXPECT_GT(all["verdicts"]["same"].get<long>(), 100);
    EXPECT_EQ(all["verdicts"]["different"], 0);
    EXPECT_EQ(all["verdicts"]["run_in"], 0);
    EXPECT_EQ(all["snapshots"]["different"], 0);
    EXPECT_EQ(all["snapshots"]["run_in"], 0);
    EXPECT_EQ(all["records_lost"], 0);
    expect_same_frames(all);
    // The wire of this world takes 150 us a frame, its engine as long, and a turn is 50 us.
    EXPECT_EQ(all["permit_us"]["count"], world->guard->counters().permits);
    EXPECT_GE(all["permit_us"]["p50"].get<long>(), 300);
    EXPECT_LE(all["permit_us"]["p99"].get<long>(), 450);
    EXPECT_GE(all["stop_us"].get<long>(), 300);
    EXPECT_LE(all["stop_us"].get<long>(), 450);
    EXPECT_GT(all["frames_sent"].get<long>(), 200);
    EXPECT_NE(shop->out.find("stopped: verdict: predicted: cutter-c"), std::string::npos)
        << shop->out;
}

// No call is recorded: the guard that runs once more hears the panel, draws the same nonces and
// arms.
// A smaller plan proves less and stops earlier. The dump holds it, and a replay anywhere goes by
// it.
TEST_F(BlackBoxReplayTest, AStopByAnotherDevicesPlanIsFoundAgain) {
    make_world();
    play_to_stop();
    const auto usual_us = replay(kExitCollision)["recorded"]["latched_us"].get<std::int64_t>();
    loaded->machine.plan = plan_of(1, stop_tasks(loaded->machine), 0, {500, 500, 2000, 4000, 0});
    make_world();
    loaded->machine.plan.reset();
    play_to_stop();
    const auto all = replay(kExitCollision);
    EXPECT_LT(all["recorded"]["latched_us"].get<std::int64_t>(), usual_us);
    EXPECT_EQ(all["recorded"]["latched_us"], all["replayed"]["latched_us"]);
    EXPECT_EQ(all["verdicts"]["different"], 0);
    EXPECT_EQ(all["plan"]["stages"].size(), 1U);
    EXPECT_EQ(all["plan"]["stages"][0]["leaf_pairs"], 500);
    world->header.plan = plan_of(2, stop_tasks(loaded->machine), 510, {512, 512, 2048, 4096, 0});
    EXPECT_GT(replay(kExitInternal)["verdicts"]["different"].get<long>(), 0)
        << "by another plan than it was proven by";
}

TEST_F(BlackBoxReplayTest, AnArmingByFramesIsMadeAgain) {
    make_world();
    test::OperatorPanel panel;
    bool was_armed = false;
    world->play(trace, 0, [&] {
        was_armed = arm_by_frames(panel) || was_armed;
        return !was_armed || phase() != GuardPhase::stopped;
    });
    world->run_until(world->wire.now_us + 50'000);
    ASSERT_EQ(world->guard->counters().operator_acts, 1U);
    ASSERT_EQ(world->guard->guard().cause, GuardFault::verdict);
    const auto all = replay(kExitCollision, "--frames-out frames.log");
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    expect_same_frames(all);
    const std::string frames = test::content_of(shop->file("frames.log"));
    EXPECT_NE(frames.find(" 584#"), std::string::npos) << "a tool finds the panel's messages";
    EXPECT_NE(frames.find(" 604#"), std::string::npos) << "and the guard's status";
}

// The ring is full many times over: what the guard knew at its beginning has to be learnt first.
TEST_F(BlackBoxReplayTest, ADumpOfTheLastPartAloneFindsTheSameStop) {
    make_world(100'000);
    play_to_stop();
    const auto all = replay(kExitCollision);
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    EXPECT_EQ(all["verdicts"]["different"], 0);
    EXPECT_GT(all["verdicts"]["run_in"].get<long>(), 0);
    EXPECT_LT(all["verdicts"]["run_in"].get<long>(), 60);
    EXPECT_GT(all["verdicts"]["same"].get<long>(), 30);
    EXPECT_TRUE(all["sent"].is_null());
    EXPECT_NE(shop->out.find("frames sent: not compared"), std::string::npos) << shop->out;
}

TEST_F(BlackBoxReplayTest, SnapshotsThatTheEngineSkippedAreSkippedAgain) {
    make_world();
    std::int64_t turns = 0;
    bool was_armed = false;
    world->play(trace, 0, [&] {
        world->is_engine_asleep = was_armed && ++turns / 6 % 2 == 0;  // in and out of two periods
        was_armed = arm() || was_armed;
        return !was_armed || phase() != GuardPhase::stopped;
    });
    world->is_engine_asleep = false;
    ASSERT_EQ(phase(), GuardPhase::stopped);
    world->run_until(world->wire.now_us + 5000);
    const bool is_verdict = world->guard->guard().cause == GuardFault::verdict;
    const auto all = replay(is_verdict ? kExitCollision : kExitDeadline);
    EXPECT_EQ(all["verdicts"]["different"], 0) << all.dump(1);
    EXPECT_EQ(all["snapshots"]["different"], 0);
    EXPECT_LT(all["verdicts"]["same"].get<long>() + 1, all["snapshots"]["same"].get<long>());
    expect_same_frames(all);
}

// What stops by time or by the wire is in no frame; the guard that runs once more stops by it too.
TEST_F(BlackBoxReplayTest, EveryOtherStopIsFoundAgainWithTheSameFrames) {
    struct Case {
        GuardFault cause;
        int exit_code;
        std::function<void(RecordedWorld&)> breaks;
    };
    const std::vector<Case> cases{
        {GuardFault::silence, kExitDeadline,
         [](RecordedWorld& live) { live.response_us = 1'000'000; }},
        {GuardFault::silence, kExitDeadline, [](RecordedWorld& live) { live.response_us = 1600; }},
        {GuardFault::output, kExitCan, [](RecordedWorld& live) { live.wire.is_deaf = true; }},
        {GuardFault::output, kExitCan,
         [](RecordedWorld& live) { live.wire.reply = SendStatus::busy; }},
        {GuardFault::input, kExitCan,
         [](RecordedWorld& live) { live.wire.inject(ReadStatus::down); }},
        {GuardFault::gap, kExitDeadline, [](RecordedWorld& live) { live.wire.now_us += 20'000; }},
        {GuardFault::refused, kExitUnfit,
         [](RecordedWorld& live) { live.guard->report(GuardFault::refused, live.wire.now_us); }},
        {GuardFault::gap, kExitDeadline,
         [](RecordedWorld& live) { live.guard->report(GuardFault::gap, live.wire.now_us); }},
        {GuardFault::foreign_stop, kExitCan,
         [](RecordedWorld& live) {
             live.wire.arrive(encode_stop(live.loaded.machine.can, live.wire.now_us));
         }},
        {GuardFault::second_guard, kExitCan, [](RecordedWorld& live) {
             live.wire.arrive(
                 encode_permit(live.loaded.machine.can, Permit{}, live.wire.now_us)[0]);
         }}};
    for (const Case& wrong : cases) {
        SCOPED_TRACE(to_text(wrong.cause));
        make_world();
        play_to_silence(wrong.breaks);
        ASSERT_EQ(phase(), GuardPhase::stopped);
        ASSERT_EQ(world->guard->guard().cause, wrong.cause);
        const auto all = replay(wrong.exit_code);
        EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
        expect_same_frames(all);
    }
}

// A frame that was not sent as it was recorded must be found out.
TEST_F(BlackBoxReplayTest, AFrameThatWasAlteredIsFoundOut) {
    make_world();
    world->alters = [](BlackBoxEntry& entry) {
        auto* sent = std::get_if<SentFrame>(&entry.content);
        if (sent != nullptr && sent->frame.id == loaded->machine.can.emergency_id) {
            sent->frame.data[0] ^= 1;
        }
    };
    play_to_stop();
    const auto all = replay(kExitInternal);
    EXPECT_GT(all["sent"]["different"].get<long>(), 0);
    EXPECT_NE(shop->out.find(fmt::format("frame {:03X}", loaded->machine.can.emergency_id)),
              std::string::npos)
        << shop->out;
}

// The clock found it, not a frame: the dump knows when the guard looked at the clock.
TEST_F(BlackBoxReplayTest, SilenceOfTheBoardIsFoundAgain) {
    make_world();
    play_to_silence([](RecordedWorld&) {});
    ASSERT_EQ(world->guard->guard().cause, GuardFault::input);
    const auto all = replay(kExitCan);
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    EXPECT_EQ(all["recorded"]["fault"], "stale");
    EXPECT_EQ(all["replayed"]["fault"], "stale");
    EXPECT_EQ(all["verdicts"]["different"], 0);
    expect_same_frames(all);
}

// Two runs in one dump, with a person's reset between them.
TEST_F(BlackBoxReplayTest, AResetIsPlayedToo) {
    make_world();
    play_to_stop();
    const std::int64_t later_us = world->wire.now_us + 10'000 - trace.front().time_us;
    bool was_reset = false, was_armed = false;
    world->play(trace, later_us, [&] {
        if (phase() == GuardPhase::stopped && !was_reset && world->guard->guard().is_confirmed) {
            world->guard->reset(world->wire.now_us);
            was_reset = phase() != GuardPhase::stopped;
        }
        was_armed = arm() || was_armed;
        return !was_armed || phase() != GuardPhase::stopped;
    });
    ASSERT_TRUE(was_reset && was_armed);
    ASSERT_EQ(world->guard->guard().cause, GuardFault::verdict);
    world->run_until(world->wire.now_us + 5000);
    const auto all = replay(kExitCollision);
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    EXPECT_EQ(all["verdicts"]["different"], 0);
    EXPECT_EQ(all["snapshots"]["different"], 0);
    expect_same_frames(all);
}

constexpr std::size_t kTurn = 300;  // samples

/// From this sample on slower, back, and all the way: no axis turns round at once.
std::vector<AxisSnapshot> turned_round(const std::vector<AxisSnapshot>& there, std::size_t from) {
    std::vector<AxisSnapshot> out;
    double at = static_cast<double>(from);
    for (std::size_t k = 0; at >= 0; ++k) {
        const auto before = std::min(static_cast<std::size_t>(at), there.size() - 2);
        const double share = at - static_cast<double>(before);
        AxisSnapshot p = there[before];
        for (std::uint32_t i = 0; i < p.axis_count; ++i) {
            p.position[i] += share * (there[before + 1].position[i] - p.position[i]);
        }
        out.push_back(p);
        at += std::max(-1.0, 1 - 2 * static_cast<double>(k + 1) / kTurn);
    }
    return out;
}

/// The way to the sample latched at `until_us` and some samples on, back, and there again, by a
/// board that says that it stands still all the while.
std::vector<CanFrame> there_and_back(const Machine& machine, const std::vector<CanFrame>& trace,
                                     std::int64_t until_us) {
    AxisReceiver receiver(machine);
    test::Heard heard;
    test::listen(receiver, trace, heard);
    std::vector<AxisSnapshot> way = std::move(heard.snapshots);
    const std::int64_t ends_us = until_us + 40'000 + 1000 * std::int64_t{kTurn / 4};
    std::erase_if(way, [&](const AxisSnapshot& p) { return p.latched_us > ends_us; });
    const std::vector<AxisSnapshot> there = way;
    const std::size_t turn = there.size() - kTurn / 4 - 1;  // so far beyond it the way leads
    way.resize(turn);
    for (const AxisSnapshot& p : turned_round(there, turn)) {
        way.push_back(p);
    }
    way.insert(way.end(), 100, there.front());
    way.insert(way.end(), there.begin(), there.end());
    AxisEncoder encoder(machine);
    std::vector<CanFrame> out;
    for (std::size_t k = 0; k < way.size(); ++k) {
        way[k].sample = k;
        way[k].latched_us = trace.front().time_us + 1000 * static_cast<std::int64_t>(k);
        way[k].mode = kModeStandstill;
        const std::vector<CanFrame> frames = test::frames_of(encoder, way[k]);
        out.insert(out.end(), frames.begin(), frames.end());
    }
    return out;
}

// What was not proven while nobody had armed latched nothing. A replay that did not know would find
// a stop there.
TEST_F(BlackBoxReplayTest, WhatWasWithheldBeforeArmingIsWithheldAgain) {
    make_world();
    play_to_stop();
    const auto stop_us = replay(kExitCollision)["recorded"]["latched_us"].get<std::int64_t>();
    make_world();
    bool was_ready = false, was_withheld = false, was_armed = false;
    test::Json unstopped;
    world->play(there_and_back(loaded->machine, trace, stop_us), 0, [&] {
        was_withheld = was_withheld || (was_ready && phase() == GuardPhase::selftest);
        if (unstopped.is_null() && world->guard->withheld().reason == StopReason::predicted) {
            unstopped = replay(kExitClean);
            EXPECT_NE(shop->out.find("to the end: predicted, cutter-x\n  too little is known of "),
                      std::string::npos)
                << shop->out;
        }
        was_ready = was_ready || phase() == GuardPhase::ready;
        was_armed = (was_withheld && arm()) || was_armed;
        return phase() != GuardPhase::stopped;
    });
    ASSERT_TRUE(was_withheld && was_armed);
    ASSERT_EQ(world->guard->guard().cause, GuardFault::verdict);
    world->run_until(world->wire.now_us + 5000);
    const auto all = replay(kExitCollision);
    EXPECT_TRUE(all["is_reproduced"].get<bool>()) << all.dump(1);
    EXPECT_EQ(all["verdicts"]["different"], 0);
    EXPECT_EQ(all["snapshots"]["different"], 0);
    EXPECT_NE(shop->out.find("withheld: predicted: cutter-c\n"), std::string::npos) << shop->out;
    EXPECT_TRUE(unstopped["recorded"].is_null()) << unstopped.dump(1);
    EXPECT_EQ(unstopped["why"]["cause"], "not_known") << unstopped.dump(1);
}

// A verdict that the frames do not give: the replay must say so, or it would say nothing at all.
TEST_F(BlackBoxReplayTest, AnotherMachineIsRefusedAndFoundOut) {
    make_world();
    play_to_stop();
    std::string text = test::content_of(test::kPaperMachine);
    text.replace(text.find("free_jerk: limited"), 18, "free_jerk: any");
    const std::string other =
        shop->write("any.yaml", text) + " --mesh-root " + test::source_file("config/machines");
    std::string fault;
    const std::string path = write_black_box(world->black_box, world->header,
                                             {.folder = shop->file("."), .bus = "can0"}, fault);
    EXPECT_EQ(shop->run("replay " + other + " " + path), kExitInput);
    EXPECT_NE(shop->err.find("Pass the machine file"), std::string::npos) << shop->err;
    EXPECT_EQ(shop->run("replay " + other + " " + path + " --lenient --json=other.json"),
              kExitInternal)
        << shop->out;
    const auto all = test::Json::parse(test::content_of(shop->file("other.json")));
    EXPECT_FALSE(all["is_reproduced"].get<bool>());
    EXPECT_GT(all["verdicts"]["different"].get<long>(), 0);
}

// What is before the damage is judged; where it is, is said.
TEST_F(BlackBoxReplayTest, ADamagedDumpIsUsedUpToTheDamage) {
    make_world();
    play_to_stop();
    std::string fault;
    const std::string path = write_black_box(world->black_box, world->header,
                                             {.folder = shop->file("."), .bus = "can0"}, fault);
    std::string bytes = test::content_of(path);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
    const std::string damaged = shop->write("damaged.axgbox", bytes);
    EXPECT_EQ(shop->run("replay " + test::kPaperMachine + " " + damaged + " --json=box.json"),
              kExitCan);
    EXPECT_NE(shop->err.find("damaged.axgbox:"), std::string::npos) << shop->err;
    EXPECT_NE(shop->err.find(". Earlier records are used"), std::string::npos) << shop->err;
    const auto all = test::Json::parse(test::content_of(shop->file("box.json")));
    EXPECT_GT(all["verdicts"]["same"].get<long>(), 50);
}

TEST_F(BlackBoxReplayTest, InspectSaysWhatReadsIt) {
    std::string fault;
    const BlackBox black_box(1000);
    const std::string path =
        write_black_box(black_box, {}, {.folder = shop->file("."), .bus = "can1"}, fault);
    EXPECT_EQ(shop->run("inspect " + path + " --json=unread.json"), kExitCan);
    for (const std::string& said : {shop->err, test::content_of(shop->file("unread.json"))}) {
        EXPECT_NE(
            said.find("found a black box of axguardd, expected a trace). Read it with axguard "
                      "replay MACHINE FILE; with --frames-out LOG, replay writes its frames"),
            std::string::npos)
            << said;
    }
    EXPECT_EQ(shop->err.find("can_logconvert"), std::string::npos) << shop->err;
}

// Its frames as a log are a trace like any other.
TEST_F(BlackBoxReplayTest, TheFramesOfADumpAreATrace) {
    make_world();
    play_to_stop();
    const auto all = replay(kExitCollision, "--frames-out frames.log");
    EXPECT_EQ(shop->run("replay " + test::kPaperMachine +
                        " frames.log --deadline-us 10000000 --json=trace.json"),
              kExitCollision)
        << shop->err;
    const auto again = test::Json::parse(test::content_of(shop->file("trace.json")));
    EXPECT_EQ(again["stops"][0]["reason"], "predicted");
    EXPECT_EQ(again["stops"][0]["pair"], "cutter-c");
    EXPECT_EQ(shop->run("replay " + test::kPaperMachine + " " + shop->file("none.axgbox")),
              kExitInput);
}

}  // namespace
}  // namespace axg
