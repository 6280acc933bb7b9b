// SPDX-License-Identifier: Apache-2.0
// Samples in place of frames: the same permits and the same stop as from the frames of a board,
// the number of each sample is believed, and what is no sample of the machine is refused.
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <optional>
#include <thread>

#include "firmware_if/axguardd/status_json.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/live/status_line.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "firmware_if/system/status_socket.hpp"
#include "tests/support/c_host.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/simulated_frames.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNonce = 0xC0FFEE;

/// The samples of a trace, as their receiver has them.
std::vector<axg_sample> samples_of(const Machine& machine, std::span<const CanFrame> frames) {
    std::vector<axg_sample> samples;
    AxisReceiver receiver(machine);
    std::int64_t first = -1;
    for (const CanFrame& frame : frames) {
        const ReceiverEvent event = receiver.on_frame(frame);
        if (event.kind != ReceiverEvent::Kind::snapshot) {
            continue;
        }
        const AxisSnapshot& snapshot = event.snapshot;
        first = first < 0 ? event.sync_counter - 1 : first;
        axg_sample sample{};
        sample.latched_us = snapshot.latched_us;
        sample.number = static_cast<std::uint64_t>(first) + snapshot.sample;
        sample.axis_count = snapshot.axis_count;
        sample.nonce = kNonce;
        sample.tool = snapshot.tool;
        sample.mode = snapshot.mode;
        sample.flags = snapshot.flags;
        for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
            const bool is_rotary = machine.axes[i].kind == AxisKind::rotary;
            sample.position[i] =
                snapshot.position[i] * (is_rotary ? 180.0 / std::numbers::pi : 1.0);
        }
        samples.push_back(sample);
    }
    return samples;
}

/// Words, echoes and n of the permits, in order.
struct Permits {
    void operator()(const axg_frame& frame, std::int64_t) {
        if (frame.id == 0x103) {
            words.push_back({frame.data[0], frame.data[1], frame.data[7]});
        }
    }
    std::vector<std::array<std::uint8_t, 3>> words;
};

void play_sample(test::CHost& host, const axg_sample& sample) {
    while (host.ok && host.state.next_due_us < sample.latched_us) {
        host.cycle(host.state.next_due_us);
    }
    EXPECT_EQ(axg_guard_put_sample(host.guard, &sample, sample.latched_us + 450), AXG_STATUS_OK);
    host.cycle(sample.latched_us + 450);
}

/// Until a stop, or the end: how many samples were played.
std::size_t play_samples(test::CHost& host, std::span<const axg_sample> samples) {
    EXPECT_EQ(axg_guard_start(host.guard, samples[0].latched_us), AXG_STATUS_OK);
    host.state.next_due_us = samples[0].latched_us;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        play_sample(host, samples[i]);
        if (!host.ok || host.state.phase == AXG_PHASE_STOPPED) {
            return i + 1;
        }
    }
    return samples.size();
}

const std::vector<CanFrame>& demo_frames() {
    static const std::vector<CanFrame> frames = [] {
        const test::Workshop shop;
        return test::simulated_frames(test::load_paper_machine().machine,
                                      test::after_rest(shop, test::kDemoProgram));
    }();
    return frames;
}

axg_stop explained(test::CHost& host, std::int32_t program_line = 0) {
    axg_stop stop{};
    EXPECT_EQ(axg_guard_explain(host.guard, program_line, &stop), AXG_STATUS_OK);
    return stop;
}

