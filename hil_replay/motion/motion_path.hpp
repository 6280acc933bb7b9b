// SPDX-License-Identifier: Apache-2.0
// The path between two stops as pieces with bounded derivatives: lines, corner blends, arcs. Its
// parameter s is a length in which one degree of a rotary axis counts as one mm. Source:
// docs/theory/motion.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hil_replay/motion/motion_limits.hpp"

namespace axg {

struct MotionOptions {
    bool cap_rapids = true;  // the program cap applies to G0 too
    double blend_mm = 0.01;  // corner tolerance unless the program states its own
};

// Lengths are whole numbers of 2^-36 mm (15 fm), so that sums over hours are exact; 2^63 of them
// are 134 km.
inline constexpr double kPathUnitsPerMm = 0x1p36;
inline constexpr double kMmPerPathUnit = 0x1p-36;
inline constexpr double kRunMmMax = 1e8;

enum class PieceKind : std::uint8_t { line, blend, arc };

/// `move` indexes Program::moves; a blend joins it with the next one.
struct Piece {
    PieceKind kind = PieceKind::line;
    std::uint32_t move = 0;
    std::int64_t start = 0;   // path units from the start of the run
    std::int64_t length = 0;  // path units
    std::int64_t offset = 0;  // line, arc: start of the piece from the start of its move
    double speed = 0;         // mm of path per second: limits inside this piece
    double acceleration = 0;
    double rapid = 0;  // mm of path per second at which a first axis is at its largest speed
    // Upper bound of each axis' share of its largest speed, per mm of path per second.
    std::array<float, kAxesMax> share_per_mm{};
};

/// The path from one stop to the next.
struct Run {
    std::uint32_t first_move = 0, move_count = 0;
    std::int64_t length = 0;  // path units
    std::vector<Piece> pieces;
};

/// Builds the run that begins with moves[first], which must be a line or an arc.
void build_run(const Program& program, std::uint32_t first, const MotionLimits& limits,
               const MotionOptions& options, Run& run);

/// The program's line of a point of a piece; the second half of a blend belongs to the next move.
[[nodiscard]] std::uint32_t line_at(const Program& program, const Piece& piece, double along_mm);

/// The axis positions at the end of a move.
[[nodiscard]] AxisPositions axes_after(const Program& program, const Move& move);

/// The axis positions along one piece, prepared once on entering it.
class PieceCurve {
  public:
    void enter(const Program& program, const Piece& piece, const MotionLimits& limits);
    /// @param along_mm  0 to the piece's length
    void position(double along_mm, AxisPositions& out) const noexcept;
    /// The axes with their derivatives along the path.
    void derivatives(double along_mm, std::array<Jet, kAxesMax>& out) const noexcept;

  private:
    /// The commanded position: of the axes, or under tool centre point control of the tip.
    template <class Scalar>
    void commanded(const Scalar& along_mm, std::array<Scalar, kAxesMax>& out) const noexcept;

    PieceKind kind_ = PieceKind::line;
    std::uint32_t axis_count_ = 0;
    double half_mm_ = 0, offset_mm_ = 0, per_mm_ = 0;
    AxisPositions base_{}, tangent_{}, bend_{};
    Arc arc_;
    const TipControl* control_ = nullptr;
};

}  // namespace axg
