// SPDX-License-Identifier: Apache-2.0
// The C interface as another process meets it: the example in C stops where `axguard replay` stops;
// every call says by its code what it was given; what the process leaves undone stops the guard.
#include <thread>

#include "tests/support/c_host.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/simulated_frames.hpp"

namespace axg {
namespace {

/// The sample of the first stop, its reason and pair, as the example prints them.
std::string stop_line(const test::Json& stop) {
    auto pair = stop["pair"].get<std::string>();
    pair.replace(pair.find('-'), 1, " - ");
    return "stopped at " + std::to_string(stop["time_us"].get<std::int64_t>()) +
           " us: verdict: " + stop["reason"].get<std::string>() + ": " + pair + "\n";
}

TEST(CInterface, TheExampleInCStopsAtTheSampleWhereReplayDoes) {
    const std::string example = std::string(AXG_BINARY_DIR) + "/guard_a_trace";
    if (!std::filesystem::exists(AXG_PROGRAM) || !std::filesystem::exists(example)) {
        GTEST_SKIP() << example << " or " << AXG_PROGRAM << " is not built";
    }
    test::Workshop shop;
    ASSERT_EQ(shop.run("simulate " + test::kPaperMachine + " " +
                       test::after_rest(shop, test::kDemoProgram) + " -o t.log"),
              0)
        << shop.err;
    for (const std::string mode : {"contact", "stoppable"}) {
        ASSERT_EQ(shop.run("replay " + test::kPaperMachine + " t.log --engine cpu --mode " + mode +
                           " --deadline-us 10000000 --json=stops.json"),
                  10)
            << shop.err;
        const auto stops = test::Json::parse(test::content_of(shop.file("stops.json")))["stops"];
        const std::string command = "'" + example + "' '" + test::kPaperMachine + "' '" +
                                    shop.file("t.log") + "' " + mode + " >'" + shop.file("said") +
                                    "'";
        const int status = std::system(command.c_str());
        EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 10);
        const std::string said = test::content_of(shop.file("said"));
        EXPECT_EQ(said.substr(0, said.find('\n') + 1), stop_line(stops.at(0))) << mode;
    }
}

// The same guard under a C process and under a recorded trace: the same frames in the same order at
// the same times, from the first heartbeat to the repeated stops. Both are armed at the same
// instant of the rest at the beginning.
TEST(CInterface, AHostSendsWhatAReplaySends) {
    if (!std::filesystem::exists(AXG_PROGRAM)) {
        GTEST_SKIP() << AXG_PROGRAM << " is not built";
    }
    test::Workshop shop;
    ASSERT_EQ(shop.run("simulate " + test::kPaperMachine + " " +
                       test::after_rest(shop, test::kDemoProgram) + " -o t.log"),
              0)
        << shop.err;
    const std::vector<CanFrame> trace = test::read_trace(shop.file("t.log"));
    const CanLayout can = test::load_paper_machine().machine.can;
    const std::int64_t armed_us = trace.front().time_us + 300'000;
    const std::string arm_at = std::to_string(armed_us / 1'000'000) + "." +
                               std::to_string(1'000'000 + armed_us % 1'000'000).substr(1);
    for (const auto& [name, mode] :
         {std::pair{"contact", AXG_MODE_CONTACT}, {"stoppable", AXG_MODE_STOPPABLE}}) {
        SCOPED_TRACE(name);
        ASSERT_EQ(shop.run("replay " + test::kPaperMachine + " t.log --engine cpu --mode " + name +
                           " --deadline-us 10000000 --frames-out all.log --arm-at " + arm_at),
                  10)
            << shop.err;
        std::vector<std::string> replayed, hosted;
        // A replay does not judge the period of its trace, and is ready before the host: what
        // counts on from ready is not compared.
        const auto is_compared = [&](std::int64_t time_us, std::uint32_t id) {
            return time_us >= armed_us && (id == can.permit_id || id == can.permit_id + 1 ||
                                           id == can.stop_id || id == can.emergency_id);
        };
        const auto line_of = [](std::int64_t time_us, std::uint32_t id,
                                std::span<const std::uint8_t> data) {
            std::string line = std::to_string(time_us) + " " + std::to_string(id);
            for (const std::uint8_t byte : data) {
                line += " " + std::to_string(byte);
            }
            return line;
        };
        for (const CanFrame& frame : test::read_trace(shop.file("all.log"))) {
            if ((is_guard_id(can, frame.id) || frame.id == can.stop_id) &&
                is_compared(frame.time_us, frame.id)) {
                replayed.push_back(line_of(frame.time_us, frame.id,
                                           std::span(frame.data).first(frame.length_bytes)));
            }
        }
        test::CHost host(test::c_options(mode));
        host.arms_from_us = armed_us;
        host.on_sent = [&](const axg_frame& frame, std::int64_t now_us) {
            if (is_compared(now_us, frame.id)) {
                hosted.push_back(line_of(now_us, frame.id, {frame.data, frame.length_bytes}));
            }
        };
        host.play(trace, false);
        ASSERT_GT(replayed.size(), 1000U);
        ASSERT_GE(hosted.size(), replayed.size()) << "it goes on behind the stop";
        hosted.resize(replayed.size());
        for (std::size_t i = 0; i < replayed.size(); ++i) {
            ASSERT_EQ(hosted[i], replayed[i]) << "frame " << i;
        }
    }
}

/// Frames of a program that ends clear.
const std::vector<CanFrame>& clear_frames() {
    static const std::vector<CanFrame> frames = [] {
        const test::Workshop shop;
        const std::string program =
            shop.write("p.ngc", "T1 M6\nG4 P0.5\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nM2\n");
        return test::simulated_frames(test::load_paper_machine().machine, program);
    }();
    return frames;
}

TEST(CInterface, EveryWrongCallHasItsCode) {
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    axg_guard* guard = reinterpret_cast<axg_guard*>(&options);  // to see that it is cleared
    EXPECT_EQ(axg_guard_create(nullptr, &guard, nullptr, 0), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(guard, nullptr);
    EXPECT_EQ(axg_guard_create(&options, nullptr, nullptr, 0), AXG_STATUS_BAD_CALL);
    options.version = AXG_INTERFACE_VERSION + 1;
    EXPECT_EQ(axg_guard_create(&options, &guard, nullptr, 0), AXG_STATUS_BAD_VERSION);
    options = test::c_options(AXG_MODE_CONTACT);
    options.mode = AXG_MODE_CONTACT + 1;
    EXPECT_EQ(axg_guard_create(&options, &guard, nullptr, 0), AXG_STATUS_BAD_CALL);
    options = test::c_options(AXG_MODE_CONTACT);
    options.engine = AXG_ENGINE_AUTO + 1;
    EXPECT_EQ(axg_guard_create(&options, &guard, nullptr, 0), AXG_STATUS_BAD_CALL);

    test::CHost host(test::c_options(AXG_MODE_CONTACT));
    axg_frame frame{};
    axg_state state{};
    EXPECT_EQ(axg_guard_receive(host.guard, &frame), AXG_STATUS_BAD_CALL) << "before the start";
    EXPECT_EQ(axg_guard_process(host.guard, 0, &state), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_evaluate(host.guard), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_notify(host.guard, AXG_EVENT_ARM, 0), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_next_tx_frame(host.guard, &frame), AXG_STATUS_EMPTY);
    EXPECT_EQ(axg_guard_start(host.guard, 0), AXG_STATUS_OK);
    EXPECT_EQ(axg_guard_start(host.guard, 0), AXG_STATUS_BAD_CALL) << "twice";
    EXPECT_EQ(axg_guard_process(host.guard, 0, nullptr), AXG_STATUS_BAD_CALL);
    frame.length_bytes = 65;
    EXPECT_EQ(axg_guard_receive(host.guard, &frame), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_notify(host.guard, AXG_EVENT_SUSPENDED + 1, 0), AXG_STATUS_BAD_CALL);
    EXPECT_STREQ(axg_guard_pair_name(host.guard, AXG_NO_PAIR), "");
    EXPECT_STREQ(axg_guard_pair_name(host.guard, 0), "cutter - x");
    for (int status = AXG_STATUS_OK; status <= AXG_STATUS_INTERNAL; ++status) {
        EXPECT_STRNE(axg_status_text(static_cast<axg_status>(status)), "unknown status");
    }
    axg_guard_destroy(nullptr);
}

TEST(CInterface, AFileThatIsRefusedIsNamedInATextThatFits) {
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    options.machine_file = "nowhere.yaml";
    axg_guard* guard = nullptr;
    std::array<char, 400> text{};
    EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), text.size()), AXG_STATUS_BAD_INPUT);
    EXPECT_EQ(guard, nullptr);
    const std::string words = text.data();
    EXPECT_NE(words.find("nowhere.yaml"), std::string::npos) << words;
    text.fill('x');
    EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), 5), AXG_STATUS_BAD_INPUT);
    EXPECT_EQ(std::string(text.data(), 5), words.substr(0, 4) + '\0');
    EXPECT_EQ(text[5], 'x');
}

