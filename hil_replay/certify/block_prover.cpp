// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/block_prover.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kSegmentQuestions = 512;
constexpr std::uint32_t kCutsMax = 12;

/// Whether kinematics and stated errors hold in the whole box.
bool is_within(const Machine& machine, const JointBox& box) noexcept {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const bool is_linear = machine.axes[i].kind == AxisKind::linear;
        const double farthest = std::fabs(box.centre[i]) + box.half[i];
        const double most = is_linear ? kCoordinateMmMax : kSinCosArgumentMax;
        const bool is_bound = machine.pose_errors.are_stated && is_linear;
        if (!(farthest <= most) || (is_bound && !(farthest <= machine.pose_errors.within[i]))) {
            return false;
        }
    }
    return true;
}

void put_directions(const Directions& directions, std::string& tree) {
    tree += static_cast<char>(directions.size());
    for (const Vec3f& d : directions) {
        for (const float value : {d.x, d.y, d.z}) {
            tree.append(reinterpret_cast<const char*>(&value), sizeof value);
        }
    }
}

}  // namespace

const char* to_text(OpenReason reason) noexcept {
    switch (reason) {
        case OpenReason::position:
            return "position";
        case OpenReason::tube:
            return "tube";
        case OpenReason::inside:
            return "inside";
        case OpenReason::beyond:
            break;
    }
    return "beyond";
}

void add_open(const ChordPath& path, const OpenStretch& next, std::vector<OpenStretch>& open) {
    if (!open.empty()) {
        OpenStretch& last = open.back();
        const bool is_next = last.task == next.task && last.end == next.first;
        if (is_next && last.reason == next.reason &&
            path.lines[last.first] == path.lines[next.first]) {
            const std::uint64_t first = last.first;
            if (next.clearance_mm - next.needed_mm < last.clearance_mm - last.needed_mm) {
                last = next;
            }
            last.first = first;
            last.end = next.end;
            return;
        }
    }
    open.push_back(next);
}

Query BlockProver::query_at(const CertifyTask& task, const AxisPositions& position,
                            double r_mm) const noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine_, position, moved);
    return query_of(task.task, placed_pair(task.task, moved), r_mm);
}

BlockProver::Question BlockProver::question(const UnitBox& box) const noexcept {
    const JointBoxTask& task = task_->task;
    const JointBox joints = joint_box(machine_, box);
    Question out;
    out.is_within = is_within(machine_, joints);
    if (out.is_within) {
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine_, joints.centre, moved);
        const PlacedPair placed = placed_pair(task, moved);
        const PathMotion motion =
            motion_along(machine_, task.path, moved, placed.a, placed.b, joints);
        out.motion_mm = motion.total_mm;
        out.widest_axis = motion.widest_axis;
        out.query = query_of(task, placed, task.margin_mm + motion.total_mm + kSlackMm);
    }
    return out;
}

bool BlockProver::is_far(const Query& query) noexcept {
    ++questions_;
    left_ -= left_ > 0 ? 1 : 0;
    if (!(query.r_mm <= kMarginMmMax)) {
        return false;
    }
    QueryResult result;
    engine_({&query, 1}, {&result, 1});
    return result.status == QueryStatus::ok && result.proof == Proof::far;
}

/// Directions for a query that is far; those of the box before, where they will do.
bool BlockProver::prove_witness(const Query& query, std::string& tree) {
    const PlacedSurfaces at{&trees_[query.mesh_a], &trees_[query.mesh_b], query.pose};
    // Half of the slack is for the checker, half for the roundings here.
    const double r_mm = query.r_mm - kSlackMm / 2 + query.pose_error_mm;
    if (!before_.empty() && walk_.proves(at, r_mm, before_)) {
        tree += '\0';
        return true;
    }
    Directions directions;
    Query nearest = query;
    nearest.kind = QueryKind::clearance;
    nearest.r_mm = std::min(2 * query.r_mm + kClearanceMmMax, kMarginMmMax);
    QueryResult result;
    engine_({&nearest, 1}, {&result, 1});
    if (result.status == QueryStatus::ok && result.clearance_mm < nearest.r_mm) {
        directions.push_back(direction_between(task_->surface_a->triangles[result.nearest.a],
                                               task_->surface_b->triangles[result.nearest.b],
                                               query.pose));
    }
    if (!walk_.complete(at, r_mm, directions) || directions.empty()) {
        return false;
    }
    put_directions(directions, tree);
    before_ = std::move(directions);
    return true;
}

bool BlockProver::prove_box(const UnitBox& box, Question& asked, std::string& tree) {
    asked = question(box);
    const bool is_proven =
        asked.is_within && is_far(asked.query) && prove_witness(asked.query, tree);
    boxes_ += is_proven ? 1 : 0;
    return is_proven;
}

