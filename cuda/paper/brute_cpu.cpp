// SPDX-License-Identifier: Apache-2.0
#include "cuda/paper/brute_cpu.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "cuda/paper/certified_pair.hpp"

namespace axg::paper {
namespace {

/// A tile of a in b's frame less its origin, moved once for all tiles of b.
struct MovedTile {
    Vec3f origin;
    std::array<std::array<sat::V3<float>, 3>, kTilePairs> triangles;
};

MovedTile moved_tile(const CertifiedPose& query, const Body& a, const SubBox& tile) {
    MovedTile out;
    out.origin = origin_of(query.pose, a.triangles[tile.first]);
    for (std::uint32_t i = 0; i < tile.count; ++i) {
        const Triangle& t = a.triangles[tile.first + i];
        out.triangles[i] = {moved_vertex(query.pose, t.a, out.origin),
                            moved_vertex(query.pose, t.b, out.origin),
                            moved_vertex(query.pose, t.c, out.origin)};
    }
    return out;
}

/// b's triangles less the origin, one a column; empty columns hold copies of the first.
void put_columns(PairTile& room, const Body& b, const SubBox& tile, const Vec3f& origin) {
    for (std::uint32_t j = 0; j < kTilePairs; ++j) {
        const Triangle& t = b.triangles[tile.first + (j < tile.count ? j : 0)];
        const Vec3f* const vertices[3] = {&t.a, &t.b, &t.c};
        for (int v = 0; v < 3; ++v) {
            const sat::V3<float> moved = less_origin(*vertices[v], origin);
            room.v[9 + 3 * v][j] = moved.x, room.v[10 + 3 * v][j] = moved.y;
            room.v[11 + 3 * v][j] = moved.z;
        }
    }
}

/// One triangle of a in every column.
void put_everywhere(PairTile& room, const std::array<sat::V3<float>, 3>& triangle) {
    for (int v = 0; v < 3; ++v) {
        std::fill_n(room.v[3 * v], kTilePairs, triangle[v].x);
        std::fill_n(room.v[3 * v + 1], kTilePairs, triangle[v].y);
        std::fill_n(room.v[3 * v + 2], kTilePairs, triangle[v].z);
    }
}

}  // namespace

Found test_naively(const Body& a, const Body& b, const Pose& pose) noexcept {
    const FloatPose rounded_pose = rounded(pose);
    Found found;
    for (const Triangle& own : a.triangles) {
        const Triangle t = moved(rounded_pose, own);
        for (const Triangle& other : b.triangles) {
            found.touching += separating_axis<true>(edged(t, other)) == kNoAxis ? 1 : 0;
        }
    }
    found.tested = static_cast<std::uint32_t>(a.triangles.size() * b.triangles.size());
    return found;
}

Found test_certified(const LaneKernels& lanes, const Body& a, const Body& b,
                     const Pose& pose) noexcept {
    const CertifiedPose query = certified_pose(pose, a.reach_mm, b.reach_mm);
    PairTile room{};
    for (float& d : room.d) {
        d = query.d32;
    }
    Found found;
    TileResult result;
    for (const SubBox& of_a : a.tiles) {
        const MovedTile own = moved_tile(query, a, of_a);
        for (const SubBox& of_b : b.tiles) {
            put_columns(room, b, of_b, own.origin);
            const auto used = static_cast<std::uint32_t>((std::uint64_t{1} << of_b.count) - 1);
            for (std::uint32_t i = 0; i < of_a.count; ++i) {
                put_everywhere(room, own.triangles[i]);
                lanes.test_tiles(&room, 1, &result);
                for (std::uint32_t left = used & ~result.apart; left != 0; left &= left - 1) {
                    const auto j = static_cast<std::uint32_t>(std::countr_zero(left));
                    const bool apart = left_is_apart(query, a.triangles[of_a.first + i],
                                                     b.triangles[of_b.first + j], own.origin);
                    ++found.left;
                    found.touching += apart ? 0 : 1;
                }
            }
        }
    }
    found.tested = static_cast<std::uint32_t>(a.triangles.size() * b.triangles.size());
    return found;
}

}  // namespace axg::paper
