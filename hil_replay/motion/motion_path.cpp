// SPDX-License-Identifier: Apache-2.0
// Rounds a corner by averaging its tangent with the kernel K(x) = 15/16 (1 - x^2)^2 over [-d, d]:
// position, speed, acceleration and jerk remain continuous, the tangent remains between the two,
// and the path misses the corner point by 5/32 d |t_out - t_in|. Derivation and bounds:
// docs/theory/motion.md.
#include "hil_replay/motion/motion_path.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kBlendDepth = 5.0 / 32.0;
constexpr double kKernelMax =
    15.0 / 16.0;  // times 1/d: second derivative for a unit tangent change
constexpr double kKernelSlopeMax =
    1.4433756729740645;                 // 15/16 * 4 x (1 - x^2) at x = 1/sqrt(3); times 1/d^2
constexpr double kTangentTiny = 1e-10;  // a flatter corner is none: 17 mm/s3 of jerk at 10 m/min
constexpr double kFloatUp = 1 + 1e-6;   // the product is no less after rounding to float
constexpr double kCurveMargin = 0.999;  // differences on the grid exceed derivatives by less

// Under tool centre point control the axes' derivatives vary along a line and are sampled: the most
// degrees of turning per piece, samples per piece, and a factor on the largest sample.
constexpr double kTurnDegMax = 4;
constexpr int kLineSamples = 5;    // one per degree: the error at the top of a sine is 4e-5 of it
constexpr int kBlendSamples = 17;  // the error at the kernel's steepest place is 1 %
constexpr double kLineSlack = 1.002, kBlendSlack = 1.02;

/// Largest |dq/ds|, |d2q/ds2|, |d3q/ds3| of each axis inside a piece.
struct Bounds {
    AxisPositions first{}, second{}, third{};
    bool is_curved = false;
};

const AxisPositions& start_of(const Program& program, std::uint32_t move) {
    return move == 0 ? program.start : program.moves[move - 1].target;
}

bool is_path(const Move& move) {
    return move.kind == MoveKind::line || move.kind == MoveKind::arc;
}

bool is_in_plane(const Move& move, std::uint32_t axis) {
    return move.kind == MoveKind::arc && (axis == move.arc.first || axis == move.arc.second);
}

double arc_length_mm(const Arc& arc) {
    // A spiral's radius changes only by the dialect's tolerance: the mean radius gives the length.
    return std::abs(arc.sweep_rad) * (arc.radius_start_mm + arc.radius_end_mm) / 2.0;
}

double metric_length(const Program& program, std::uint32_t index, const MotionLimits& limits) {
    const Move& move = program.moves[index];
    const AxisPositions& from = start_of(program, index);
    double sum = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const double part =
            is_in_plane(move, i) ? 0.0 : (move.target[i] - from[i]) * limits.metric[i];
        sum += part * part;
    }
    if (move.kind == MoveKind::arc) {
        const double length = arc_length_mm(move.arc);
        sum += length * length;
    }
    return std::sqrt(sum);
}

std::int64_t length_units(const Program& program, std::uint32_t index, const MotionLimits& limits) {
    return std::max<std::int64_t>(
        1, std::llround(metric_length(program, index, limits) * kPathUnitsPerMm));
}

/// Lengths of the move along each group. F counts along X Y Z if they move, else along U V W, else
/// along the rotary axes in degrees. [group]
std::array<double, 3> group_lengths(const Program& program, std::uint32_t index,
                                    const MotionLimits& limits) {
    const Move& move = program.moves[index];
    const AxisPositions& from = start_of(program, index);
    std::array<double, 3> sums{};
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        if (!is_in_plane(move, i)) {
            const double part = (move.target[i] - from[i]) * limits.metric[i];
            sums[limits.feed_group[i]] += part * part;
        }
    }
    if (move.kind == MoveKind::arc) {
        const double length = arc_length_mm(move.arc);
        sums[0] += length * length;
    }
    return {std::sqrt(sums[0]), std::sqrt(sums[1]), std::sqrt(sums[2])};
}

