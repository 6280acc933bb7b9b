// SPDX-License-Identifier: Apache-2.0
#include "core/collision/containment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/assert.hpp"
#include "core/base/rounding_mode.hpp"

namespace axg {
namespace {

/// Slack of the box test, which runs first. It exceeds the rounding of a corner's place plus the
/// error of a pose that is rigid only to kRigidDefectMax.
constexpr double kBoxSlackMm = 0x1p-7;
/// kPlaceErrorMm less the rounding (at most 2^-32) of the sum that is_placed compares with it.
constexpr double kPlacedMm = 0x1p-29 - 0x1p-32;

/// Shortest distance from p to the planes of the box's faces, mm; negative outside.
double way_out_mm(const Aabb& box, const Vec3d& p) noexcept {
    const double x = double(box.h[0]) - std::fabs(p.x - double(box.c[0]));
    const double y = double(box.h[1]) - std::fabs(p.y - double(box.c[1]));
    const double z = double(box.h[2]) - std::fabs(p.z - double(box.c[2]));
    return std::fmin(std::fmin(x, y), z);
}

/// Whether `pose` maps the point of a onto the point of b, to within kPlaceErrorMm.
bool is_placed(const Pose& pose, const Vec3d& of_a, const Vec3d& of_b) noexcept {
    const Vec3d off = apply(pose, of_a) - of_b;
    return dot(off, off) <= kPlacedMm * kPlacedMm;
}

/// The corner of a part with the shortest way out of the other body's box, and its place there.
struct Probe {
    Vec3d corner, place;
};

/// Empty: a corner is outside the box, so the whole part is outside the body.
std::optional<Probe> probe_of(const SurfacePart& part, const Pose& pose, const Aabb& box) noexcept {
    Probe best;
    double shortest = std::numeric_limits<double>::infinity();
    for (const Vec3f& corner : part.extreme) {
        const Vec3d place = apply(pose, widen(corner));
        const double way = way_out_mm(box, place);
        if (way < -kBoxSlackMm) {
            return std::nullopt;
        }
        if (way < shortest) {
            shortest = way;
            best = {widen(corner), place};
        }
    }
    return best;
}

template <class T>
std::span<const T> copy_into(Arena& arena, const std::vector<T>& items) noexcept {
    const std::span<T> room = arena.take<T>(items.size());
    std::copy(items.begin(), items.end(), room.begin());
    return room;
}

}  // namespace

ContainmentTest::ContainmentTest(Arena arena, const Capacities& capacities) noexcept
    : arena_(std::move(arena)), capacities_(capacities) {}

std::optional<ContainmentTest> ContainmentTest::create(std::span<const Mesh* const> meshes,
                                                       std::span<const Tree> trees,
                                                       const Capacities& capacities,
                                                       std::span<const std::uint32_t> same_as) {
    AXG_ASSERT(trees.size() >= meshes.size());
    AXG_ASSERT(same_as.empty() || same_as.size() == meshes.size());
    const auto is_own = [&](std::size_t i) { return same_as.empty() || same_as[i] == i; };
    std::vector<SurfaceParts> parts(meshes.size());
    std::vector<std::vector<std::uint32_t>> masks(meshes.size());
    std::size_t size_bytes = Arena::size_bytes<Body>(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (is_own(i) && !trees[i].nodes.empty()) {
            parts[i] = parts_of(*meshes[i]);
            masks[i] = closed_masks(trees[i].nodes, trees[i].leaves, parts[i].is_closed);
        }
        size_bytes += Arena::size_bytes<SurfacePart>(parts[i].parts.size()) +
                      Arena::size_bytes<std::uint32_t>(masks[i].size());
    }
    Arena arena(size_bytes);
    if (!arena.ok()) {
        return std::nullopt;
    }
    ContainmentTest containment_test(std::move(arena), capacities);
    containment_test.bodies_ = containment_test.arena_.take<Body>(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (!is_own(i)) {
            AXG_ASSERT(same_as[i] < i);
            containment_test.bodies_[i] = containment_test.bodies_[same_as[i]];
            continue;
        }
        const bool has_inside = std::any_of(masks[i].begin(), masks[i].end(),
                                            [](std::uint32_t mask) { return mask != 0; });
        containment_test.bodies_[i] = {{trees[i], copy_into(containment_test.arena_, masks[i])},
                                       copy_into(containment_test.arena_, parts[i].parts),
                                       has_inside};
    }
    containment_test.arena_.seal();
    return containment_test;
}

ApartPose apart_pose(const Query& query, const QueryResult& surfaces) noexcept {
    return {surfaces.status == QueryStatus::ok && surfaces.proof == Proof::far, query.mesh_a,
            query.mesh_b, query.pose_error_mm, query.pose};
}

ContainmentResult ContainmentTest::test(const ApartPose& at) const noexcept {
    ContainmentResult result;
    if (!at.is_proven) {
        return result;
    }
    result.status = QueryStatus::bad_rounding;
    if (rounds_to_nearest()) {
        judge(at, result);
    }
    return result;
}

void ContainmentTest::run(std::span<const Query> queries, std::span<const QueryResult> surfaces,
                          std::span<ContainmentResult> results) const noexcept {
    AXG_ASSERT(queries.size() == surfaces.size());
    AXG_ASSERT(queries.size() == results.size());
    for (std::size_t i = 0; i < queries.size(); ++i) {
        results[i] = test(apart_pose(queries[i], surfaces[i]));
    }
}

void ContainmentTest::judge(const ApartPose& at, ContainmentResult& result) const noexcept {
    result.status = QueryStatus::bad_query;
    if (at.mesh_a >= bodies_.size() || at.mesh_b >= bodies_.size() ||
        bodies_[at.mesh_a].parts.empty() || bodies_[at.mesh_b].parts.empty() ||
        !(at.pose_error_mm >= kPlaceErrorMm)) {
        return;
    }
    RayWork work;
    const bool a_in_b = is_inside(at, true, work, result);
    const bool b_in_a =
        !a_in_b && work.status == QueryStatus::ok && is_inside(at, false, work, result);
    result.status = work.status;
    result.nodes = work.nodes;
    result.triangles = work.triangles;
    result.exact_signs = work.exact_signs;
    if (work.status == QueryStatus::ok) {
        result.containment = a_in_b   ? Containment::a_in_b
                             : b_in_a ? Containment::b_in_a
                                      : Containment::none;
    }
}

/// Whether a part of a is inside b, or (is_a false) a part of b inside a. Also false if the test
/// fails: the status of the work then gives the reason.
bool ContainmentTest::is_inside(const ApartPose& at, bool is_a, RayWork& work,
                                ContainmentResult& result) const noexcept {
    const Body& inner = bodies_[is_a ? at.mesh_a : at.mesh_b];
    const Body& outer = bodies_[is_a ? at.mesh_b : at.mesh_a];
    if (!outer.has_inside) {
        return false;
    }
    const Pose pose = is_a ? at.pose : inverse(at.pose);
    const Aabb& box = outer.solid.tree.nodes[0].box;
    for (const SurfacePart& part : inner.parts) {
        const std::optional<Probe> probe = probe_of(part, pose, box);
        if (!probe) {
            continue;
        }
        ++result.rays;
        const Vec3d place = on_point_grid(probe->place);
        const bool is_near = is_a ? is_placed(at.pose, probe->corner, place)
                                  : is_placed(at.pose, place, probe->corner);
        if (!is_near) {
            work.status = QueryStatus::bad_query;  // a pose that is barely rigid
            return false;
        }
        const Winding winding = winding_number(outer.solid, place, capacities_, work);
        if (!winding.is_known) {
            // The point is on a surface that is proven far: the proof is not about this query.
            work.status = work.status == QueryStatus::ok ? QueryStatus::bad_query : work.status;
            return false;
        }
        if (winding.number != 0) {
            return true;
        }
    }
    return false;
}

}  // namespace axg
