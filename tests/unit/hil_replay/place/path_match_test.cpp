// SPDX-License-Identifier: Apache-2.0
// Positions of a motion whose lines are known, matched with the program's path: each instant has
// its line wherever the path is repeated, turns back, winds an endless axis or is left for a while.
#include "hil_replay/place/path_match.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/program_places.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kEvery = 10;  // steps of 0.1 ms

struct Sample {
    std::uint32_t line = 0;
    AxisPositions position{};
};

class PathMatchTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto faults = load_machine(
            std::string(AXG_SOURCE_DIR) + "/config/machines/paper-trunnion.yaml", machine_);
        ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
        start_ = default_start(machine_);
    }

    Program program_of(const std::string& text) {
        GcodeOptions options;
        options.start = start_;
        const GcodeResult read = read_gcode(text, machine_, options);
        EXPECT_TRUE(read.faults.empty()) << read.faults[0].line << ": " << read.faults[0].message;
        return read.program;
    }
    /// As a board sends them: an endless axis within one turn.
    std::vector<Sample> motion_of(const Program& program) {
        std::vector<Sample> out;
        for (const MotionSample& sample : test::path_of(program, machine_)) {
            if (sample.index % kEvery == 0) {
                out.push_back({sample.line, sample.position});
                for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
                    double& at = out.back().position[i];
                    at = machine_.axes[i].unlimited ? at - std::floor(at / kTurn) * kTurn : at;
                }
            }
        }
        return out;
    }
    /// Lines found, [samples].
    std::vector<std::uint32_t> match(const Program& program, const std::vector<Sample>& samples) {
        PathMatch match(make_program_path(program, machine_), machine_);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            match.add(static_cast<std::int64_t>(i),
                      {samples[i].position.data(), machine_.axes.size()});
        }
        const std::vector<PathMatch::Mark> marks = match.finish();
        matched_ = match.matched();
        is_repeated_ = match.is_repeated();
        std::vector<std::uint32_t> lines(samples.size(), 0);
        for (std::size_t k = 0; k < marks.size(); ++k) {
            const auto end = k + 1 < marks.size() ? static_cast<std::size_t>(marks[k + 1].time_us)
                                                  : lines.size();
            std::fill(lines.begin() + marks[k].time_us, lines.begin() + static_cast<long>(end),
                      marks[k].line);
        }
        return lines;
    }
    /// Share of the samples with another line than the motion's.
    static double wrong(const std::vector<Sample>& samples,
                        const std::vector<std::uint32_t>& lines) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            count += samples[i].line != lines[i] ? 1 : 0;
        }
        return static_cast<double>(count) / static_cast<double>(samples.size());
    }

    static constexpr double kTurn = 6.283185307179586;
    Machine machine_;
    AxisPositions start_{};
    std::uint64_t matched_ = 0;
    bool is_repeated_ = false;
};

const std::string kHead = "G21 G90 G94\n";  // lines of the blocks below begin at 2

/// Eight passes, this far apart.
std::string levels(double apart_mm) {
    std::string text = kHead;
    for (int level = 0; level < 8; ++level) {
        text += "G1 Z" + std::to_string(40 - level * apart_mm) + " F3000\nX40\nY30\nX0\nY0\n";
    }
    return text + "G0 Z50\nM2\n";
}

TEST_F(PathMatchTest, EveryInstantHasItsLine) {
    const Program program = program_of(kHead +
                                       "G0 X20 Y10 Z50\nG1 X40 F3000\nY30\nG2 X60 Y50 I20 J0\n"
                                       "G1 A-20 C30\nX0\nM2\n");
    const std::vector<Sample> samples = motion_of(program);
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
    EXPECT_EQ(matched_, samples.size());
}

TEST_F(PathMatchTest, APathThatTurnsBackHasTheLineOfItsDirection) {
    const Program program = program_of(kHead + "G1 X40 F3000\nX0\nX40\nX20\nM2\n");
    const std::vector<Sample> samples = motion_of(program);
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
}