TEST(CInterface, AMachineWithoutHashesIsAWarningInTheText) {
    const test::Workshop shop;
    const std::string file = shop.write(
        "none.yaml",
        test::with(test::content_of(test::kPaperMachine), "hashes: required", "hashes: none"));
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    for (const std::string& machine : {test::kPaperMachine, file}) {
        options.machine_file = machine.c_str();
        options.mesh_root = test::kPaperMeshes.c_str();
        axg_guard* guard = nullptr;
        std::array<char, 4096> text{};
        EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), text.size()), AXG_STATUS_OK);
        EXPECT_EQ(std::string(text.data()).find("can.hashes: none: ") != std::string::npos,
                  machine == file)
            << text.data();
        axg_guard_destroy(guard);
    }
}

// Drives without speeds never show that they stand: no stop of them could be confirmed.
TEST(CInterface, AMachineThatNeverStandsIsRefused) {
    const test::Workshop shop;
    const std::string file =
        shop.write("drives.yaml",
                   test::paper_machine_with_drives(test::content_of(test::kPaperMachine), false));
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    options.machine_file = file.c_str();
    options.mesh_root = test::kPaperMeshes.c_str();
    axg_guard* guard = nullptr;
    std::array<char, 400> text{};
    EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), text.size()), AXG_STATUS_BAD_INPUT);
    EXPECT_EQ(guard, nullptr);
    EXPECT_NE(std::string(text.data()).find("(missing: X, Y, Z, A, C)"), std::string::npos)
        << text.data();
}