/// The lower of the programmed speed and the cap, mm of path per second.
double feed_speed(const Program& program, std::uint32_t index, const MotionLimits& limits,
                  const MotionOptions& options, double length_mm) {
    const Move& move = program.moves[index];
    const std::array<double, 3> groups = group_lengths(program, index, limits);
    double speed = HUGE_VAL;
    if (move.feed_kind == FeedKind::inverse) {
        speed = length_mm * move.feed / 60.0;
    } else if (move.feed_kind == FeedKind::per_minute) {
        const double counted = groups[0] > 0 ? groups[0] : (groups[1] > 0 ? groups[1] : groups[2]);
        speed = counted > 0 ? move.feed / 60.0 * length_mm / counted : HUGE_VAL;
    }
    const bool is_capped = move.feed_kind != FeedKind::rapid || options.cap_rapids;
    if (is_capped && groups[0] > 0) {
        speed = std::min(speed, limits.cap_mm_s * length_mm / groups[0]);
    }
    return speed;
}

struct SpeedPair {
    double speed = 0, acceleration = 0, rapid = 0;
    std::array<float, kAxesMax> share_per_mm{};
};

/// The largest path speed at a given path acceleration: for each axis
/// q2 v^2 + q1 a <= acceleration and q3 v^3 + 3 q2 v a + q1 j <= jerk, with j = 2 a / smooth_s.
double curved_speed(const Bounds& bounds, const MotionLimits& limits, double acceleration,
                    double speed_max) {
    const double path_jerk = 2.0 * acceleration / limits.smooth_s;
    const auto holds = [&](double v) {
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            if (bounds.second[i] * v * v + bounds.first[i] * acceleration >
                    limits.acceleration[i] ||
                bounds.third[i] * v * v * v + 3 * bounds.second[i] * v * acceleration +
                        bounds.first[i] * path_jerk >
                    limits.jerk[i]) {
                return false;
            }
        }
        return true;
    };
    if (holds(speed_max)) {
        return speed_max;
    }
    double low = 0, high = speed_max;
    for (int step = 0; step < 40; ++step) {
        const double middle = (low + high) / 2;
        (holds(middle) ? low : high) = middle;
    }
    return low * kCurveMargin;
}

SpeedPair limit_piece(const Bounds& bounds, const MotionLimits& limits, double feed) {
    double rapid = HUGE_VAL, acceleration = HUGE_VAL;
    std::array<float, kAxesMax> shares{};
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        if (bounds.first[i] > 0) {
            rapid = std::min(rapid, limits.speed[i] / bounds.first[i]);
            acceleration = std::min(acceleration, limits.planned_acceleration[i] / bounds.first[i]);
            shares[i] = static_cast<float>(kFloatUp * bounds.first[i] / limits.speed[i]);
        }
    }
    const double speed = std::min(feed, rapid);
    if (!bounds.is_curved) {
        return {speed, acceleration, rapid, shares};
    }
    // The curve needs acceleration that is then not available to change speed. Tries a few shares
    // and selects the fastest.
    SpeedPair best{0, 0, rapid, shares};
    for (const double share : {0.9, 0.75, 0.6, 0.45, 0.3, 0.15}) {
        const double reached = curved_speed(bounds, limits, share * acceleration, speed);
        if (reached > best.speed * 1.001) {
            best = {reached, share * acceleration, rapid, shares};
        }
    }
    return best;
}

void line_tangent(const Program& program, std::uint32_t index, const MotionLimits& limits,
                  double length_mm, AxisPositions& out) {
    const AxisPositions& from = start_of(program, index);
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        out[i] = (program.moves[index].target[i] - from[i]) / length_mm;
    }
}

Bounds line_bounds(const Program& program, std::uint32_t index, const MotionLimits& limits,
                   double length_mm) {
    Bounds bounds;
    line_tangent(program, index, limits, length_mm, bounds.first);
    for (double& value : bounds.first) {
        value = std::abs(value);
    }
    return bounds;
}

Bounds arc_bounds(const Program& program, std::uint32_t index, const MotionLimits& limits,
                  double length_mm) {
    Bounds bounds = line_bounds(program, index, limits, length_mm);
    const Arc& arc = program.moves[index].arc;
    const double turn = std::abs(arc.sweep_rad) / length_mm;  // rad of angle per mm of path
    const double radius = std::max(arc.radius_start_mm, arc.radius_end_mm);
    const double spiral = std::abs(arc.radius_end_mm - arc.radius_start_mm) / length_mm;
    for (const std::uint32_t axis : {arc.first, arc.second}) {
        bounds.first[axis] = radius * turn + spiral;
        bounds.second[axis] = (radius * turn + 2 * spiral) * turn;
        bounds.third[axis] = (radius * turn + 3 * spiral) * turn * turn;
    }
    bounds.is_curved = true;
    return bounds;
}

