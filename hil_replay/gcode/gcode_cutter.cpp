// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_cutter.hpp"

#include <cmath>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_arc.hpp"

namespace axg {
namespace {

constexpr double kStraightRad = 0.05;      // a smaller corner is none
constexpr double kOutOfRoundUnits = 0.01;  // by so much an inner corner may change a radius
constexpr double kMoreTurnMm = 0.0254;     // rad: LinuxCNC's limit is its unit's
constexpr double kMoreTurnInch = 0.001;
constexpr const char* kGouge = "an inner corner that the tool cannot reach without gouging";
constexpr const char* kSmall = "the tool's radius is not smaller than the arc's";

PlanePoint unit(PlanePoint a) {
    return (1 / length(a)) * a;
}
double angle(PlanePoint a) {
    return std::atan2(a.second, a.first);
}
PlanePoint left_of(PlanePoint way) {
    return {-way.second, way.first};
}
PlanePoint center_of(const Move& arc) {
    return {arc.arc.center_first_mm, arc.arc.center_second_mm};
}

/// Counter-clockwise above 0, with further turns; a full one where both are one angle.
double sweep_between(PlanePoint from, PlanePoint to, double turns) {
    const double sign = turns > 0 ? 1 : -1;
    double way = sign * (angle(to) - angle(from));
    way += way <= 0 ? 2 * kPi : 0;
    return sign * (way + 2 * kPi * (std::abs(turns) - 1));
}

}  // namespace

void CutterPath::start(const Settings& settings) {
    settings_ = settings;
    is_on_ = is_first_ = true;
    has_start_ = false;
    waiting_.clear();
}

PlanePoint CutterPath::at(const AxisPositions& position) const {
    return {position[settings_.first], position[settings_.second]};
}

void CutterPath::set(AxisPositions& position, PlanePoint point) const {
    position[settings_.first] = point.first;
    position[settings_.second] = point.second;
}

PlanePoint CutterPath::to_side(PlanePoint way) const {
    return (settings_.is_left ? 1.0 : -1.0) * left_of(unit(way));
}

std::string CutterPath::add(const Move& next, const AxisPositions& from, int turns,
                            std::vector<Move>& out) {
    Move move = next;
    move.arc.sweep_rad = next.kind == MoveKind::arc ? turns : 0;
    std::string fault;
    if (is_first_) {
        centre_ = at(from);
        fault = next.kind == MoveKind::arc ? add_first_arc(move, at(move.target))
                                           : add_first_line(move, at(move.target));
        is_first_ = !fault.empty();
    } else {
        fault = next.kind == MoveKind::arc ? add_arc(move, from, out) : add_line(move, from, out);
    }
    return fault;
}

std::string CutterPath::add_first_line(const Move& next, PlanePoint to) {
    const PlanePoint way = to - centre_;
    if (length(way) <= settings_.radius_mm) {
        return "the move that begins compensation is not longer than the tool's radius";
    }
    start_ = centre_;
    has_start_ = true;
    // LinuxCNC watches this direction, across the move.
    wait(next, to + settings_.radius_mm * to_side(way), to_side(way), 0);
    return {};
}

/// The arc begins where the tool stands, and ends beside the end of the programmed one.
std::string CutterPath::add_first_arc(const Move& next, PlanePoint to) {
    const double turns = next.arc.sweep_rad, radius = settings_.radius_mm;
    const PlanePoint programmed = center_of(next);
    if (length(to - centre_) <= radius) {
        return "the arc that begins compensation ends nearer than the tool's radius";
    }
    if (is_inside(turns) && length(programmed - centre_) <= radius) {
        return kSmall;
    }
    const PlanePoint outwards = unit(to - programmed);
    const PlanePoint end = to + (is_inside(turns) ? -radius : radius) * outwards;
    // The centre is on the radius of the end, as far from the start as from the end.
    const PlanePoint chord = centre_ - end, inwards = unit(programmed - end);
    const double along = dot(unit(chord), inwards);
    if (!(std::abs(along) >= 1e-6)) {
        return kSmall;
    }
    const PlanePoint center = end + (length(chord) / 2 / along) * inwards;
    Move arc = next;
    arc.arc.center_first_mm = center.first;
    arc.arc.center_second_mm = center.second;
    has_start_ = false;
    wait(arc, end, {}, sweep_between(centre_ - center, end - center, turns));
    return {};
}

double CutterPath::corner_rad(PlanePoint corner, PlanePoint way) const {
    double turned = angle(centre_ - corner) - angle(way);
    turned = settings_.is_left ? turned : -turned;
    turned = std::fmod(turned, 2 * kPi);
    return (turned < 0 ? turned + 2 * kPi : turned) - kPi / 2;
}

std::string CutterPath::add_line(const Move& next, const AxisPositions& from,
                                 std::vector<Move>& out) {
    const PlanePoint corner = at(from), to = at(next.target), way = to - corner;
    if (way.first == 0 && way.second == 0) {
        wait(next, centre_, {}, 0);
        return {};
    }
    const double turned = corner_rad(corner, way);
    const PlanePoint side = settings_.radius_mm * to_side(way);
    const bool is_after_arc = !waiting_.empty() && waiting_.front().move.kind == MoveKind::arc;
    const bool is_inner = turned < -kStraightRad || turned > kPi + kStraightRad ||
                          (turned > kPi - kStraightRad && is_after_arc &&
                           !is_inside(waiting_.front().move.arc.sweep_rad));
    if (is_inner) {
        PlanePoint meet;
        if (waiting_.empty()) {
            return "an inner corner after a pause; take the pause elsewhere";
        }
        if (is_after_arc) {
            std::string fault = meet_line(corner, way, meet);
            if (!fault.empty()) {
                return fault;
            }
        } else {
            const PlanePoint back = (settings_.is_left ? 1.0 : -1.0) * left_of(centre_ - corner);
            meet = centre_ + (1 / std::tan((turned + kPi) / 2)) * back;
        }
        std::string fault = end_waiting(meet, out);
        if (!fault.empty()) {
            return fault;
        }
    } else if (turned > kStraightRad) {
        std::string fault = end_waiting(centre_, out);
        if (!fault.empty()) {
            return fault;
        }
        round_corner(next, from, corner + side, next.feed_kind == FeedKind::rapid, out);
    } else {
        let_go(out);
        start_ = centre_;
        has_start_ = true;
    }
    wait(next, to + side, way, 0);
    return {};
}

std::string CutterPath::add_arc(const Move& next, const AxisPositions& from,
                                std::vector<Move>& out) {
    const double turns = next.arc.sweep_rad, radius = settings_.radius_mm;
    const PlanePoint corner = at(from), to = at(next.target), center = center_of(next);
    const PlanePoint outwards = corner - center;
    const double turned = corner_rad(corner, (turns > 0 ? 1.0 : -1.0) * left_of(outwards));
    const double arc_radius = length(to - center);
    const double beside = is_inside(turns) ? -radius : radius;
    if (is_inside(turns) && arc_radius <= radius) {
        return kSmall;
    }
    const bool is_inner = turned < -kStraightRad || turned > kPi + kStraightRad ||
                          (std::abs(turned - kPi) < kStraightRad && !is_inside(turns));
    if (is_inner) {
        PlanePoint meet;
        if (waiting_.empty()) {
            return "an inner corner after a pause; take the pause elsewhere";
        }
        std::string fault = meet_arc(next, corner, arc_radius, meet);
        if (fault.empty()) {
            fault = end_waiting(meet, out);
        }
        if (!fault.empty()) {
            return fault;
        }
    } else if (turned > kStraightRad) {
        let_go(out);
        round_corner(next, from, corner + beside * unit(outwards), false, out);
    } else {
        let_go(out);
        start_ = centre_;
        has_start_ = true;
    }
    wait(next, to + beside * unit(to - center), {}, sweep_between(outwards, to - center, turns));
    return {};
}

std::string CutterPath::meet_line(PlanePoint corner, PlanePoint way, PlanePoint& meet) const {
    const Move& arc = waiting_.front().move;
    const PlanePoint center = center_of(arc), side = to_side(way);
    const double radius = length(at(arc.target) - center);
    const bool is_before = is_inside(arc.arc.sweep_rad);
    // As LinuxCNC: the first arc's centre may be on the other side of its end.
    const double programmed = radius + (is_before ? 1 : -1) * settings_.radius_mm;
    const double across = programmed * dot(unit(corner - center), side) + settings_.radius_mm;
    if (std::abs(across) > radius) {
        return kGouge;
    }
    const double along = std::sqrt((radius - across) * (radius + across));
    meet = center + across * side + (is_before ? -along : along) * unit(way);
    return {};
}

std::string CutterPath::meet_arc(const Move& next, PlanePoint corner, double radius,
                                 PlanePoint& meet) const {
    const bool is_in = is_inside(next.arc.sweep_rad);
    const double path_radius = radius + (is_in ? -1 : 1) * settings_.radius_mm;
    const PlanePoint center = center_of(next);
    const Move& before = waiting_.front().move;
    if (before.kind != MoveKind::arc) {
        const PlanePoint side = unit(centre_ - corner);
        const PlanePoint way = (settings_.is_left ? -1.0 : 1.0) * left_of(side);
        const double across = radius * dot(unit(corner - center), side) + settings_.radius_mm;
        if (std::abs(across) > path_radius) {
            return kGouge;
        }
        const double along = std::sqrt((path_radius - across) * (path_radius + across));
        meet = center + across * side + (is_in ? along : -along) * way;
        return {};
    }
    const PlanePoint old_center = center_of(before), between = center - old_center;
    const double old_radius = length(at(before.target) - old_center), apart = length(between);
    if (old_radius == 0 || apart == 0) {
        return "two arcs about one centre";
    }
    const double cosine = (old_radius * old_radius + apart * apart - path_radius * path_radius) /
                          (2 * old_radius * apart);
    if (std::abs(cosine) > 1) {
        return kGouge;
    }
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    const bool is_ahead = is_inside(before.arc.sweep_rad) == (next.arc.sweep_rad > 0);
    const PlanePoint along = unit(between);
    meet = old_center + old_radius * cosine * along +
           (is_ahead ? old_radius : -old_radius) * sine * left_of(along);
    return {};
}

/// Every other axis but the plane's third moves here, as in LinuxCNC.
void CutterPath::round_corner(const Move& next, const AxisPositions& from, PlanePoint to,
                              bool is_rapid, std::vector<Move>& out) {
    Move corner = next;
    corner.kind = is_rapid ? MoveKind::line : MoveKind::arc;
    corner.is_exact = next.is_exact || !is_rapid;
    if (settings_.third != kNoIndex) {
        corner.target[settings_.third] = from[settings_.third];
    }
    set(corner.target, to);
    corner.arc.first = settings_.first;
    corner.arc.second = settings_.second;
    corner.arc.center_first_mm = at(from).first;
    corner.arc.center_second_mm = at(from).second;
    corner.arc.sweep_rad = settings_.is_left ? -1 : 1;
    out.push_back(corner);
    start_ = to;
    has_start_ = true;
}

void CutterPath::add_pause(const Move& pause, std::vector<Move>& out) {
    if (waiting_.empty()) {
        out.push_back(pause);
    } else {
        waiting_.push_back({pause, {}, 0});
    }
}

std::string CutterPath::flush(std::vector<Move>& out) {
    return is_beside() ? end_waiting(centre_, out) : std::string();
}

std::string CutterPath::end_waiting(PlanePoint end, std::vector<Move>& out) {
    const double more_rad = settings_.unit_mm > 1 ? kMoreTurnInch : kMoreTurnMm;
    for (Waiting& one : waiting_) {
        if (one.move.kind == MoveKind::dwell) {
            continue;
        }
        if (one.move.kind == MoveKind::arc) {
            const PlanePoint center = center_of(one.move);
            const double off = length(at(one.move.target) - center) - length(end - center);
            const double sweep =
                sweep_between(start_ - center, end - center, one.move.arc.sweep_rad);
            if (std::abs(off) > kOutOfRoundUnits * settings_.unit_mm ||
                (has_start_ && std::abs(sweep) > std::abs(one.sweep_rad) + more_rad)) {
                return kGouge;
            }
        } else if (has_start_ && dot(one.way, end - start_) < 0) {
            return kGouge;
        }
        set(one.move.target, end);
    }
    const bool has_moved = !waiting_.empty();
    let_go(out);
    if (has_moved) {
        start_ = end;
        has_start_ = true;
    }
    return {};
}

void CutterPath::let_go(std::vector<Move>& out) {
    for (const Waiting& one : waiting_) {
        out.push_back(one.move);
    }
    waiting_.clear();
    has_start_ = false;
}

void CutterPath::wait(const Move& move, PlanePoint end, PlanePoint way, double sweep_rad) {
    centre_ = end;
    waiting_.push_back({move, way, sweep_rad});
    set(waiting_.back().move.target, end);
}

std::string CutterPath::finish_arc(const AxisPositions& from, Move& arc) {
    ArcWords words;
    words.start_first = from[arc.arc.first];
    words.start_second = from[arc.arc.second];
    words.end_first = arc.target[arc.arc.first];
    words.end_second = arc.target[arc.arc.second];
    words.center_first = arc.arc.center_first_mm;
    words.center_second = arc.arc.center_second_mm;
    words.is_clockwise = arc.arc.sweep_rad < 0;
    words.turns = static_cast<int>(std::abs(arc.arc.sweep_rad));
    words.tolerance_mm = HUGE_VAL;
    const ArcShape shape = solve_arc(words);
    arc.arc.radius_start_mm = shape.radius_start;
    arc.arc.radius_end_mm = shape.radius_end;
    arc.arc.start_rad = shape.start_rad;
    arc.arc.sweep_rad = shape.sweep_rad;
    return shape.fault;
}

}  // namespace axg