TEST(CInterfaceSamples, AreTheSameGuardAsTheirFrames) {
    const Machine machine = test::load_paper_machine().machine;
    const std::vector<axg_sample> samples = samples_of(machine, demo_frames());
    Permits of_frames, of_samples;
    test::CHost framed(test::c_options(AXG_MODE_STOPPABLE));
    framed.arms_from_us = samples[0].latched_us + 300'000;
    framed.on_sent = std::ref(of_frames);
    framed.play(demo_frames());
    test::CHost sampled(test::c_options(AXG_MODE_STOPPABLE));
    sampled.arms_from_us = framed.arms_from_us;
    sampled.on_sent = std::ref(of_samples);
    play_samples(sampled, samples);
    ASSERT_EQ(sampled.state.phase, AXG_PHASE_STOPPED);
    EXPECT_STREQ(sampled.state.reason, framed.state.reason);
    EXPECT_STREQ(sampled.state.reason, "predicted");
    EXPECT_EQ(sampled.state.pair, framed.state.pair);
    EXPECT_EQ(sampled.state.samples_lost, 0U);
    EXPECT_EQ(sampled.state.snapshots, framed.state.snapshots);
    EXPECT_GT(of_samples.words.size(), 1000U);
    // A set of frames takes its time on the bus: there the arming is one sample earlier.
    ASSERT_LE(of_frames.words.size() - of_samples.words.size(), 1U);
    of_frames.words.erase(
        of_frames.words.begin(),
        of_frames.words.end() - static_cast<std::ptrdiff_t>(of_samples.words.size()));
    EXPECT_TRUE(of_samples.words == of_frames.words);
}

// For a guard on another computer: the frames carry what the sample says, and their receiver has
// it.
TEST(CInterfaceSamples, EncodedTheyAreTheFramesOfABoard) {
    const Machine machine = test::load_paper_machine().machine;
    const std::vector<axg_sample> samples = samples_of(machine, demo_frames());
    const test::CHost host(test::c_options(AXG_MODE_CONTACT));  // not started, and never will be
    std::vector<CanFrame> sent;
    std::array<axg_frame, AXG_SAMPLE_FRAMES_MAX> frames{};
    std::uint32_t count = 0;
    for (const axg_sample& sample : std::span(samples).first(500)) {
        ASSERT_EQ(axg_guard_encode_sample(host.guard, &sample, frames.data(), AXG_SAMPLE_FRAMES_MAX,
                                          &count),
                  AXG_STATUS_OK);
        ASSERT_GT(count, 1U);
        for (const axg_frame& frame : std::span(frames).first(count)) {
            CanFrame out;
            out.time_us = sample.latched_us;
            out.id = frame.id;
            out.fd = (frame.flags & AXG_FRAME_FD) != 0;
            out.length_bytes = frame.length_bytes;
            std::copy(std::begin(frame.data), std::end(frame.data), out.data.begin());
            sent.push_back(out);
        }
    }
    const std::vector<axg_sample> heard = samples_of(machine, sent);
    ASSERT_EQ(heard.size(), 500U);
    for (std::size_t i = 0; i < heard.size(); ++i) {
        ASSERT_EQ(heard[i].number % 240, samples[i].number % 240);
        ASSERT_EQ(heard[i].tool, samples[i].tool);
        ASSERT_EQ(heard[i].mode, samples[i].mode);
        for (std::uint32_t axis = 0; axis < heard[i].axis_count; ++axis) {
            ASSERT_NEAR(heard[i].position[axis], samples[i].position[axis], 1e-9) << i;
        }
    }
    EXPECT_EQ(axg_guard_encode_sample(host.guard, samples.data(), frames.data(), 1, &count),
              AXG_STATUS_BAD_CALL);
    axg_sample bad = samples[0];
    bad.axis_count = 4;
    EXPECT_EQ(
        axg_guard_encode_sample(host.guard, &bad, frames.data(), AXG_SAMPLE_FRAMES_MAX, &count),
        AXG_STATUS_BAD_CALL);
}

