// SPDX-License-Identifier: Apache-2.0
// A million frames of the clean program are replayed at least twenty times as fast as the machine
// moved. Reading the log is timed with it, as a user's replay does; the processor is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kFrames = 1'000'000;
constexpr double kTimesRealTime = 20;

std::int64_t steady_ns(void*) {
    return std::chrono::steady_clock::now().time_since_epoch().count();
}

std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("model name", 0) == 0) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown processor";
}

/// The clean program and then its moves again and again, until the trace has the frames wanted.
void simulate_frames(const Machine& machine, const std::string& path) {
    GcodeOptions options;
    options.start = default_start(machine);
    const GcodeResult reading = read_gcode(test::content_of(test::kCleanProgram), machine, options);
    EXPECT_TRUE(reading.faults.empty());
    Program program = reading.program;
    std::vector<Move> path_moves;  // a tool change or dwell holds the place where it was written
    std::copy_if(program.moves.begin(), program.moves.end(), std::back_inserter(path_moves),
                 [](const Move& move) { return move.kind == MoveKind::line; });
    for (int i = 1; i < 6; ++i) {
        program.moves.insert(program.moves.end(), path_moves.begin(), path_moves.end());
    }
    const SimulationSummary summary = simulate_trace(machine, program, {}, path);
    EXPECT_EQ(summary.error, "");
    EXPECT_GE(summary.frames, kFrames);
}

TEST(ReplaySpeed, AMillionFramesAtTwentyTimesRealTime) {
    test::PaperMachine paper;
    ASSERT_TRUE(paper.engine.has_value());
    const test::Workshop shop;
    const std::string path = shop.file("long.log");
    simulate_frames(paper.loaded.machine, path);

    ReplayOptions options;
    options.deadline_us = paper.loaded.machine.deadline_us;
    options.clock.now_ns = &steady_ns;
    ReplayRun run(paper.loaded.machine, paper.engine->engine(), *paper.containment_test, options,
                  nullptr);
    const auto start = std::chrono::steady_clock::now();
    std::string error;
    const auto trace = open_trace(path, {}, error);
    ASSERT_NE(trace, nullptr) << error;
    CanFrame frame;
    std::int64_t first_us = 0, last_us = 0;
    while (run.frame_count() < kFrames && trace->next(frame)) {
        first_us = run.frame_count() == 0 ? frame.time_us : first_us;
        last_us = frame.time_us;
        ASSERT_TRUE(run.on_frame(frame)) << "stopped";
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    ASSERT_EQ(trace->error(), "");
    ASSERT_EQ(run.frame_count(), kFrames);
    const double machine_s = static_cast<double>(last_us - first_us) * 1e-6;
    const double factor = machine_s / spent.count();
    std::printf("%llu frames, %.1f s of machine time in %.2f s: %.0f times real time\n",
                static_cast<unsigned long long>(run.frame_count()), machine_s, spent.count(),
                factor);
    std::printf("cycle: median %.2f us, p99 %.2f us, most %.2f us; %s, %s\n",
                static_cast<double>(run.cycles().at_share_ns(0.5)) * 1e-3,
                static_cast<double>(run.cycles().at_share_ns(0.99)) * 1e-3,
                static_cast<double>(run.cycles().most_ns()) * 1e-3,
                std::string(paper.engine->lanes()).c_str(), processor().c_str());
    EXPECT_GE(factor, kTimesRealTime);
    EXPECT_GT(run.permits(), kFrames / 5);
}

}  // namespace
}  // namespace axg
