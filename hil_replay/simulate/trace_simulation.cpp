// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/simulate/trace_simulation.hpp"

#include <cmath>
#include <deque>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "hil_replay/motion/least_time.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "hil_replay/trace/candump_log.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kProgressSteps = 1'000'000;

class TraceBuilder {
  public:
    TraceBuilder(const Machine& machine, const std::string& path, SimulationSummary& summary)
        : machine_(machine), encoder_(machine), writer_(path), summary_(summary) {}

    /// False after an error, which is in the summary then. A board with a look-ahead path buffers
    /// that many samples: the axes reach a sample that many periods after it is added, and rest
    /// until the buffer is full.
    bool add(const MotionSample& sample) {
        const std::uint32_t look_ahead = encoder_.frame_set().look_ahead_samples;
        if (look_ahead == 0) {
            return send(sample, nullptr);
        }
        PathPoints points;
        points.position = sample.position;
        points.before = buffer_.empty() ? sample.position : buffer_.back().position;
        if (buffer_.empty()) {
            buffer_.assign(look_ahead, sample);
        }
        buffer_.push_back(sample);
        const MotionSample now = buffer_.front();
        buffer_.pop_front();
        return send(now, &points);
    }

    /// Moves the axes to the last sample.
    bool empty_buffer() {
        const std::uint32_t look_ahead = encoder_.frame_set().look_ahead_samples;
        for (std::uint32_t i = 0; i < look_ahead && !buffer_.empty(); ++i) {
            const MotionSample last = buffer_.back();
            if (!add(last)) {
                return false;
            }
        }
        return true;
    }

    bool finish() {
        summary_.frames = writer_.frame_count();
        return writer_.finish() || fail_write();
    }

  private:
    bool send(const MotionSample& sample, const PathPoints* look_ahead) {
        AxisSnapshot snapshot;
        snapshot.sample = summary_.samples;
        snapshot.latched_us =
            kTraceStartUs + static_cast<std::int64_t>(summary_.samples) * machine_.can.sample_us;
        snapshot.axis_count = static_cast<std::uint32_t>(machine_.axes.size());
        snapshot.tool = sample.tool;
        snapshot.position = sample.position;
        snapshot.mode = mode_of(sample);
        const EncodeResult result = encoder_.encode(snapshot, frames_, look_ahead);
        if (result.status != EncodeStatus::ok) {
            summary_.exit_code = kExitInput;
            summary_.error = describe(result, sample);
            return false;
        }
        for (std::uint32_t i = 0; i < result.frame_count; ++i) {
            if (!writer_.write(frames_[i])) {
                return fail_write();
            }
        }
        add_program_step(summary_.lines, snapshot.latched_us, sample.line);
        last_ = sample;
        ++summary_.samples;
        return true;
    }

    bool fail_write() {
        summary_.exit_code = kExitInternal;
        summary_.error = writer_.error();
        return false;
    }

    /// A receiver reports a frozen sender if positions do not change in mode moving. So an axis
    /// that needs many samples for one count of its frame counts as at rest, as in a real board's
    /// standstill window.
    [[nodiscard]] std::uint8_t mode_of(const MotionSample& sample) const {
        if (sample.tool != last_.tool && summary_.samples > 0) {
            return kModeToolChange;
        }
        for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
            const double step = std::abs(sample.position[i] - last_.position[i]);
            if (summary_.samples > 0 &&
                step >= kStandstillCounts * encoder_.frame_set().axes[i].unit) {
                return kModeMoving;
            }
        }
        return kModeStandstill;
    }

    [[nodiscard]] std::string describe(const EncodeResult& result,
                                       const MotionSample& sample) const {
        std::string text = to_text(result.status);
        if (result.axis != kNoIndex) {
            const Axis& axis = machine_.axes[result.axis];
            const bool is_rotary = axis.kind == AxisKind::rotary;
            const double value = sample.position[result.axis] * (is_rotary ? 180.0 / kPi : 1.0);
            text = std::to_string(sample.line) + ": " + axis.name + ": " + text + ": " +
                   std::to_string(value) + (is_rotary ? " deg" : " mm") +
                   ". Use --fd, or another scale in the machine file.";
        }
        return text;
    }

    const Machine& machine_;
    AxisEncoder encoder_;
    CandumpWriter writer_;
    SimulationSummary& summary_;
    MotionSample last_;
    std::deque<MotionSample> buffer_;  // commands that the axes have not reached
    std::array<CanFrame, kFramesPerSnapshotMax> frames_{};
};

double xyz_step(const Machine& machine, const MotionLimits& limits, const AxisPositions& from,
                const AxisPositions& to) {
    double sum = 0;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (limits.feed_group[i] == 0) {
            sum += (to[i] - from[i]) * (to[i] - from[i]);
        }
    }
    return std::sqrt(sum);
}

}  // namespace

SimulationSummary simulate_trace(const Machine& machine, const Program& program,
                                 const SimulationOptions& options, const std::string& path) {
    SimulationSummary summary;
    Machine board = machine;
    board.can.sample_us = options.sample_us;
    const MotionLimits limits = make_motion_limits(board);
    MotionSampler sampler(program, limits, options.motion);
    LimitMeter meter(limits.axis_count);
    TraceBuilder trace(board, path, summary);
    const std::uint64_t every = options.sample_us / kMotionStepUs;
    MotionSample sample, before;
    while (sampler.next(sample)) {
        meter.add(sample.position);
        summary.path_mm +=
            sample.index == 0 ? 0 : xyz_step(board, limits, before.position, sample.position);
        before = sample;
        if (sample.index % every == 0 && !trace.add(sample)) {
            return summary;
        }
        if (sample.index % kProgressSteps == 0 && options.progress) {
            options.progress(static_cast<double>(sample.index) * kMotionStepS, sample.line);
        }
        if (summary.samples > options.samples_max) {
            summary.exit_code = kExitInput;
            summary.error =
                std::to_string(sample.line) + ": program: " + too_many_samples(options.samples_max);
            return summary;
        }
    }
    summary.program_s = static_cast<double>(before.index) * kMotionStepS;
    // Adds the next sample instant and one more at rest, so that the receiver sees the end pose at
    // rest.
    for (int i = 0; i < 2; ++i) {
        before.index = (before.index / every + 1) * every;
        if (!trace.add(before)) {
            return summary;
        }
    }
    if (!trace.empty_buffer()) {
        return summary;
    }
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        summary.peaks[i] = meter.peak(i);
    }
    summary.runs = sampler.run_count();
    summary.blends = sampler.blend_count();
    (void)trace.finish();  // its failure is in the summary
    return summary;
}

}  // namespace axg