TEST(CInterfaceSamples, TheStateSaysWhatWasProven) {
    const Machine machine = test::load_paper_machine().machine;
    const std::vector<axg_sample> samples = samples_of(machine, demo_frames());
    test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
    ASSERT_EQ(axg_guard_start(host.guard, samples[0].latched_us), AXG_STATUS_OK);
    host.cycle(samples[0].latched_us);
    EXPECT_EQ(host.state.proof.samples_evaluated, 0U);
    EXPECT_EQ(host.state.proof.samples, 0);
    for (std::size_t i = 0; host.state.phase != AXG_PHASE_STOPPED || i < 50; ++i) {
        ASSERT_LT(i, samples.size());
        play_sample(host, samples[i]);
        const axg_proof& proof = host.state.proof;
        if (host.state.phase == AXG_PHASE_ARMED) {
            ASSERT_EQ(proof.is_proven, 1) << i;
            ASSERT_STREQ(proof.reason, "none");
            ASSERT_STREQ(proof.withheld, "nothing");
            ASSERT_GE(proof.samples, machine.can.permit_samples.least);
            ASSERT_EQ(proof.sync_counter, samples[i].number % 240 + 1);
            ASSERT_EQ(proof.cap, 250);
        }
    }
    const axg_proof& proof = host.state.proof;
    EXPECT_EQ(proof.is_proven, 0);
    EXPECT_EQ(proof.samples, 0);
    EXPECT_STREQ(proof.reason, "predicted");
    EXPECT_EQ(proof.pair, host.state.pair);
    EXPECT_EQ(proof.needed_mm, machine.pairs[proof.pair].margin_mm);
    EXPECT_EQ(proof.clearance_mm, -1);
}

// A stop is explained with the distances of its pair and the control's line; at rest a proven jog
// follows, and until the reset all of it stays.
TEST(CInterfaceSamples, AStopIsExplainedAndAtRestWithAWayOut) {
    const Machine machine = test::load_paper_machine().machine;
    const std::vector<axg_sample> samples = samples_of(machine, demo_frames());
    test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
    axg_sample sample = samples[play_samples(host, samples) - 1];
    ASSERT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    ASSERT_EQ(host.state.is_confirmed, 0);
    const axg_stop stop = explained(host, 12);
    ASSERT_EQ(stop.pair, host.state.pair);
    EXPECT_GT(stop.clearance_mm, 0);
    EXPECT_GT(stop.needed_mm, stop.clearance_mm);
    const std::string head =
        "stopped: verdict: predicted: " + std::string(axg_guard_pair_name(host.guard, stop.pair)) +
        ", program line 12\n";
    const std::string words = stop.text;
    EXPECT_EQ(words.rfind(head, 0), 0U) << words;
    EXPECT_NE(words.find("mm apart, the proof of a stop needs up to"), std::string::npos) << words;
    EXPECT_EQ(std::count(words.begin(), words.end(), '\n') + 1, stop.line_count);
    host.arms = false;
    sample.mode = 0;
    for (int i = 0; i < 300; ++i) {
        sample.latched_us += 1000;
        ++sample.number;
        play_sample(host, sample);
    }
    ASSERT_EQ(host.state.is_confirmed, 1);
    const axg_stop at_rest = explained(host, 12);
    EXPECT_EQ(at_rest.clearance_mm, stop.clearance_mm) << "of the stop, whatever followed";
    EXPECT_EQ(at_rest.needed_mm, stop.needed_mm);
    EXPECT_EQ(std::string(at_rest.text).rfind(words + "\njog ", 0), 0U) << at_rest.text;
    EXPECT_EQ(at_rest.line_count, stop.line_count + 1);
    EXPECT_EQ(axg_guard_explain(host.guard, 0, nullptr), AXG_STATUS_BAD_CALL);
    for (int i = 0; i < 600; ++i) {  // a person moves Z up by hand, and rests
        sample.latched_us += 1000;
        ++sample.number;
        sample.mode = i < 300 ? 1 : 0;
        sample.position[2] += i < 250 ? 0.02 : 0;
        play_sample(host, sample);
    }
    ASSERT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    const axg_stop higher = explained(host, 12);
    EXPECT_EQ(higher.clearance_mm, stop.clearance_mm);
    EXPECT_NE(std::string(higher.text), std::string(at_rest.text)) << "from where it is now";
    EXPECT_EQ(std::string(higher.text).rfind(words + "\njog ", 0), 0U) << higher.text;
}

