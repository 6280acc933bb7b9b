// SPDX-License-Identifier: Apache-2.0
// Any bytes as a program: read to faults or to moves inside travel, and what is read moves within
// the limits of its axes.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/motion_machine.hpp"

int axg::fuzz::gcode(const std::uint8_t* data, std::size_t size) {
    static const axg::Machine machine = axg::motion_test_machine();
    static const axg::MotionLimits limits = axg::make_motion_limits(machine);
    constexpr std::uint64_t kStepsMax = 20000;
    axg::GcodeOptions options;
    options.block_delete = axg::BlockDelete::run;
    options.steps_max = 2000;  // of a loop without an end
    const axg::GcodeResult result =
        axg::read_gcode({reinterpret_cast<const char*>(data), size}, machine, options);
    if (!result.faults.empty() || result.program.moves.size() > 200) {
        return 0;
    }
    const axg::MotionOptions motion;
    axg::MotionSampler sampler(result.program, limits, motion);
    axg::MotionSample sample, before;
    bool has_before = false;
    while (sampler.next(sample) && sample.index < kStepsMax) {
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            const double step = std::abs(sample.position[i] - before.position[i]);
            if (has_before && !(step <= limits.speed[i] * axg::kMotionStepS * 1.001 + 1e-11)) {
                std::abort();  // a jump, or not a number
            }
        }
        before = sample;
        has_before = true;
    }
    return 0;
}