TEST_F(PathMatchTest, AnEndlessAxisMayBeOfAnyTurn) {
    const Program program = program_of(kHead + "G1 C-400 F6000\nX30\nC800\nC-70 X10\nM2\n");
    const std::vector<Sample> samples = motion_of(program);
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
}

TEST_F(PathMatchTest, ARepeatedPathIsFollowedInOrder) {
    std::string text = kHead;
    for (int pass = 0; pass < 6; ++pass) {
        text += "G1 X40 F3000\nY20\nX0\nY0\n";
    }
    const Program program = program_of(text + "M2\n");
    const std::vector<Sample> samples = motion_of(program);
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
}

TEST_F(PathMatchTest, ATraceThatBeginsInTheMiddleIsFound) {
    const Program program = program_of(kHead + "G1 X40 F3000\nY20\nX0\nY40\nX40\nY60\nA-20\nM2\n");
    std::vector<Sample> samples = motion_of(program);
    samples.erase(samples.begin(), samples.begin() + static_cast<long>(samples.size() / 3));
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
}

// As a black box begins: levels a little apart, of which all are within reach of the search.
TEST_F(PathMatchTest, OfPassesCloseTogetherTheNearestIsFound) {
    for (const double apart : {0.9, 0.5, 0.3, 0.1}) {
        const Program program = program_of(levels(apart));
        std::vector<Sample> samples = motion_of(program);
        samples.erase(samples.begin(), samples.begin() + static_cast<long>(samples.size() / 2));
        EXPECT_LT(wrong(samples, match(program, samples)), 0.01) << apart;
        EXPECT_FALSE(is_repeated_) << apart;
    }
}

// Part of the trace is missing: the next sample is a level lower, far along a place without a
// doubt.
TEST_F(PathMatchTest, AfterAHoleANearerPassIsFound) {
    const Program program = program_of(levels(0.3));
    std::vector<Sample> samples = motion_of(program);
    const auto found = [&](std::uint32_t line) {  // 16 mm along its block
        return std::find_if(samples.begin(), samples.end(), [line](const Sample& one) {
            return one.line == line && one.position[0] > 16;
        });
    };
    samples.erase(found(18), found(28));  // two levels
    EXPECT_LT(wrong(samples, match(program, samples)), 0.03);
}

TEST_F(PathMatchTest, AfterAJogTheLevelIsFoundAgain) {
    const Program program = program_of(levels(0.5));
    std::vector<Sample> samples = motion_of(program);
    const auto at = static_cast<long>(samples.size() / 2);
    std::vector<Sample> jog(1200, samples[static_cast<std::size_t>(at)]);
    for (int k = 0; k < 1200; ++k) {  // up past the levels above, and down again
        jog[static_cast<std::size_t>(k)].position[2] += 0.02 * std::min(k, 1199 - k);
    }
    const std::size_t back = static_cast<std::size_t>(at) + jog.size() + 100;
    samples.insert(samples.begin() + at, jog.begin(), jog.end());
    const std::vector<std::uint32_t> lines = match(program, samples);
    std::size_t wrong_after = 0;
    for (std::size_t i = back; i < samples.size(); ++i) {
        wrong_after += lines[i] != samples[i].line ? 1 : 0;
    }
    EXPECT_LT(wrong_after, samples.size() / 100);
}

TEST_F(PathMatchTest, OfPassesThatAreAlikeTheFirstIsNamedAndItIsSaid) {
    std::string text = kHead;
    for (int pass = 0; pass < 6; ++pass) {
        text += "G1 X40 F3000\nY20\nX0\nY0\n";
    }
    const Program program = program_of(text + "M2\n");
    std::vector<Sample> samples = motion_of(program);
    EXPECT_LT(wrong(samples, match(program, samples)), 0.01);
    EXPECT_FALSE(is_repeated_) << "from the start there is no doubt";
    samples.erase(samples.begin(), samples.begin() + static_cast<long>(samples.size() / 2));
    EXPECT_LE(match(program, samples)[samples.size() / 20], 5U);
    EXPECT_TRUE(is_repeated_);
}