/// Sum of the turns of the rotary axes along a move, and of the sweep of an arc, degrees.
double turning_deg(const Program& program, std::uint32_t index, const MotionLimits& limits) {
    const Move& move = program.moves[index];
    const AxisPositions& from = start_of(program, index);
    double turning = move.kind == MoveKind::arc ? std::abs(move.arc.sweep_rad) * 180 / kPi : 0.0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        if (limits.feed_group[i] == 2) {
            turning += std::abs(move.target[i] - from[i]) * limits.metric[i];
        }
    }
    return turning;
}

/// The bounds of a piece from samples, because only derivatives at single places can be computed.
Bounds sampled_bounds(const Program& program, const Piece& piece, const MotionLimits& limits,
                      int samples) {
    PieceCurve curve;
    curve.enter(program, piece, limits);
    const double length_mm = static_cast<double>(piece.length) * kMmPerPathUnit;
    const bool is_blend = piece.kind == PieceKind::blend;
    const double slack = is_blend ? kBlendSlack : kLineSlack;
    Bounds bounds;
    bounds.is_curved = is_blend || turning_deg(program, piece.move, limits) > 0;
    std::array<Jet, kAxesMax> axes;
    for (int k = 0; k < samples; ++k) {
        curve.derivatives(length_mm * k / (samples - 1), axes);
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            const auto widen = [slack](double& bound, double value) {
                bound = std::max(bound, slack * std::abs(value));
            };
            widen(bounds.first[i], axes[i].d[1]);
            if (bounds.is_curved) {
                widen(bounds.second[i], axes[i].d[2]);
                widen(bounds.third[i], axes[i].d[3]);
            }
        }
    }
    return bounds;
}

struct Corner {
    bool passes = false;  // the path does not stop here
    double half_mm = 0;   // half length of the blend; 0: straight on
    SpeedPair limit{};    // of the blend
};

struct Leg {
    double length_mm = 0, feed = 0;
    SpeedPair limit{};
    AxisPositions tangent{};
};

Leg make_leg(const Program& program, std::uint32_t index, const MotionLimits& limits,
             const MotionOptions& options) {
    Leg leg;
    leg.length_mm = static_cast<double>(length_units(program, index, limits)) * kMmPerPathUnit;
    leg.feed = feed_speed(program, index, limits, options, leg.length_mm);
    const bool is_arc = program.moves[index].kind == MoveKind::arc;
    Bounds bounds;
    if (program.moves[index].control != kNoIndex) {
        const Piece whole{.kind = is_arc ? PieceKind::arc : PieceKind::line,
                          .move = index,
                          .length = length_units(program, index, limits)};
        bounds = sampled_bounds(program, whole, limits, kLineSamples);
    } else {
        bounds = is_arc ? arc_bounds(program, index, limits, leg.length_mm)
                        : line_bounds(program, index, limits, leg.length_mm);
    }
    leg.limit = limit_piece(bounds, limits, leg.feed);
    line_tangent(program, index, limits, leg.length_mm, leg.tangent);
    return leg;
}

/// Whether a blend costs less time than a stop, which costs the smoothing time, braking and
/// acceleration.
bool is_worth_blending(const Corner& corner, const Leg& in, const Leg& out, double smooth_s) {
    const double around = std::min(in.limit.speed, out.limit.speed);
    const double acceleration = std::min(in.limit.acceleration, out.limit.acceleration);
    const double within_reach = std::sqrt(
        acceleration * std::min(in.length_mm, out.length_mm));  // short legs are never fast
    const double speed = std::max(std::min(around, within_reach), 1e-9);
    const double slow = std::min(corner.limit.speed, speed);
    const double slow_mm = 2 * (corner.half_mm + slow * smooth_s);
    const double blend_s =
        slow_mm * (1 / slow - 1 / speed) + (speed - slow) * (speed - slow) / (acceleration * speed);
    return blend_s <= smooth_s + speed / acceleration;
}

