// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/clearance_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/vec3.hpp"
#include "core/collision/containment.hpp"
#include "firmware_if/setup/surface_list.hpp"

namespace axg {
namespace {

// A far pair is queried this much farther than of interest, to be left alone for as long.
constexpr double kSpareMm = 50.0;
constexpr double kRoundingMm = 1e-6;  // of a motion that is computed in double, with room to spare

}  // namespace

ClearanceTracker::ClearanceTracker(const LoadedMachine& loaded, Engine engine, double within_mm)
    : machine_(loaded.machine),
      triangles_(loaded),
      engine_(engine),
      within_mm_(within_mm),
      known_(machine_.pairs.size()),
      mm_(machine_.pairs.size()) {
    for (const Mesh* mesh : surface_list(loaded).engines) {
        Box box{.low = {1e300, 1e300, 1e300}, .high = {-1e300, -1e300, -1e300}};
        for (const Triangle& triangle : mesh->triangles) {
            for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
                const Vec3d at = widen(corner);
                box.low = {std::min(box.low.x, at.x), std::min(box.low.y, at.y),
                           std::min(box.low.z, at.z)};
                box.high = {std::max(box.high.x, at.x), std::max(box.high.y, at.y),
                            std::max(box.high.z, at.z)};
            }
        }
        boxes_.push_back(mesh->triangles.empty() ? Box{} : box);
    }
}

/// How far any point of a moved relative to b. The way of a point is affine in its place, so no
/// point of a box goes farther than the corner that goes farthest.
double ClearanceTracker::moved_mm(const Known& known, const Query& query) const noexcept {
    const Box& box = boxes_[query.mesh_a];
    double most = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner{(i & 1) != 0 ? box.high.x : box.low.x,
                           (i & 2) != 0 ? box.high.y : box.low.y,
                           (i & 4) != 0 ? box.high.z : box.low.z};
        const Vec3d way = apply(query.pose, corner) - apply(known.pose, corner);
        most = std::max(most, dot(way, way));
    }
    return std::sqrt(most) + 2 * query.pose_error_mm + kRoundingMm;
}

QueryResult ClearanceTracker::ask(Query query, double within_mm) {
    query.kind = QueryKind::clearance;
    query.r_mm = within_mm;
    QueryResult result;
    engine_({&query, 1}, {&result, 1});
    ++query_count_;
    return result;
}

/// The bound of one pair; queries the pair again if the old bound is too low.
double ClearanceTracker::follow(Known& known, const Query& query) {
    double expected_mm = within_mm_ + kSpareMm;
    if (known.is_known && known.mesh_a == query.mesh_a && known.mesh_b == query.mesh_b) {
        const double moved = moved_mm(known, query);
        const double bound = known.clearance_mm - moved;
        if (bound >= within_mm_ || moved <= 0.5 * tracking_error_mm(std::max(0.0, bound))) {
            return std::max(0.0, bound);
        }
        // Begin the search near the expected clearance, if possible.
        expected_mm = std::min(expected_mm, known.clearance_mm + moved + kRoundingMm);
    }
    QueryResult result = ask(query, expected_mm);
    if (result.status == QueryStatus::ok && result.clearance_mm >= expected_mm &&
        expected_mm < within_mm_ + kSpareMm) {
        result = ask(query, within_mm_ + kSpareMm);
    }
    known = {.is_known = result.status == QueryStatus::ok,
             .mesh_a = query.mesh_a,
             .mesh_b = query.mesh_b,
             .pose = query.pose,
             .clearance_mm = result.clearance_mm};
    return known.is_known ? result.clearance_mm : 0;
}

std::span<const double> ClearanceTracker::at(const AxisSnapshot& snapshot) {
    std::fill(mm_.begin(), mm_.end(), kNotNear);
    make_contact_queries(machine_, snapshot, pair_queries_);
    for (std::uint32_t i = 0; pair_queries_.status == SnapshotStatus::ok && i < pair_queries_.count;
         ++i) {
        const std::uint32_t pair = pair_queries_.pair[i];
        const double bound = follow(known_[pair], pair_queries_.queries[i]);
        mm_[pair] = bound < within_mm_ ? bound : kNotNear;
    }
    return mm_;
}

PageClearances ClearanceTracker::nearest(const AxisSnapshot& snapshot,
                                         std::span<const double> bounds_mm) {
    std::fill(mm_.begin(), mm_.end(), kNotNear);
    PageClearances out{.mm = mm_};
    make_contact_queries(machine_, snapshot, pair_queries_);
    if (pair_queries_.status != SnapshotStatus::ok) {
        return out;
    }
    std::vector<std::uint32_t> order(pair_queries_.count);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    const auto bound_of = [&](std::uint32_t i) { return bounds_mm[pair_queries_.pair[i]]; };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return bound_of(a) < bound_of(b); });
    double least_mm = within_mm_;
    for (const std::uint32_t i : order) {
        if (bound_of(i) >= least_mm) {
            break;
        }
        const Query& query = pair_queries_.queries[i];
        const QueryResult result = ask(query, least_mm);
        const bool is_known = result.status == QueryStatus::ok;
        if (is_known && result.clearance_mm >= least_mm) {
            continue;
        }
        mm_[pair_queries_.pair[i]] = result.clearance_mm;  // unknown: 0, and no triangles to show
        if (is_known) {
            least_mm = result.clearance_mm;
            out.pair = pair_queries_.pair[i];
            out.triangles = triangles_.of(query, result.nearest);
        }
    }
    return out;
}

}  // namespace axg