// A zigzag finer than the search reaches, with the noise of a drive.
TEST_F(PathMatchTest, NoiseDoesNotSkipAFinePath) {
    std::string text = kHead + "G1 Z40 F600\n";
    for (int k = 0; k < 60; ++k) {
        text += k % 2 == 0 ? "G1 X0.8\n" : "G1 X0\n";
        text += "G1 Y" + std::to_string(0.1 * (k + 1)) + "\n";
    }
    const Program program = program_of(text + "M2\n");
    std::vector<Sample> samples = motion_of(program);
    std::mt19937_64 random(test::printed_seed(32));
    std::normal_distribution<double> noise(0, 0.01);
    for (Sample& one : samples) {
        for (std::size_t i = 0; i < 3; ++i) {
            one.position[i] += noise(random);
        }
    }
    const std::vector<std::uint32_t> lines = match(program, samples);
    std::size_t far = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        far += lines[i] > samples[i].line + 1 || lines[i] + 1 < samples[i].line ? 1 : 0;
    }
    EXPECT_LT(far, samples.size() / 50);
}

TEST_F(PathMatchTest, BesideThePathThereIsNoLine) {
    const Program program = program_of(kHead + "G1 X40 F3000\nY40\nX0\nM2\n");
    std::vector<Sample> samples = motion_of(program);
    // Someone jogs away in the middle of line 3 and comes back.
    const auto at = static_cast<std::size_t>(
        std::find_if(samples.begin(), samples.end(),
                     [](const Sample& one) { return one.position[1] > 20; }) -
        samples.begin());
    std::vector<Sample> jog;
    for (int k = 0; k < 400; ++k) {
        Sample one = samples[at];
        one.position[2] -= 0.1 * std::min(k, 399 - k);
        one.line = one.position[2] < samples[at].position[2] - kMatchWithinMm ? 0 : one.line;
        jog.push_back(one);
    }
    samples.insert(samples.begin() + static_cast<long>(at), jog.begin(), jog.end());
    const std::vector<std::uint32_t> lines = match(program, samples);
    EXPECT_LT(wrong(samples, lines), 0.01);
    EXPECT_EQ(lines[at + 200], 0U);
    EXPECT_EQ(lines.back(), 4U);
    EXPECT_LT(matched_, samples.size() - 350);
}

TEST_F(PathMatchTest, ACrossingIsNoLine) {
    const Program program = program_of(kHead + "G1 X40 F3000\nM2\n");
    std::vector<Sample> samples;
    for (int k = 0; k < 1000; ++k) {  // across the path, and never along it
        samples.push_back({0, start_});
        samples.back().position[0] = 20;
        samples.back().position[1] = 0.1 * (k - 500);
    }
    EXPECT_EQ(wrong(samples, match(program, samples)), 0);
    EXPECT_EQ(matched_, 0U);
}

TEST_F(PathMatchTest, AnotherProgramMatchesNothing) {
    const std::vector<Sample> samples =
        motion_of(program_of(kHead + "G0 X20 Y-50 Z-20\nG1 X-40 F3000\nY-30\nM2\n"));
    const Program other = program_of(kHead + "G0 X20 Y50 Z20\nG1 X40 F3000\nY30\nM2\n");
    const std::vector<std::uint32_t> lines = match(other, samples);
    EXPECT_LT(static_cast<double>(matched_), 0.1 * static_cast<double>(samples.size()));
    EXPECT_EQ(lines.back(), 0U);
}

TEST_F(PathMatchTest, NoiseOfADriveChangesLittle) {
    const Program program = program_of(
        kHead + "G0 X20 Y10 Z50\nG1 X40 F3000\nY30\nG2 X60 Y50 I20 J0\nG1 A-20 C30\nX0\nM2\n");
    std::vector<Sample> samples = motion_of(program);
    std::mt19937_64 random(test::printed_seed(31));
    std::normal_distribution<double> noise(0, 0.01);
    for (Sample& one : samples) {
        for (std::size_t i = 0; i < 3; ++i) {
            one.position[i] += noise(random);
        }
    }
    EXPECT_LT(wrong(samples, match(program, samples)), 0.03);
}

}  // namespace
}  // namespace axg