Corner make_corner(const Program& program, std::uint32_t index, const Leg& in, const Leg& out,
                   const MotionLimits& limits, const MotionOptions& options) {
    Corner corner;
    const Move& move = program.moves[index];
    if (move.is_exact || move.kind != MoveKind::line ||
        program.moves[index + 1].kind != MoveKind::line) {
        return corner;
    }
    Bounds bounds;
    double change = 0, change_square = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const double bend = std::abs(out.tangent[i] - in.tangent[i]);
        bounds.first[i] = std::max(std::abs(in.tangent[i]), std::abs(out.tangent[i]));
        bounds.second[i] = bend;
        change = std::max(change, bend * limits.metric[i]);
        change_square += bend * bend * limits.metric[i] * limits.metric[i];
    }
    if (change <= kTangentTiny) {
        corner.passes = true;
        return corner;
    }
    const double tolerance = move.blend_mm >= 0 ? move.blend_mm : options.blend_mm;
    corner.half_mm = std::min({in.length_mm / 2, out.length_mm / 2,
                               tolerance / (kBlendDepth * std::sqrt(change_square))});
    corner.half_mm = std::floor(corner.half_mm * kPathUnitsPerMm) * kMmPerPathUnit;
    if (!(corner.half_mm > 64 * kMmPerPathUnit)) {
        return corner;
    }
    if (move.control != kNoIndex) {
        const Piece blend{
            .kind = PieceKind::blend,
            .move = index,
            .length = 2 * static_cast<std::int64_t>(corner.half_mm * kPathUnitsPerMm)};
        const double turning =
            2 * corner.half_mm / in.length_mm * turning_deg(program, index, limits) +
            2 * corner.half_mm / out.length_mm * turning_deg(program, index + 1, limits);
        bounds =
            sampled_bounds(program, blend, limits, kBlendSamples + static_cast<int>(2 * turning));
    } else {
        for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
            bounds.third[i] =
                bounds.second[i] * kKernelSlopeMax / (corner.half_mm * corner.half_mm);
            bounds.second[i] *= kKernelMax / corner.half_mm;
        }
        bounds.is_curved = true;
    }
    corner.limit = limit_piece(bounds, limits, std::min(in.feed, out.feed));
    corner.passes = is_worth_blending(corner, in, out, limits.smooth_s);
    return corner;
}

void add_piece(Run& run, PieceKind kind, std::uint32_t move, std::int64_t offset,
               std::int64_t length, const SpeedPair& limit) {
    if (length > 0) {
        run.pieces.push_back({.kind = kind,
                              .move = move,
                              .start = run.length,
                              .length = length,
                              .offset = offset,
                              .speed = limit.speed,
                              .acceleration = limit.acceleration,
                              .rapid = limit.rapid,
                              .share_per_mm = limit.share_per_mm});
        run.length += length;
    }
}

/// Adds the part of a move between its blends. Cuts it if its curvature varies, so that one place
/// with tight limits does not slow all of it.
void add_leg(const Program& program, std::uint32_t index, const MotionLimits& limits,
             const Leg& leg, std::int64_t from, std::int64_t to, Run& run) {
    const Move& move = program.moves[index];
    const PieceKind kind = move.kind == MoveKind::arc ? PieceKind::arc : PieceKind::line;
    const double share = static_cast<double>(to - from) * kMmPerPathUnit / leg.length_mm;
    const double turning =
        move.control == kNoIndex ? 0.0 : share * turning_deg(program, index, limits);
    const auto parts = static_cast<std::int64_t>(std::ceil(turning / kTurnDegMax));
    if (parts <= 1) {
        add_piece(run, kind, index, from, to - from, leg.limit);
        return;
    }
    for (std::int64_t part = 0; part < parts; ++part) {
        const std::int64_t step = (to - from) / parts;
        const std::int64_t start = from + part * step;
        const Piece piece{.kind = kind,
                          .move = index,
                          .length = part + 1 == parts ? to - start : step,
                          .offset = start};
        const SpeedPair limit =
            limit_piece(sampled_bounds(program, piece, limits, kLineSamples), limits, leg.feed);
        add_piece(run, kind, index, start, piece.length, limit);
    }
}

}  // namespace

AxisPositions axes_after(const Program& program, const Move& move) {
    AxisPositions axes = move.target;
    if (move.control != kNoIndex) {
        program.controls[move.control].axes_at(move.target, axes);
    }
    return axes;
}

void build_run(const Program& program, std::uint32_t first, const MotionLimits& limits,
               const MotionOptions& options, Run& run) {
    run.first_move = first;
    run.move_count = 0;
    run.length = 0;
    run.pieces.clear();
    Leg leg = make_leg(program, first, limits, options);
    std::int64_t taken = 0;  // part of the move in the blend at its start
    for (std::uint32_t index = first;; ++index) {
        ++run.move_count;
        const std::int64_t length = length_units(program, index, limits);
        const bool is_last = index + 1 >= program.moves.size() ||
                             !is_path(program.moves[index + 1]) ||
                             static_cast<double>(run.length) > kRunMmMax * kPathUnitsPerMm / 2;
        Corner corner;
        Leg next;
        if (!is_last) {
            next = make_leg(program, index + 1, limits, options);
            corner = make_corner(program, index, leg, next, limits, options);
        }
        const auto half =
            corner.passes ? static_cast<std::int64_t>(corner.half_mm * kPathUnitsPerMm) : 0;
        add_leg(program, index, limits, leg, taken, length - half, run);
        if (!corner.passes) {
            return;
        }
        add_piece(run, PieceKind::blend, index, 0, 2 * half, corner.limit);
        taken = half;
        leg = next;
    }
}

