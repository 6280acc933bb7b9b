// SPDX-License-Identifier: Apache-2.0
// The certified test on tiles of independent pairs: part of each instruction set's unit, after
// walk.inl, which names the lanes. Same bits for every lane set: the axes tried for one pair do not
// depend on its neighbours' answers.

#include "core/pair_tile.hpp"

namespace axg::AXG_WALK_NAMESPACE {

AXG_HD sat::TrianglePair<V> tile_pairs(const PairTile& tile, unsigned at) noexcept {
    using lanes::abs, lanes::max;
    sat::TrianglePair<V> p;
    V most[3] = {V::of(0.0F), V::of(0.0F), V::of(0.0F)};
    for (int v = 0; v < 3; ++v) {
        V ca[3], cb[3];
        for (int k = 0; k < 3; ++k) {
            ca[k] = V::load(&tile.v[3 * v + k][at]);
            cb[k] = V::load(&tile.v[9 + 3 * v + k][at]);
            most[k] = max(most[k], max(abs(ca[k]), abs(cb[k])));
        }
        p.a[v] = {ca[0], ca[1], ca[2]};
        p.b[v] = {cb[0], cb[1], cb[2]};
    }
    const V d = V::load(&tile.d[at]);
    p.scale = {sat::scale_of(most[0], d), sat::scale_of(most[1], d), sat::scale_of(most[2], d)};
    return p;
}

/// Seventeen axes, and the closest direction for what they leave.
static void test_tiles(const PairTile* tiles, std::size_t count, TileAnswer* answers) noexcept {
    for (std::size_t t = 0; t < count; ++t) {
        answers[t].apart = 0;
        for (unsigned at = 0; at < kTilePairs; at += kW) {
            const sat::TrianglePair<V> p = tile_pairs(tiles[t], at);
            auto apart = sat::separated_17<false>(p, V::of(0.0F));
            if (!lanes::all(apart)) {
                const sat::Closest<V> closest = sat::closest_direction(p, sat::axes_of(p));
                apart =
                    lanes::either(apart, sat::separates<false>(p, closest.direction, V::of(0.0F)));
            }
            answers[t].apart |= (apart.bits() & kLaneBits) << at;
            V::of(0.0F).store(&answers[t].distance_mm[at]);
        }
    }
}

/// The same, and what the closest direction proves of the distance.
static void measure_tiles(const PairTile* tiles, std::size_t count, TileAnswer* answers) noexcept {
    for (std::size_t t = 0; t < count; ++t) {
        answers[t].apart = 0;
        for (unsigned at = 0; at < kTilePairs; at += kW) {
            const sat::TrianglePair<V> p = tile_pairs(tiles[t], at);
            const sat::Closest<V> closest = sat::closest_direction(p, sat::axes_of(p));
            const auto apart =
                lanes::either(sat::separated_17<false>(p, V::of(0.0F)),
                              sat::separates<false>(p, closest.direction, V::of(0.0F)));
            answers[t].apart |= (apart.bits() & kLaneBits) << at;
            lanes::max(sat::certified_distance(p, closest.direction), V::of(0.0F))
                .store(&answers[t].distance_mm[at]);
        }
    }
}

}  // namespace axg::AXG_WALK_NAMESPACE
