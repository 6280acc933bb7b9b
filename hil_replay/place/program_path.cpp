// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/place/program_path.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"
#include "hil_replay/motion/motion_limits.hpp"
#include "hil_replay/motion/motion_path.hpp"

namespace axg {
namespace {

constexpr double kChordMm = 0.5;
constexpr double kQuarterTurn = kPi / 2;

/// Adds a point, unless the path is not longer with it: then no axis moves.
void add_point(const AxisPositions& position, std::uint32_t line, const MotionLimits& limits,
               ProgramPath& path) {
    double sum = 0;
    const std::size_t before = path.coordinates.size();
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        path.coordinates.push_back(static_cast<float>(position[i] * limits.metric[i]));
        const double step = path.lines.empty()
                                ? 0
                                : double{path.coordinates[before + i]} -
                                      double{path.coordinates[before + i - limits.axis_count]};
        sum += step * step;
    }
    if (!path.lines.empty() && sum == 0) {
        path.coordinates.resize(before);
        return;
    }
    path.along_mm.push_back(path.lines.empty() ? 0 : path.along_mm.back() + std::sqrt(sum));
    path.lines.push_back(line);
}

/// Number of chords of a straight line of the axes.
double chords_of(const Move& move, const AxisPositions& from, const Machine& machine) {
    double chords = 1;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        if (machine.axes[i].unlimited) {
            chords = std::max(chords, std::ceil(std::abs(move.target[i] - from[i]) / kQuarterTurn));
        }
    }
    return chords;
}

/// A line of the axes is straight; an arc, a corner's blend and a line of the tip are curves.
void add_piece(const Program& program, const Piece& piece, const Machine& machine,
               const MotionLimits& limits, ProgramPath& path) {
    const Move& move = program.moves[piece.move];
    const double length_mm = static_cast<double>(piece.length) * kMmPerPathUnit;
    const bool is_straight = piece.kind == PieceKind::line && move.control == kNoIndex;
    const AxisPositions& from =
        piece.move == 0 ? program.start : program.moves[piece.move - 1].target;
    const double chords =
        is_straight ? chords_of(move, from, machine) : std::ceil(length_mm / kChordMm);
    PieceCurve curve;
    curve.enter(program, piece, limits);
    for (double k = 1; k <= chords && path.size() < kPathPointsMax; ++k) {
        AxisPositions position{};
        curve.position(length_mm * k / chords, position);
        add_point(position, line_at(program, piece, length_mm * (k - 0.5) / chords), limits, path);
    }
}

}  // namespace

ProgramPath make_program_path(const Program& program, const Machine& machine) {
    const MotionLimits limits = make_motion_limits(machine);
    ProgramPath path;
    path.axis_count = limits.axis_count;
    add_point(program.start, 0, limits, path);
    Run run;
    for (std::uint32_t move = 0; move < program.moves.size();) {
        const MoveKind kind = program.moves[move].kind;
        if (kind != MoveKind::line && kind != MoveKind::arc) {
            ++move;
            continue;
        }
        build_run(program, move, limits, {.cap_rapids = false, .blend_mm = 0}, run);
        for (const Piece& piece : run.pieces) {
            add_piece(program, piece, machine, limits, path);
        }
        move += run.move_count;
        if (path.size() >= kPathPointsMax) {
            return {};
        }
    }
    return path;
}

}  // namespace axg
