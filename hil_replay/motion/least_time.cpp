// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/least_time.hpp"

#include <algorithm>
#include <cmath>

namespace axg {
namespace {

constexpr double kShareOfMove = 0.5;  // the least that two blended corners leave of its time

double least_seconds(const Move& move, const AxisPositions& from, const MotionLimits& limits) {
    if (move.kind == MoveKind::dwell) {
        return move.dwell_s;
    }
    const bool is_motion = move.kind == MoveKind::line || move.kind == MoveKind::arc;
    if (!is_motion || move.control != kNoIndex) {
        return 0;
    }
    double rapid_s = 0, squared = 0;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const double distance = std::abs(move.target[i] - from[i]);
        rapid_s = std::max(rapid_s, distance / limits.speed[i]);
        squared += limits.feed_group[i] == 0 ? distance * distance : 0;
    }
    if (move.feed_kind == FeedKind::rapid || move.feed <= 0) {
        return kShareOfMove * rapid_s;
    }
    const double length_mm = move.kind == MoveKind::arc
                                 ? std::abs(move.arc.sweep_rad) *
                                       std::min(move.arc.radius_start_mm, move.arc.radius_end_mm)
                                 : std::sqrt(squared);
    const double feed_s =
        move.feed_kind == FeedKind::inverse ? 60 / move.feed : 60 * length_mm / move.feed;
    return kShareOfMove * std::max(rapid_s, feed_s);
}

}  // namespace

std::size_t first_move_beyond(const Program& program, const MotionLimits& limits,
                              double seconds_max) {
    AxisPositions at = program.start;
    double seconds = 0;
    for (std::size_t i = 0; i < program.moves.size(); ++i) {
        seconds += least_seconds(program.moves[i], at, limits);
        if (seconds > seconds_max) {
            return i;
        }
        at = program.moves[i].target;
    }
    return program.moves.size();
}

std::string too_many_samples(std::uint64_t samples_max) {
    return "takes more than " + std::to_string(samples_max) +
           " samples; check G4 and F, or raise the limit with --max-samples N";
}

}  // namespace axg
