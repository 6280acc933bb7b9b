// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data long
// Which words stop the real programs, line by line: the table of docs/reference/gcode.md, held to
// the reader. The programs that carry are then moved, and must keep every limit.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

/// Wide enough for every program; whatever tool a program names is tool 1.
Machine wide_machine() {
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        axis.min *= 4;
        axis.max *= 4;
    }
    return machine;
}

GcodeOptions options_for_all() {
    GcodeOptions options;
    options.faults_max = 100000;
    for (const unsigned number : {3U, 8U, 21U, 48U, 52U, 150U}) {
        options.tools.emplace_back(static_cast<std::uint16_t>(number), std::uint16_t{1});
    }
    return options;
}

struct Expected {
    const char* file;
    std::uint32_t lines;
    std::map<std::string, std::vector<std::uint32_t>> words;  // count and first line of each
};

const std::vector<Expected>& expected() {
    static const std::vector<Expected> table = {
        {"boat-xyzac.ngc", 1880, {}},
        {"cds.ngc", 282, {}},
        {"duplicate_tool_test_gcode.ngc", 749, {}},
        {"helix_ac.ngc", 22, {}},  // a subroutine that nothing calls
        {"impeller-7bl-xyzac.ngc", 4510, {}},
        {"impeller_xyzac.ngc", 20330, {}},
        {"xyz_box_inscribed_face_circles_test.ngc", 98, {}},
        {"xyzac_switchkins_test_1.ngc", 39, {}},
        {"xyzac_switchkins_test_2.ngc", 49, {}},
        {"xyzac_switchkins_test_3.ngc", 15, {}},
    };
    return table;
}

std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

class RealPrograms : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::is_directory(folder)) {
            GTEST_SKIP() << folder << " is not there: the real programs are not part of this "
                         << "repository";
        }
    }
    const std::string folder = std::string(AXG_SHARED_DATA) + "/gcode";
};

TEST_F(RealPrograms, StopAtTheWordsOfTheTable) {
    for (const Expected& program : expected()) {
        const std::string text = text_of(folder + "/" + program.file);
        ASSERT_FALSE(text.empty()) << program.file;
        const GcodeResult result = read_gcode(text, wide_machine(), options_for_all());
        std::map<std::string, std::vector<std::uint32_t>> words;
        for (const ProgramFault& fault : result.faults) {
            auto& [entry_word, entry] = *words.try_emplace(fault.word, 2, 0U).first;
            entry[1] = entry[0]++ == 0 ? fault.line : entry[1];
        }
        EXPECT_EQ(words, program.words) << program.file;
        EXPECT_EQ(result.line_count, program.lines) << program.file;
    }
}

TEST_F(RealPrograms, KeepEveryLimitWhereTheyCarry) {
    std::size_t carried = 0;
    for (const Expected& program : expected()) {
        const Machine machine = wide_machine();
        const GcodeOptions options = options_for_all();
        const GcodeResult result =
            read_gcode(text_of(folder + "/" + program.file), machine, options);
        if (!result.faults.empty() || result.program.moves.empty()) {
            continue;
        }
        ++carried;
        const MotionLimits limits = make_motion_limits(machine);
        const MotionOptions motion;
        MotionSampler sampler(result.program, limits, motion);
        LimitMeter meter(limits.axis_count);
        MotionSample sample;
        while (sampler.next(sample)) {
            meter.add(sample.position);
        }
        EXPECT_EQ(sample.position, axes_after(result.program, result.program.moves.back()))
            << program.file;
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            EXPECT_LE(meter.peak(i).speed, limits.speed[i] * 1.001) << program.file << i;
            EXPECT_LE(meter.peak(i).acceleration, limits.acceleration[i] * 1.001)
                << program.file << i;
            EXPECT_LE(meter.peak(i).jerk, limits.jerk[i] * 1.001) << program.file << i;
        }
    }
    EXPECT_EQ(carried, 9U);
}

}  // namespace
}  // namespace axg