/// Whether most of the motion in the box is that along the chord, so that a shorter part helps.
bool BlockProver::is_chord_long(const PathInterval& part, const Question& whole) const {
    const JointBoxTask& task = task_->task;
    JointBox chord = joint_box(machine_, tube_.box(part));
    const std::uint64_t segment = part.first_segment();
    const double share = static_cast<double>(part.end - part.begin) / kPartsOfSegment;
    for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
        const auto way = static_cast<double>(path_.node(segment + 1, i) - path_.node(segment, i));
        chord.half[i] = std::fabs(way) * 0.5 * share * unit_of(machine_.axes[i].kind);
    }
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine_, chord.centre, moved);
    const PlacedPair placed = placed_pair(task, moved);
    const PathMotion motion = motion_along(machine_, task.path, moved, placed.a, placed.b, chord);
    return motion.total_mm > 0.25 * whole.motion_mm;
}

/// Cuts a box until all of its parts are proven.
bool BlockProver::prove_parts(const UnitBox& box, std::string& tree) {
    struct Part {
        UnitBox box;
        std::uint32_t cuts;
    };
    std::vector<Part> open{{box, 0}};
    while (!open.empty()) {
        const Part part = open.back();
        open.pop_back();
        Question asked;
        if (prove_box(part.box, asked, tree)) {
            continue;
        }
        const std::uint32_t axis = asked.widest_axis;
        const bool may_cut =
            asked.is_within && axis != kNoIndex && part.cuts < kCutsMax && left_ > open.size() + 2;
        if (!may_cut || part.box.high[axis] - part.box.low[axis] < 2) {
            return false;
        }
        Query middle = asked.query;  // whatever the cut, a part of it holds this position
        middle.r_mm = task_->task.margin_mm + kSlackMm;
        if (!is_far(middle)) {
            return false;
        }
        tree += static_cast<char>(kCutTag + axis);
        open.push_back({half_of(part.box, axis, true), part.cuts + 1});
        open.push_back({half_of(part.box, axis, false), part.cuts + 1});
    }
    return true;
}

bool BlockProver::prove_segment(std::uint64_t segment) {
    left_ = kSegmentQuestions;
    const std::size_t kept = out_->size();
    std::vector<PathInterval> open{{segment * kPartsOfSegment, (segment + 1) * kPartsOfSegment}};
    while (!open.empty()) {
        const PathInterval part = open.back();
        open.pop_back();
        const UnitBox box = tube_.box(part);
        ProvenStretch stretch{.at = part};
        Question asked;
        if (prove_box(box, asked, stretch.tree)) {
            out_->push_back(std::move(stretch));
            continue;
        }
        const bool may_halve = asked.is_within && part.end - part.begin > 1 && left_ > 2;
        if (may_halve && is_chord_long(part, asked)) {
            const std::uint64_t middle = part.begin + (part.end - part.begin) / 2;
            open.push_back({middle, part.end});
            open.push_back({part.begin, middle});
            continue;
        }
        stretch.tree.clear();
        if (!asked.is_within || !prove_parts(box, stretch.tree)) {
            out_->resize(kept);
            return false;
        }
        out_->push_back(std::move(stretch));
    }
    return true;
}

void BlockProver::leave_open(std::uint64_t segment) {
    const PathInterval at{segment * kPartsOfSegment, (segment + 1) * kPartsOfSegment};
    OpenStretch open;
    open.task = place_;
    open.first = segment;
    open.end = segment + 1;
    open.box = tube_.box(at);
    const Question asked = question(open.box);
    open.needed_mm = task_->task.margin_mm + asked.motion_mm;
    open.reason = OpenReason::beyond;
    if (asked.is_within) {
        Query query = asked.query;
        query.r_mm = task_->task.margin_mm + kSlackMm;
        open.reason = is_far(query) ? OpenReason::tube : OpenReason::position;
        query.kind = QueryKind::clearance;
        query.r_mm = kClearanceMmMax;
        QueryResult result;
        engine_({&query, 1}, {&result, 1});
        open.clearance_mm = result.status == QueryStatus::ok ? result.clearance_mm : 0;
    }
    add_open(path_, open, *open_);
    before_.clear();
    out_->push_back({.at = at, .is_hole = true});
}

void BlockProver::prove_range(const SegmentRange& segments) {
    std::vector<SegmentRange> open{segments};
    while (!open.empty()) {
        const SegmentRange part = open.back();
        open.pop_back();
        if (part.end - part.first == 1) {
            if (!prove_segment(part.first)) {
                leave_open(part.first);
            }
            continue;
        }
        ProvenStretch stretch{.at = {part.first * kPartsOfSegment, part.end * kPartsOfSegment}};
        Question asked;
        if (prove_box(tube_.box(stretch.at), asked, stretch.tree)) {
            out_->push_back(std::move(stretch));
            continue;
        }
        const std::uint64_t middle = part.first + (part.end - part.first) / 2;
        open.push_back({middle, part.end});
        open.push_back({part.first, middle});
    }
}

void BlockProver::prove(const CertifyTask& task, std::uint32_t place, const SegmentRange& segments,
                        std::vector<ProvenStretch>& out, std::vector<OpenStretch>& open) {
    task_ = &task;
    place_ = place;
    out_ = &out;
    open_ = &open;
    before_.clear();
    prove_range(segments);
}

}  // namespace axg