// As run does, and with every reason.
TEST(CInterface, PermitsThatNothingObeysAreRefused) {
    const test::Workshop shop;
    std::string drives =
        test::paper_machine_with_drives(test::content_of(test::kPaperMachine), false);
    drives.replace(drives.find("sync_counter: 240"), 17, "sync_counter: 100");
    const std::string file = shop.write("drives.yaml", drives);
    axg_options options = test::c_options(AXG_MODE_STOPPABLE);
    options.machine_file = file.c_str();
    options.mesh_root = test::kPaperMeshes.c_str();
    axg_guard* guard = nullptr;
    std::array<char, 800> text{};
    EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), text.size()), AXG_STATUS_BAD_INPUT);
    EXPECT_EQ(guard, nullptr);
    const std::string words = text.data();
    EXPECT_TRUE(words.starts_with("guard.obeyed_by: no board can obey these permits: ")) << words;
    EXPECT_NE(words.find("(found can.sync_counter: 100, expected 240)"), std::string::npos);
    EXPECT_NE(words.find("\ncan.drives: no stop can be confirmed"), std::string::npos) << words;
}

// A guard of a deployed host is armed while the axes stand, whatever the host wants.
TEST(CInterface, IsNotArmedInMotion) {
    test::CHost host(test::c_options(AXG_MODE_CONTACT));
    host.arms = false;
    const std::span<const CanFrame> frames = clear_frames();
    host.play(frames.first(4000), false);
    ASSERT_EQ(host.state.phase, AXG_PHASE_READY) << host.state.cause;
    (void)axg_guard_notify(host.guard, AXG_EVENT_ARM, host.now);
    host.cycle(host.now + 10);
    EXPECT_EQ(host.state.phase, AXG_PHASE_READY);
    EXPECT_STREQ(host.state.refused, "arm: the axes are not at rest");
}

