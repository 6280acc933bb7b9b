// SPDX-License-Identifier: Apache-2.0
// Programs of a line or two on the machine for motion tests, and what comes of them. mm and rad.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {

enum : std::size_t { kX, kY, kZ, kA, kC };

inline GcodeResult read(std::string_view text, GcodeOptions options = {}) {
    return read_gcode(text, motion_test_machine(), options);
}

inline std::string faults_of(const GcodeResult& result) {
    std::string text;
    for (const ProgramFault& fault : result.faults) {
        text += std::to_string(fault.line) + ": " + fault.word + ": " + fault.message + "\n";
    }
    return text;
}

/// The only fault, as "LINE: WORD: MESSAGE".
inline std::string fault_of(std::string_view text, GcodeOptions options = {}) {
    const GcodeResult result = read(text, options);
    EXPECT_EQ(result.faults.size(), 1U) << faults_of(result);
    return faults_of(result);
}

inline Program program_of(std::string_view text, GcodeOptions options = {}) {
    GcodeResult result = read(text, options);
    EXPECT_EQ(faults_of(result), "") << text;
    return result.program;
}

inline AxisPositions end_of(std::string_view text, GcodeOptions options = {}) {
    const Program program = program_of(text, options);
    EXPECT_FALSE(program.moves.empty()) << text;
    return program.moves.empty() ? AxisPositions{} : program.moves.back().target;
}

}  // namespace axg::test
