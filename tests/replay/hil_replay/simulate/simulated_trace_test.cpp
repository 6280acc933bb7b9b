// SPDX-License-Identifier: Apache-2.0
// A simulated trace is one that the receiver accepts without a fault, and its snapshots are the
// planned positions to half a count of the wire. Method: simulate into a file, read it back, feed
// the receiver, follow the sampler beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "hil_replay/motion/program_split.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "hil_replay/trace/trace_reader.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

constexpr const char* kProgram =
    "G0 X20 Y5\nG1 Z-5 F3000\nX30 A-10 C200\nG3 X30 Y25 R10\nT2 M6\nG4 P0.05\nG1 X31 F2\n"
    "G0 X0 Y0 C-500\nM2\n";

Program program_of(const Machine& machine) {
    GcodeOptions options;
    options.start = default_start(machine);
    const GcodeResult reading = read_gcode(kProgram, machine, options);
    EXPECT_TRUE(reading.faults.empty());
    return reading.program;
}

std::string name_of(const char* what) {
    return testing::TempDir() + "/axg_simulated_" + what + ".log";
}

std::string content_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

double apart(double a, double b, bool is_endless) {
    return is_endless ? std::abs(std::remainder(a - b, 2 * kPi)) : std::abs(a - b);
}

struct Form {
    const char* name;
    CanFormat format;
    std::uint32_t sample_us;
};

class SimulatedTrace : public testing::TestWithParam<Form> {};

TEST_P(SimulatedTrace, IsWhatTheReceiverAccepts) {
    Machine machine = motion_test_machine();
    machine.can.format = GetParam().format;
    machine.can.sample_us = GetParam().sample_us;
    const Program program = program_of(machine);
    SimulationOptions options;
    options.sample_us = GetParam().sample_us;
    const std::string path = name_of(GetParam().name);
    const SimulationSummary summary = simulate_trace(machine, program, options, path);
    ASSERT_EQ(summary.error, "");

    const AxisFrameSet set = make_frame_set(machine);
    const MotionLimits limits = make_motion_limits(machine);
    MotionSampler sampler(program, limits, options.motion);
    AxisReceiver receiver(machine);
    receiver.acknowledge();
    std::string error;
    const auto reader = open_trace(path, {}, error);
    ASSERT_NE(reader, nullptr) << error;
    CanFrame frame;
    MotionSample sample;
    std::uint64_t snapshots = 0, moving = 0;
    bool has_more = sampler.next(sample);
    while (reader->next(frame)) {
        const ReceiverEvent event = receiver.on_frame(frame);
        ASSERT_NE(event.kind, ReceiverEvent::Kind::fault)
            << fault_row(event.fault).name << " at picture " << snapshots;
        if (event.kind != ReceiverEvent::Kind::snapshot) {
            continue;
        }
        const std::uint64_t wanted =
            static_cast<std::uint64_t>((event.snapshot.latched_us - kTraceStartUs) / kMotionStepUs);
        while (has_more && sample.index < wanted) {
            has_more = sampler.next(sample);
        }
        for (std::uint32_t i = 0; i < set.axis_count; ++i) {
            ASSERT_LE(apart(event.snapshot.position[i], sample.position[i], set.axes[i].unlimited),
                      set.axes[i].unit * 0.5001)
                << "picture " << snapshots << " axis " << i;
        }
        moving += event.snapshot.mode == kModeMoving ? 1 : 0;
        ++snapshots;
    }
    EXPECT_EQ(reader->error(), "");
    EXPECT_EQ(snapshots, summary.samples);
    EXPECT_EQ(receiver.counters().samples_lost, 0U);
    EXPECT_GT(moving, snapshots / 10);
    EXPECT_LT(moving, snapshots);
    EXPECT_EQ(sample.position, program.moves.back().target) << "the end pose was sent";
    std::remove(path.c_str());
}

INSTANTIATE_TEST_SUITE_P(Forms, SimulatedTrace,
                         testing::Values(Form{"classical", CanFormat::classical, 1000},
                                         Form{"fd", CanFormat::fd, 1000},
                                         Form{"paper", CanFormat::classical, 100},
                                         Form{"slow", CanFormat::fd, 4000}),
                         [](const auto& form) { return std::string(form.param.name); });

TEST(SimulatedTraceFile, IsTheSameBytesEveryTime) {
    const Machine machine = motion_test_machine();
    const Program program = program_of(machine);
    const std::string one = name_of("one"), two = name_of("two");
    ASSERT_EQ(simulate_trace(machine, program, {}, one).error, "");
    ASSERT_EQ(simulate_trace(machine, program, {}, two).error, "");
    const std::string text = content_of(one);
    EXPECT_GT(text.size(), 100000U);
    EXPECT_EQ(text, content_of(two));
    EXPECT_EQ(text.substr(0, 19), "(0000000001.000000)");
    std::remove(one.c_str());
    std::remove(two.c_str());
}

TEST(SimulatedTraceFile, IsNotThereAfterAnError) {
    Machine machine = motion_test_machine();
    machine.axes[0].max = 1e4;  // beyond the 8388 mm of a classical frame
    GcodeOptions options;
    const GcodeResult reading = read_gcode("G0 X9000\n", machine, options);
    ASSERT_TRUE(reading.faults.empty());
    const std::string path = name_of("range");
    std::remove(path.c_str());
    const SimulationSummary summary = simulate_trace(machine, reading.program, {}, path);
    EXPECT_EQ(summary.exit_code, kExitInput);
    EXPECT_NE(summary.error.find("1: X: "), std::string::npos) << summary.error;
    EXPECT_NE(summary.error.find("Use --fd"), std::string::npos) << summary.error;
    EXPECT_FALSE(std::ifstream(path).good());
    EXPECT_NE(simulate_trace(machine, reading.program, {}, "/nonexistent/x.log").error, "");
}

TEST(AxisByAxis, MovesOneAxisAtATimeAndEndsAtTheSamePlaces) {
    const Machine machine = motion_test_machine();
    const Program program = program_of(machine);
    const Program split = split_by_axis(program, machine);
    EXPECT_EQ(split.moves.back().target, program.moves.back().target);
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    MotionSampler sampler(split, limits, motion);
    MotionSample sample, before;
    ASSERT_TRUE(sampler.next(before));
    std::uint64_t steps = 0;
    while (sampler.next(sample)) {
        int moving = 0;
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            moving += sample.position[i] != before.position[i] ? 1 : 0;
        }
        ASSERT_LE(moving, 1) << "line " << sample.line;
        steps += static_cast<std::uint64_t>(moving);
        before = sample;
    }
    EXPECT_GT(steps, 10000U);
    // Inverse time: the parts together take the time of the whole.
    GcodeOptions options;
    const GcodeResult timed = read_gcode("G93 G1 X10 C30 F2\n", machine, options);
    const Program parts = split_by_axis(timed.program, machine);
    ASSERT_EQ(parts.moves.size(), 2U);
    EXPECT_NEAR(1 / parts.moves[0].feed + 1 / parts.moves[1].feed, 1 / 2.0, 1e-12);
}

}  // namespace
}  // namespace axg