// An unknown tool stops, and is no dead end: the words name it, the file and the way out, and the
// reset is accepted with a tool that the file has. Words of an earlier fault are gone by then.
TEST(CInterfaceSamples, AnUnknownToolIsExplainedAndLeftByAnother) {
    const Machine machine = test::load_paper_machine().machine;
    axg_sample sample = samples_of(machine, demo_frames()).front();
    test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
    ASSERT_EQ(axg_guard_start(host.guard, sample.latched_us), AXG_STATUS_OK);
    host.state.next_due_us = sample.latched_us;
    host.arms = false;
    const auto stand = [&](std::uint16_t tool, std::uint8_t flags, int samples) {
        sample.tool = tool;
        sample.flags = flags;
        for (int i = 0; i < samples; ++i) {
            sample.latched_us += 1000;
            ++sample.number;
            play_sample(host, sample);
        }
    };
    const auto words = [&] { return std::string(explained(host).text); };
    const auto reset = [&] {
        EXPECT_EQ(axg_guard_notify(host.guard, AXG_EVENT_RESET, host.now), AXG_STATUS_OK);
        host.cycle(host.now);
        return std::string(host.state.refused);
    };
    stand(1, 1, 200);  // not homed
    ASSERT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    EXPECT_EQ(words().rfind("stopped: input: not_homed (", 0), 0U) << words();
    stand(1, 0, 300);
    ASSERT_EQ(reset(), "");
    stand(1, 0, 300);
    ASSERT_EQ(host.state.phase, AXG_PHASE_READY);
    EXPECT_EQ(words(), "");
    EXPECT_STREQ(host.state.input_fault, "");
    stand(99, 0, 300);
    ASSERT_EQ(host.state.phase, AXG_PHASE_STOPPED);
    EXPECT_EQ(words(),
              "stopped: verdict: tool\ntool 99 is not in paper-trunnion.yaml: add it under tools; "
              "load another tool to go on");
    EXPECT_EQ(reset(), "reset: a fault is still present");
    stand(1, 0, 300);
    EXPECT_EQ(words(), "stopped: verdict: tool");
    EXPECT_EQ(reset(), "");
    stand(1, 0, 300);
    ASSERT_EQ(host.state.phase, AXG_PHASE_READY);
    EXPECT_EQ(axg_guard_notify(host.guard, AXG_EVENT_ARM, host.now), AXG_STATUS_OK);
    stand(1, 0, 10);
    EXPECT_EQ(host.state.phase, AXG_PHASE_ARMED) << "without a restart";
}

/// Keys of a JSON object, in order.
std::vector<std::string> keys_of(const test::Json& json) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : json.items()) {
        keys.push_back(key);
    }
    return keys;
}

/// As play_samples(), but not much faster than a machine, so that the logger has no record to lose.
std::size_t play_slowly(test::CHost& host, std::span<const axg_sample> samples) {
    EXPECT_EQ(axg_guard_start(host.guard, samples[0].latched_us), AXG_STATUS_OK);
    host.state.next_due_us = samples[0].latched_us;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        play_sample(host, samples[i]);
        if (!host.ok || host.state.phase == AXG_PHASE_STOPPED) {
            return i + 1;
        }
        if (i % 100 == 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    }
    return samples.size();
}

