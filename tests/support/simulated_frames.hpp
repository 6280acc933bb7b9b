// SPDX-License-Identifier: Apache-2.0
// The frames of a program, as a simulated trace has them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {

/// What a motion board sends while it runs the program.
inline std::vector<CanFrame> simulated_frames(const Machine& machine, const std::string& program) {
    const Workshop shop;
    GcodeOptions options;
    options.start = default_start(machine);
    const GcodeResult reading = read_gcode(content_of(program), machine, options);
    EXPECT_TRUE(reading.faults.empty());
    EXPECT_EQ(simulate_trace(machine, reading.program, {}, shop.file("t.log")).error, "");
    return read_trace(shop.file("t.log"));
}

}  // namespace axg::test