// The dead man: whatever the process leaves undone ends the permits, and stops.
TEST(CInterface, NothingThatTheProcessLeavesUndoneIsPermitted) {
    const std::span<const CanFrame> frames = clear_frames();
    struct Omission {
        const char* cause;
        void (*omit)(test::CHost&);
    };
    for (const Omission& omission :
         {Omission{"output", [](test::CHost& host) { host.echoes = false; }},
          Omission{"silence", [](test::CHost& host) { host.answers = false; }},
          Omission{"input", [](test::CHost& host) {
                       (void)axg_guard_notify(host.guard, AXG_EVENT_BUS_DOWN, host.now);
                   }}}) {
        test::CHost host(test::c_options(AXG_MODE_CONTACT));
        EXPECT_EQ(host.play(frames.first(frames.size() / 2)), frames.size() / 2);
        EXPECT_EQ(host.state.phase, AXG_PHASE_ARMED) << host.state.cause;
        EXPECT_GT(host.state.permits, 10U);
        const std::int64_t from_us = host.now;
        omission.omit(host);
        host.play(frames.subspan(frames.size() / 2));
        EXPECT_EQ(host.state.phase, AXG_PHASE_STOPPED) << omission.cause;
        EXPECT_STREQ(host.state.cause, omission.cause);
        EXPECT_LE(host.last_permit_us, from_us + 3000) << omission.cause;
    }
}

TEST(CInterface, MoreFramesThanFitStopTheGuard) {
    test::CHost host(test::c_options(AXG_MODE_CONTACT));
    const std::span<const CanFrame> frames = clear_frames();
    host.play(frames.first(frames.size() / 2));
    ASSERT_EQ(host.state.phase, AXG_PHASE_ARMED);
    axg_frame frame{};
    frame.time_us = host.now;
    frame.id = 0x7FF;  // nobody's
    int taken = 0;
    while (taken < 1000 && axg_guard_receive(host.guard, &frame) == AXG_STATUS_OK) {
        ++taken;
    }
    EXPECT_EQ(taken, 256);
    EXPECT_EQ(axg_guard_receive(host.guard, &frame), AXG_STATUS_QUEUE_FULL);
    host.cycle(host.now + 10);
    EXPECT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    EXPECT_STREQ(host.state.bus_fault, "cannot read the socket");
}

