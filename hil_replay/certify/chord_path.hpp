// SPDX-License-Identifier: Apache-2.0
// A program's commanded path as chords between nodes in joint space, with the speeds on them: the
// path that a certificate is about. Positions are whole units, so that no sum of them is rounded.
// Source: docs/theory/program.md; docs/reference/certificate-file.md, "Path".
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/machine/machine.hpp"
#include "hil_replay/motion/motion_sampler.hpp"

namespace axg {

using AxisUnits = std::array<std::int64_t, kAxesMax>;

/// mm or rad of a unit.
[[nodiscard]] constexpr double unit_of(AxisKind kind) noexcept {
    return kind == AxisKind::linear ? 0x1p-16 : 0x1p-24;
}
/// The whole number of units at or above a length >= 0.
[[nodiscard]] std::int64_t units_up(double length, AxisKind kind) noexcept;

inline constexpr double kSpeedSteps = 255;  // a speed is stored in this part of the largest

struct PathRun {
    std::uint32_t tool = kNoIndex;  // Machine::tools
    std::uint64_t segments = 0;
    std::uint64_t first = 0, last = 0;  // of these, count for every tool
};

struct ChordPath {
    std::uint32_t axis_count = 0;
    AxisUnits delta{};                 // a command is at most this far from its chord
    AxisUnits following{};             // and an axis from its command
    std::vector<std::int64_t> nodes;   // [segments + 1][axes]
    std::vector<std::uint32_t> lines;  // [segments] of the program
    std::vector<std::uint8_t> speeds;  // [segments][axes][up, down]; independent stops only
    std::vector<PathRun> runs;
    std::vector<std::uint64_t> ends;  // [segments] in kMotionStepS; not part of a certificate
    double seconds = 0;               // of the program

    [[nodiscard]] std::uint64_t segment_count() const noexcept { return lines.size(); }
    [[nodiscard]] std::int64_t node(std::uint64_t i, std::uint32_t axis) const noexcept {
        return nodes[i * axis_count + axis];
    }
};

struct ChordOptions {
    double delta_mm = 0.01, delta_rad = 0.001 * kPi / 180;
};

/// Makes a path of samples that are kMotionStepS apart.
class PathThinner {
  public:
    /// `machine` must outlive it.
    PathThinner(const Machine& machine, const ChordOptions& options);

    /// @param tool  Machine::tools; kNoIndex: none
    void add(const MotionSample& sample, std::uint32_t tool);
    [[nodiscard]] ChordPath finish();

  private:
    struct Timed {
        std::uint64_t index = 0;
        AxisPositions position{};
    };
    /// Speeds within a segment, without those after it.
    struct OwnSpeeds {
        std::array<std::uint8_t, kAxesMax> up{}, down{};
    };
    void end_chunk();
    void add_segment(const Timed& from, const Timed& to);
    void note_speeds(const AxisPositions& from, const AxisPositions& to);
    [[nodiscard]] std::size_t worst_between(std::size_t from, std::size_t to) const;
    void widen_speeds();
    void share_tools();

    const Machine& machine_;
    std::array<double, kAxesMax> tolerance_{};
    ChordPath path_;
    std::vector<Timed> chunk_;            // from the last node on
    std::vector<OwnSpeeds> steps_;        // [chunk_] of the step that ends there
    std::vector<OwnSpeeds> own_;          // [segments]
    std::vector<std::uint64_t> begin_;    // [segments] steps of the motion
    std::vector<std::uint64_t> changes_;  // steps at which the tool changed
    std::uint32_t line_ = 0, tool_ = kNoIndex;
    AxisPositions last_{};
    std::uint64_t chunk_steps_max_ = 0;
    bool has_begun_ = false, needs_speeds_ = false;
};

/// The path of a program. Empty nodes: nothing moves, or a tool has no slot (`unknown_tool`).
/// @param progress  now and then; may be empty
struct PlannedPath {
    ChordPath path;
    std::uint32_t unknown_tool = 0, unknown_line = 0;  // 0: none
};
[[nodiscard]] PlannedPath plan_chord_path(
    const Machine& machine, const Program& program, const MotionOptions& motion,
    const ChordOptions& options,
    const std::function<void(double program_s, std::uint32_t line)>& progress);

}  // namespace axg