std::uint32_t line_at(const Program& program, const Piece& piece, double along_mm) {
    const bool is_next = piece.kind == PieceKind::blend &&
                         2 * along_mm > static_cast<double>(piece.length) * kMmPerPathUnit;
    return program.moves[piece.move + (is_next ? 1 : 0)].line;
}

void PieceCurve::enter(const Program& program, const Piece& piece, const MotionLimits& limits) {
    kind_ = piece.kind;
    axis_count_ = limits.axis_count;
    const Move& move = program.moves[piece.move];
    control_ = move.control == kNoIndex ? nullptr : &program.controls[move.control];
    const double length_mm =
        static_cast<double>(length_units(program, piece.move, limits)) * kMmPerPathUnit;
    offset_mm_ = static_cast<double>(piece.offset) * kMmPerPathUnit;
    line_tangent(program, piece.move, limits, length_mm, tangent_);
    base_ = start_of(program, piece.move);
    if (kind_ == PieceKind::arc) {
        arc_ = move.arc;
        per_mm_ = 1.0 / length_mm;
    } else if (kind_ == PieceKind::blend) {
        const auto half = piece.length / 2;  // whole units
        half_mm_ = static_cast<double>(half) * kMmPerPathUnit;
        base_ = move.target;
        const double next_mm =
            static_cast<double>(length_units(program, piece.move + 1, limits)) * kMmPerPathUnit;
        line_tangent(program, piece.move + 1, limits, next_mm, bend_);
        for (std::uint32_t i = 0; i < axis_count_; ++i) {
            bend_[i] -= tangent_[i];
        }
    }
}

template <class Scalar>
void PieceCurve::commanded(const Scalar& along_mm,
                           std::array<Scalar, kAxesMax>& out) const noexcept {
    if (kind_ == PieceKind::blend) {
        // q = corner + t_in u + (t_out - t_in) R(u), R'' the kernel: R goes from 0 at -d to u at d.
        const Scalar u = along_mm - Scalar(half_mm_);
        const Scalar x = u / Scalar(half_mm_);
        const Scalar z = x * x;
        const Scalar ramp =
            Scalar(half_mm_) *
            (Scalar(15.0 / 16.0) * z * (Scalar(0.5) - z / Scalar(6.0) + z * z / Scalar(30.0)) +
             x / Scalar(2) + Scalar(kBlendDepth));
        for (std::uint32_t i = 0; i < axis_count_; ++i) {
            out[i] = Scalar(base_[i]) + (Scalar(tangent_[i]) * u + Scalar(bend_[i]) * ramp);
        }
        return;
    }
    const Scalar u = along_mm + Scalar(offset_mm_);
    for (std::uint32_t i = 0; i < axis_count_; ++i) {
        out[i] = Scalar(base_[i]) + Scalar(tangent_[i]) * u;
    }
    if (kind_ == PieceKind::arc) {
        const Scalar share = u * Scalar(per_mm_);
        const SinCosOf<Scalar> angle =
            sin_cos_of(Scalar(arc_.start_rad) + Scalar(arc_.sweep_rad) * share);
        const Scalar radius = Scalar(arc_.radius_start_mm) +
                              Scalar(arc_.radius_end_mm - arc_.radius_start_mm) * share;
        out[arc_.first] = Scalar(arc_.center_first_mm) + radius * angle.cos;
        out[arc_.second] = Scalar(arc_.center_second_mm) + radius * angle.sin;
    }
}

void PieceCurve::position(double along_mm, AxisPositions& out) const noexcept {
    commanded(along_mm, out);
    if (control_ != nullptr) {
        control_->axes_at(AxisPositions(out), out);
    }
}

void PieceCurve::derivatives(double along_mm, std::array<Jet, kAxesMax>& out) const noexcept {
    commanded(Jet(along_mm, 1, 0, 0), out);
    if (control_ != nullptr) {
        control_->axes_at(std::array<Jet, kAxesMax>(out), out);
    }
}

}  // namespace axg