// A stop outlives the guard in the caller's memory, and ends by a reset alone, for which the
// machine has to stand.
TEST(CInterface, ALatchedStopOutlivesTheGuardUntilAReset) {
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    axg_latch latch;
    axg_latch_clear(&latch);
    options.latch = &latch;
    const std::span<const CanFrame> frames = clear_frames();
    {
        test::CHost host(options);
        host.play(frames.first(frames.size() / 2));
        ASSERT_EQ(host.state.phase, AXG_PHASE_ARMED);
        (void)axg_guard_notify(host.guard, AXG_EVENT_BUS_DOWN, host.now);
        host.cycle(host.now + 10);
        ASSERT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    }
    {
        test::CHost host(options);
        host.play(frames.first(1));
        EXPECT_STREQ(host.state.cause, "latched");
        (void)axg_guard_notify(host.guard, AXG_EVENT_RESET, host.now);
        host.cycle(host.now + 10);
        EXPECT_EQ(host.state.phase, AXG_PHASE_STOPPED);
        EXPECT_STRNE(host.state.refused, "") << "nobody has seen that the axes stand";
        host.play(frames.subspan(1, 600), false);  // the axes rest before the program begins
        ASSERT_EQ(axg_guard_notify(host.guard, AXG_EVENT_RESET, host.now), AXG_STATUS_OK);
        host.play(frames.subspan(601, 900), false);  // as long as the period takes to be shown
        EXPECT_EQ(host.state.phase, AXG_PHASE_ARMED) << host.state.refused;
        test::CHost other(options);
        other.play(frames.first(1));
        EXPECT_STREQ(other.state.cause, "latched") << "of one that is armed and never destroyed";
    }
    test::CHost next(options);
    next.play(frames.first(1));
    EXPECT_NE(next.state.phase, AXG_PHASE_STOPPED) << "the reset is kept too";
}

// Towards a collision the cap falls, for a machine that wants one, and is rapid for any other.
TEST(CInterface, ThePermitCarriesTheSpeedCapThatTheMachineFileAsksFor) {
    const test::Workshop shop;
    const std::string capped = test::capped_machine(shop);
    const std::vector<CanFrame> frames = test::simulated_frames(
        test::load_paper_machine().machine, test::after_rest(shop, test::kDemoProgram));
    for (const bool has_cap : {false, true}) {
        axg_options options = test::c_options(AXG_MODE_STOPPABLE);
        options.machine_file = (has_cap ? capped : test::kPaperMachine).c_str();
        options.mesh_root = test::kPaperMeshes.c_str();
        test::CHost host(options);
        host.play(frames);
        EXPECT_STREQ(host.state.reason, "predicted");
        EXPECT_GT(host.state.permits, 1000U);
        if (has_cap) {
            EXPECT_LT(host.cap_least, 125) << "less than half of rapid before the stop";
        } else {
            EXPECT_EQ(host.cap_least, kSpeedCapRapid);
        }
    }
}

// Processing in one thread, the geometry in another: the same permits, and no sample late.
TEST(CInterface, TheGeometryMayHaveAThreadOfItsOwn) {
    test::CHost host(test::c_options(AXG_MODE_CONTACT));
    host.answers = false;
    std::atomic<bool> is_ending{false};
    std::atomic<int> wanted{0}, given{0};
    host.arms = true;
    std::span<const CanFrame> frames = clear_frames();
    frames = frames.first(std::min<std::size_t>(frames.size(), 3000));
    ASSERT_EQ(axg_guard_start(host.guard, frames[0].time_us), AXG_STATUS_OK);
    std::thread engine([&] {
        while (!is_ending) {
            if (wanted != given) {
                EXPECT_EQ(axg_guard_evaluate(host.guard), AXG_STATUS_OK);
                ++given;
            }
            std::this_thread::yield();
        }
    });
    host.state.next_due_us = frames[0].time_us;
    for (const CanFrame& frame : frames) {
        const axg_frame now = test::c_frame(frame);
        EXPECT_EQ(axg_guard_receive(host.guard, &now), AXG_STATUS_OK);
        host.cycle(frame.time_us);
        if (host.state.has_query != 0) {
            ++wanted;
            while (wanted != given) {  // time is the trace's: it waits for the other thread
                std::this_thread::yield();
            }
            host.cycle(frame.time_us);
        }
    }
    is_ending = true;
    engine.join();
    EXPECT_TRUE(host.ok);
    EXPECT_EQ(host.state.phase, AXG_PHASE_ARMED) << host.state.cause;
    EXPECT_GT(host.state.permits, 500U);
    EXPECT_EQ(host.state.late, 0U);
}

}  // namespace
}  // namespace axg