/// What the guard's status socket sends, while its process goes on with samples at rest.
std::string status_at_rest(test::CHost& host, axg_sample& sample, const std::string& socket) {
    std::string line, fault;
    std::atomic<bool> is_read{false};
    std::thread reader([&] {
        line = read_status(socket, fault);
        is_read.store(true);
    });
    while (!is_read.load()) {
        sample.latched_us += 1000;
        ++sample.number;
        play_sample(host, sample);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    reader.join();
    EXPECT_EQ(fault, "");
    return line;
}

// People see a guard in another program's process as they see axguardd's: the same document on its
// socket, the same metrics, and a dump of the black box in which a replay finds the stop.
TEST(CInterfaceSamples, AGuardThatIsShownIsShownAsAxguardd) {
    const test::Workshop shop;
    const std::string socket = shop.file("status"), metrics = shop.file("m.prom");
    const std::string folder = shop.file(".");
    const axg_show_options shown{"linuxcnc", socket.c_str(), metrics.c_str(), folder.c_str(), 2};
    const Machine machine = test::load_paper_machine().machine;
    const std::string program = shop.write(
        "down.ngc", "T1 M6\nG4 P0.5\nG0 X20 Y50\nG0 X0 Y107.132 A-19.2 C97\nG0 Z-230\nM2\n");
    const std::vector<axg_sample> samples =
        samples_of(machine, test::simulated_frames(machine, program));
    {
        test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
        ASSERT_EQ(axg_guard_show(host.guard, &shown, nullptr, 0), AXG_STATUS_OK);
        EXPECT_EQ(axg_guard_show(host.guard, &shown, nullptr, 0), AXG_STATUS_BAD_CALL) << "twice";
        axg_sample sample = samples[play_slowly(host, samples) - 1];
        ASSERT_STREQ(host.state.cause, "verdict");
        host.arms = false;
        sample.mode = 0;
        while (host.state.is_confirmed == 0) {
            sample.latched_us += 1000;
            ++sample.number;
            play_sample(host, sample);
        }
        const axg_stop stop = explained(host, 12);
        const std::string line = status_at_rest(host, sample, socket);
        const std::optional<StatusWords> words = words_of_status(line);
        ASSERT_TRUE(words) << line;
        const std::string pair = axg_guard_pair_name(host.guard, stop.pair);
        EXPECT_EQ(words->text.rfind(
                      "linuxcnc: stopped: verdict: predicted: " + pair + ", program line 12, ", 0),
                  0U)
            << words->text;
        ASSERT_EQ(words->ways_out.size(), 1U) << words->text;
        EXPECT_EQ(words->ways_out[0].rfind("jog ", 0), 0U) << words->ways_out[0];
        EXPECT_NE(std::string(stop.text).find(words->ways_out[0]), std::string::npos);
        const auto json = test::Json::parse(line);
        EXPECT_EQ(json["file"], "paper-trunnion.yaml");
        EXPECT_NEAR(json["why"]["available_mm"].get<double>(), stop.clearance_mm, 1e-4);
        EXPECT_LT(json["age_ms"], 1000) << "by the readers' clock, not by that of the samples";
        std::array<char, kStatusLineBytesMax> room{};
        const LiveView view;  // of an axguardd
        const StatusLine other(machine, "m.yaml", "can0", "stoppable", "0");
        const std::size_t size = other.write(&view, {}, 0, room);
        EXPECT_EQ(keys_of(json), keys_of(test::Json::parse(std::string(room.data(), size))));
        const std::string stopped = "axguard_phase_info{bus=\"linuxcnc\",phase=\"stopped\"} 1";
        std::string page;
        for (int i = 0; i < 200 && page.find(stopped) == std::string::npos; ++i) {
            (void)status_at_rest(host, sample, socket);
            page = test::content_of(metrics);  // once a second
        }
        EXPECT_NE(page.find(stopped), std::string::npos);
        EXPECT_EQ(page.find("admission"), std::string::npos) << "there was none";
    }
    EXPECT_FALSE(std::filesystem::exists(socket));
    EXPECT_FALSE(std::filesystem::exists(metrics));
    std::vector<std::string> dumps;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().filename().string().starts_with("linuxcnc-")) {
            dumps.push_back(entry.path().string());
        }
    }
    ASSERT_EQ(dumps.size(), 1U);
    test::Workshop replay;
    EXPECT_EQ(replay.run("replay " + test::kPaperMachine + " " + dumps[0] + " --engine cpu"),
              kExitCollision)
        << replay.err;
    EXPECT_NE(replay.out.find("predicted"), std::string::npos) << replay.out;
}

