// SPDX-License-Identifier: Apache-2.0
// Tool centre point control on machines of three types: in random programs the tip, placed by
// kinematics written here, stays on the programmed line in the part's frame, every axis keeps its
// limits on the 0.1 ms grid, and each block ends where it says. AXG_COUNT: programs of each
// machine.
// ctest-labels: long
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "config/compiled/compiled_machine.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using test::Dice;

constexpr double kTipErrorMmMax = 1e-3;
constexpr double kLimitSlack = 1e-3;  // of the limit: differences on a grid against derivatives
constexpr double kDegree = kPi / 180;
constexpr int kProgramsFull = 20;
#ifdef NDEBUG
constexpr int kProgramsUsual = kProgramsFull;
#else
constexpr int kProgramsUsual = 3;  // unoptimised, ten times as slow
#endif

int programs() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? kProgramsUsual : std::max(1, std::atoi(text));
}

/// The drawing of a machine: where the tip is in the part's frame, which is the machine's when all
/// axes are at zero. X Y Z and the two rotary axes are in the order of the file.
struct Drawing {
    const char* file;
    double tool_mm;
    std::function<Vector3d(const AxisPositions& q, double tool_mm)> tip_in_part;
};

Vector3d turned(const Vector3d& p, double angle, const Vector3d& axis, const Vector3d& pivot) {
    return pivot + AngleAxisd(angle, axis) * (p - pivot);
}

/// A over C on a table: what the table carries goes against the command, so the tip in the part's
/// frame goes with it.
Vector3d in_trunnion(const AxisPositions& q, double tool_mm, double pivot_z_mm) {
    const Vector3d pivot(0, 0, pivot_z_mm);
    const Vector3d tip(q[0], q[1], q[2] - tool_mm);
    return turned(turned(tip, q[3], Vector3d::UnitX(), pivot), q[4], Vector3d::UnitZ(), pivot);
}

const std::vector<Drawing>& drawings() {
    static const std::vector<Drawing> all = {
        {"paper-trunnion", 140,
         [](const AxisPositions& q, double tool_mm) { return in_trunnion(q, tool_mm, -380); }},
        {"probe-basic-xyzac", 100,
         [](const AxisPositions& q, double tool_mm) { return in_trunnion(q, tool_mm, -457.2); }},
        {"spindle-tilting", 120,
         [](const AxisPositions& q, double tool_mm) {  // B, C; the nose 200 mm below both
             const Vector3d b =
                 AngleAxisd(q[3], Vector3d::UnitY()) * Vector3d(0, 0, -200 - tool_mm);
             return Vector3d(Vector3d(q[0], q[1], q[2]) + AngleAxisd(q[4], Vector3d::UnitZ()) * b);
         }},
        {"table-spindle-tilting", 90,
         [](const AxisPositions& q, double tool_mm) {  // B in the head, C in the table
             const Vector3d tip = Vector3d(q[0], q[1], q[2]) + AngleAxisd(q[3], Vector3d::UnitY()) *
                                                                   Vector3d(0, 0, -200 - tool_mm);
             return Vector3d(AngleAxisd(q[4], Vector3d::UnitZ()) * tip);
         }},
    };
    return all;
}

/// What a program calls this place, with G43 on: the tip from where the nose is at zero.
Vector3d programmed(const Drawing& drawing, const AxisPositions& q) {
    return drawing.tip_in_part(q, drawing.tool_mm) - drawing.tip_in_part({}, 0);
}

struct Line {
    Vector3d from, to;
    std::uint32_t number;
};

struct RandomProgram {
    std::string text;
    std::vector<Line> lines;
    std::uint32_t count = 0;  // lines of the text

    void add(const std::string& line) {
        text += line + "\n";
        ++count;
    }
};

/// Walks from one random position of the axes to another, short steps and long ones: every end can
/// be reached. Between them X, Y and Z follow curves, which may leave the travel.
RandomProgram random_program(const Machine& machine, const Drawing& drawing, bool is_exact,
                             Dice& dice) {
    RandomProgram out;
    const char* const on[] = {"G43.4", "G43\nM428", "M428 G43"};
    const std::string start = on[static_cast<int>(dice.in(0, 3))];
    out.count += start.find('\n') != std::string::npos ? 1 : 0;
    out.add(start);
    out.add(is_exact ? "G61" : "G64 P0.02");
    AxisPositions q = default_start(machine);
    Vector3d at = programmed(drawing, q);
    for (int block = 0; block < 14; ++block) {
        const double reach = dice.magnitude(0.002, 0.5);  // of the travel
        for (std::size_t i = 0; i < 5; ++i) {
            const Axis& axis = machine.axes[i];
            const double low = axis.unlimited ? -7 : 0.8 * axis.min;
            const double high = axis.unlimited ? 7 : 0.8 * axis.max;
            const double wish = q[i] + reach * dice.in(-0.5, 0.5) * (high - low);
            q[i] = i >= 3 && dice.chance(0.2) ? q[i] : std::clamp(wish, low, high);
        }
        const Vector3d to = programmed(drawing, q);
        char words[256];
        std::snprintf(words, sizeof words, "X%.9f Y%.9f Z%.9f %s%.9f %s%.9f", to.x(), to.y(),
                      to.z(), machine.axes[3].name.c_str(), q[3] / kDegree,
                      machine.axes[4].name.c_str(), q[4] / kDegree);
        const double kind = dice.in(0, 3);
        char feed[64];
        std::snprintf(feed, sizeof feed,
                      kind < 1   ? "G0 "
                      : kind < 2 ? "G94 G1 F%.3f "
                                 : "G93 G1 F%.3f ",
                      kind < 2 ? dice.magnitude(200, 20000) : dice.magnitude(5, 200));
        out.add(std::string(feed) + words);
        out.lines.push_back({at, to, out.count});
        at = to;
    }
    out.add("M2");
    return out;
}