TEST(CInterfaceSamples, WhatCannotBeShownIsRefused) {
    const test::Workshop shop;
    const test::CHost host(test::c_options(AXG_MODE_CONTACT));
    std::array<char, 400> text{};
    const auto said = [&](const axg_show_options& options) {
        EXPECT_EQ(axg_guard_show(host.guard, &options, text.data(), text.size()),
                  AXG_STATUS_BAD_CALL);
        return std::string(text.data());
    };
    EXPECT_EQ(axg_guard_show(host.guard, nullptr, nullptr, 0), AXG_STATUS_BAD_CALL);
    for (const char* const name : {static_cast<const char*>(nullptr), "", "a b", "../a",
                                   "123456789012345678901234567890123"}) {
        EXPECT_EQ(said({name, nullptr, nullptr, nullptr, 0}),
                  "name: expected 1 to 32 letters, digits, - or _");
    }
    EXPECT_EQ(said({"a", nullptr, nullptr, nullptr, 1}), "black_boxes: no folder. Set state_dir.");
    const std::string file = shop.write("file", "precious");
    EXPECT_NE(said({"a", file.c_str(), nullptr, nullptr, 0}).find("not a socket"),
              std::string::npos)
        << text.data();
    EXPECT_EQ(test::content_of(file), "precious");
    const axg_show_options none{"a", nullptr, nullptr, nullptr, 0};
    EXPECT_EQ(axg_guard_show(host.guard, &none, nullptr, 0), AXG_STATUS_OK);
    const test::CHost started(test::c_options(AXG_MODE_CONTACT));
    ASSERT_EQ(axg_guard_start(started.guard, 0), AXG_STATUS_OK);
    EXPECT_EQ(axg_guard_show(started.guard, &none, nullptr, 0), AXG_STATUS_BAD_CALL);
}

// A number that is left out is a sample that was lost, wherever it was lost.
TEST(CInterfaceSamples, ANumberLeftOutIsASampleLost) {
    const Machine machine = test::load_paper_machine().machine;
    std::vector<axg_sample> samples = samples_of(machine, demo_frames());
    samples.resize(600);
    samples.erase(samples.begin() + 400, samples.begin() + 402);
    test::CHost host(test::c_options(AXG_MODE_STOPPABLE));
    play_samples(host, samples);
    EXPECT_EQ(host.state.samples_lost, 2U);
    EXPECT_EQ(host.state.phase, AXG_PHASE_ARMED) << host.state.cause;
}

TEST(CInterfaceSamples, WhatIsNoSampleOfTheMachineIsRefused) {
    const Machine machine = test::load_paper_machine().machine;
    const axg_sample good = samples_of(machine, demo_frames()).front();
    const std::int64_t now_us = good.latched_us;
    test::CHost host(test::c_options(AXG_MODE_CONTACT));
    EXPECT_EQ(axg_guard_put_sample(host.guard, &good, now_us), AXG_STATUS_BAD_CALL) << "not begun";
    ASSERT_EQ(axg_guard_start(host.guard, now_us), AXG_STATUS_OK);
    EXPECT_EQ(axg_guard_put_sample(nullptr, &good, now_us), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_put_sample(host.guard, nullptr, now_us), AXG_STATUS_BAD_CALL);
    EXPECT_EQ(axg_guard_put_sample(host.guard, &good, now_us - 1), AXG_STATUS_BAD_CALL);
    const auto refused = [&](void (*spoil)(axg_sample&)) {
        axg_sample sample = good;
        spoil(sample);
        return axg_guard_put_sample(host.guard, &sample, now_us) == AXG_STATUS_BAD_CALL;
    };
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.axis_count = 4; }));
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.nonce = 1U << 24; }));
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.reserved[0] = 1; }));
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.position[0] = 1e9; }));
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.tool = 257; })) << "no tool 1";
    EXPECT_TRUE(refused([](axg_sample& sample) { sample.position[1] = NAN; }));
    EXPECT_EQ(axg_guard_put_sample(host.guard, &good, now_us), AXG_STATUS_OK);
}

TEST(CInterfaceSamples, TheTermsAreThoseOfTheMachineFile) {
    const Machine machine = test::load_paper_machine().machine;
    const test::CHost host(test::c_options(AXG_MODE_CONTACT));
    axg_terms terms{};
    EXPECT_EQ(axg_guard_terms(host.guard, nullptr), AXG_STATUS_BAD_CALL);
    ASSERT_EQ(axg_guard_terms(host.guard, &terms), AXG_STATUS_OK);
    EXPECT_EQ(axg_guard_tool_length_mm(host.guard, 1), 140);
    EXPECT_EQ(axg_guard_tool_length_mm(host.guard, 0), 140) << "first_tool";
    EXPECT_EQ(axg_guard_tool_length_mm(host.guard, 2), -1);
    EXPECT_EQ(axg_guard_tool_length_mm(nullptr, 1), -1);
    EXPECT_EQ(terms.period_us, 1000U);
    EXPECT_EQ(terms.reaction_us, 2000U);
    EXPECT_EQ(terms.jitter_us, 20U);
    EXPECT_EQ(terms.permit_samples_max, machine.can.permit_samples.most);
    EXPECT_EQ(terms.permit_version, 2);
    EXPECT_EQ(terms.first_tool, 1);
    EXPECT_EQ(terms.takes_samples, 1);
    EXPECT_EQ(terms.is_independent, 1);
    ASSERT_EQ(terms.axis_count, 5U);
    EXPECT_STREQ(terms.axes[3].name, "A");
    EXPECT_EQ(terms.axes[3].is_rotary, 1);
    EXPECT_DOUBLE_EQ(terms.axes[3].min, -110);
    EXPECT_DOUBLE_EQ(terms.axes[3].stopping, 500);
    EXPECT_DOUBLE_EQ(terms.axes[0].jerk, 50000);
    EXPECT_EQ(terms.axes[4].is_endless, 1);
    ASSERT_TRUE(machine.guard.jog.is_promised);
    EXPECT_DOUBLE_EQ(terms.axes[0].jog_speed, machine.guard.jog.speed_mm_s);
    EXPECT_DOUBLE_EQ(terms.axes[3].jog_acceleration,
                     machine.guard.jog.acceleration_rad_s2 * 180 / std::numbers::pi);
}

// A board's H has jitter and age as one sum.
TEST(CInterfaceSamples, TheJitterOfTheTermsHoldsTheAgeOfPositions) {
    const test::Workshop shop;
    std::string text = test::content_of(test::kPaperMachine);
    text.insert(text.find("\n  permit: 2") + 1, "  latched_age_us: [0, 1001]\n");
    const std::string file = shop.write("aged.yaml", text);
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    options.machine_file = file.c_str();
    options.mesh_root = test::kPaperMeshes.c_str();
    const test::CHost host(options);
    axg_terms terms{};
    ASSERT_EQ(axg_guard_terms(host.guard, &terms), AXG_STATUS_OK);
    EXPECT_EQ(terms.jitter_us, 20U + 1012U) << "1 % more than 1001 us, and up";
}

// A program that was compiled with the version before: its axg_state ends where it did.
TEST(CInterfaceSamples, AProgramOfVersion2GetsTheStateOfVersion2) {
    axg_options options = test::c_options(AXG_MODE_CONTACT);
    for (const std::uint32_t version : {2U, AXG_INTERFACE_VERSION}) {
        options.version = version;
        test::CHost host(options);
        ASSERT_EQ(axg_guard_start(host.guard, 0), AXG_STATUS_OK);
        std::array<unsigned char, sizeof(axg_state)> memory{};
        memory.fill(0x5A);
        axg_state* const state = reinterpret_cast<axg_state*>(memory.data());
        ASSERT_EQ(axg_guard_process(host.guard, 0, state), AXG_STATUS_OK);
        EXPECT_EQ(state->phase, AXG_PHASE_SELFTEST);
        const unsigned char* const end = memory.data() + memory.size();
        const unsigned char* const behind = memory.data() + offsetof(axg_state, proof);
        const bool is_untouched = std::all_of(behind, end, [](auto b) { return b == 0x5A; });
        EXPECT_EQ(is_untouched, version == 2U);
    }
}

}  // namespace
}  // namespace axg