double distance(const Vector3d& p, const Line& line) {
    const Vector3d way = line.to - line.from;
    const double square = way.squaredNorm();
    const double share = square > 0 ? std::clamp((p - line.from).dot(way) / square, 0.0, 1.0) : 0.0;
    return (p - line.from - share * way).norm();
}

/// From the nearest of the sample's own line and its neighbours, between which corners are rounded.
double off_the_path(const RandomProgram& program, std::uint32_t line, const Vector3d& tip) {
    double least = HUGE_VAL;
    for (const Line& one : program.lines) {
        const bool is_near = one.number + 1 >= line && one.number <= line + 1;
        least = is_near ? std::min(least, distance(tip, one)) : least;
    }
    return least;
}

struct Seen {
    double worst_mm = 0;
    std::uint64_t samples = 0, refused = 0, blends = 0, turning = 0;
    double share = 0;  // of a limit, the most of any
};

void follow_tip(const Machine& machine, const Drawing& drawing, const RandomProgram& program,
                const Program& moves, double tolerance_mm, Seen& seen) {
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    MotionSampler sampler(moves, limits, motion);
    LimitMeter meter(limits.axis_count);
    MotionSample sample;
    AxisPositions last{};
    while (sampler.next(sample)) {
        meter.add(sample.position);
        const double off = off_the_path(program, sample.line, programmed(drawing, sample.position));
        if (sample.line > program.lines.front().number) {
            seen.worst_mm = std::max(seen.worst_mm, off - tolerance_mm);
        }
        seen.turning += sample.position[3] != last[3] || sample.position[4] != last[4];
        last = sample.position;
        ++seen.samples;
    }
    seen.blends += sampler.blend_count();
    EXPECT_LE((programmed(drawing, sample.position) - program.lines.back().to).norm(), 1e-6);
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const LimitMeter::Peak& peak = meter.peak(i);
        const double rounding = 1000 * 0x1p-50;  // of one position, after a dozen operations
        EXPECT_LE(peak.speed, limits.speed[i] * (1 + kLimitSlack) + 2 * rounding / 1e-4)
            << machine.axes[i].name;
        EXPECT_LE(peak.acceleration,
                  limits.acceleration[i] * (1 + kLimitSlack) + 4 * rounding / 1e-8)
            << machine.axes[i].name;
        EXPECT_LE(peak.jerk, limits.jerk[i] * (1 + kLimitSlack) + 8 * rounding / 1e-12)
            << machine.axes[i].name;
        seen.share =
            std::max({seen.share, peak.speed / limits.speed[i],
                      peak.acceleration / limits.acceleration[i], peak.jerk / limits.jerk[i]});
    }
}

class TipControlOn : public testing::TestWithParam<std::size_t> {};

TEST_P(TipControlOn, RandomProgramsKeepTheTipOnItsLine) {
    const Drawing& drawing = drawings()[GetParam()];
    const std::uint64_t seed = test::printed_seed(20261121);
    Machine machine;
    const auto faults = load_machine(
        std::string(AXG_SOURCE_DIR) + "/config/machines/" + drawing.file + ".yaml", machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    machine.first_tool = machine.tools[0].number;
    ASSERT_EQ(machine.tools[0].length_mm, drawing.tool_mm);
    Seen seen;
    for (int round = 0; round < programs() && !testing::Test::HasFailure(); ++round) {
        Dice dice(seed + static_cast<std::uint64_t>(round));
        const bool is_exact = dice.chance(0.5);
        const RandomProgram program = random_program(machine, drawing, is_exact, dice);
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(program.text, machine, options);
        for (const ProgramFault& fault : reading.faults) {
            ASSERT_NE(fault.message.find("out of travel"), std::string::npos)
                << fault.line << ": " << fault.word << ": " << fault.message << "\n"
                << program.text;
        }
        if (!reading.faults.empty()) {
            ++seen.refused;
            continue;
        }
        SCOPED_TRACE("round " + std::to_string(round) + "\n" + program.text);
        follow_tip(machine, drawing, program, reading.program, is_exact ? 0 : 0.02, seen);
    }
    std::printf(
        "%s: %llu samples, %llu of them turning, %llu corners blended, %llu of %d programs "
        "leave the travel, tip off by %.3g um, %.1f %% of a limit\n",
        drawing.file, static_cast<unsigned long long>(seen.samples),
        static_cast<unsigned long long>(seen.turning), static_cast<unsigned long long>(seen.blends),
        static_cast<unsigned long long>(seen.refused), programs(), 1e3 * seen.worst_mm,
        100 * seen.share);
    EXPECT_LE(seen.worst_mm, kTipErrorMmMax);
    if (programs() >= kProgramsFull) {
        EXPECT_GT(seen.turning, seen.samples / 4) << "too weak to tell anything";
        EXPECT_LT(seen.refused, static_cast<std::uint64_t>(programs()) * 3 / 4)
            << "too weak to tell anything";
        EXPECT_GT(seen.share, 0.85) << "no limit was ever met: too slow";
    }
}

INSTANTIATE_TEST_SUITE_P(Machines, TipControlOn, testing::Range<std::size_t>(0, 4));

}  // namespace
}  // namespace axg
