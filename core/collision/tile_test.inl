// SPDX-License-Identifier: Apache-2.0
// The certified test on tiles of independent pairs: part of each instruction set's unit, after
// traverse.inl, which names the lanes. Same bits for every lane set: the axes tried for one pair do
// not depend on its neighbours' results.

#include "core/collision/double_test.hpp"
#include "core/collision/pair_tile.hpp"

namespace axg::AXG_TRAVERSE_NAMESPACE {

struct TilePairs {
    sat::V3<V> a[3], b[3];
    V d;

    /// Proven to share no point, by the axes.
    [[nodiscard]] AXG_HD auto apart() const noexcept {
        return sat::apart<false>(a, b, {d, V::of(0.0F), V::of(0.0F)});
    }
};

AXG_HD TilePairs tile_pairs(const PairTile& tile, unsigned at) noexcept {
    TilePairs p;
    for (int v = 0; v < 3; ++v) {
        p.a[v] = {V::load(&tile.v[3 * v][at]), V::load(&tile.v[3 * v + 1][at]),
                  V::load(&tile.v[3 * v + 2][at])};
        p.b[v] = {V::load(&tile.v[9 + 3 * v][at]), V::load(&tile.v[10 + 3 * v][at]),
                  V::load(&tile.v[11 + 3 * v][at])};
    }
    p.d = V::load(&tile.d[at]);
    return p;
}

/// Pairs that the shared axes left, from any tile, until there are enough to fill the lanes.
struct LeftPairs {
    PairTile tile;
    std::uint32_t count = 0;
    struct {
        std::size_t tile;
        unsigned at;
    } from[kTilePairs];

    AXG_HD LeftPairs() noexcept {}  // what is not filled is not read
};

/// Every axis by itself, and the closest direction for what they leave.
static void finish(LeftPairs& left, TileResult* results) noexcept {
    for (; left.count % kW != 0; ++left.count) {  // empty lanes hold copies
        for (auto& coordinate : left.tile.v) {
            coordinate[left.count] = coordinate[left.count - 1];
        }
        left.tile.d[left.count] = left.tile.d[left.count - 1];
        left.from[left.count] = left.from[left.count - 1];
    }
    for (unsigned at = 0; at < left.count; at += kW) {
        const TilePairs picked = tile_pairs(left.tile, at);
        const auto p = sat::scaled_pair(picked.a, picked.b, picked.d);
        auto apart = sat::separated_17<false>(p, V::of(0.0F));
        if (!lanes::all(apart)) {
            const sat::Closest<V> closest = sat::closest_direction(p, sat::axes_of(p));
            apart = lanes::either(apart, sat::separates<false>(p, closest.direction, V::of(0.0F)));
        }
        for (std::uint32_t bits = apart.bits() & kLaneBits; bits != 0; bits &= bits - 1) {
            const auto& from = left.from[at + static_cast<unsigned>(__builtin_ctz(bits))];
            results[from.tile].apart |= 1U << from.at;
        }
    }
    left.count = 0;
}

/// Shared axes alone; every pair costs the same.
static void share_tiles(const PairTile* tiles, std::size_t count, TileResult* results) noexcept {
    for (std::size_t t = 0; t < count; ++t) {
        results[t].apart = 0;
        for (unsigned at = 0; at < kTilePairs; at += kW) {
            const TilePairs p = tile_pairs(tiles[t], at);
            const auto apart = sat::separated_shared<false, false>(p.a, p.b, p.d, V::of(0.0F));
            results[t].apart |= (apart.bits() & kLaneBits) << at;
            V::of(0.0F).store(&results[t].distance_mm[at]);
        }
    }
}

/// Shared axes; gathers the pairs they leave from all tiles for the more expensive stages.
static void test_tiles(const PairTile* tiles, std::size_t count, TileResult* results) noexcept {
    LeftPairs left;
    share_tiles(tiles, count, results);
    for (std::size_t t = 0; t < count; ++t) {
        for (std::uint32_t bits = ~results[t].apart; bits != 0; bits &= bits - 1) {
            const auto at = static_cast<unsigned>(__builtin_ctz(bits));
            for (unsigned k = 0; k < 18; ++k) {
                left.tile.v[k][left.count] = tiles[t].v[k][at];
            }
            left.tile.d[left.count] = tiles[t].d[at];
            left.from[left.count] = {t, at};
            if (++left.count == kTilePairs) {
                finish(left, results);
            }
        }
    }
    finish(left, results);
}

/// The same, and the distance that the closest direction proves.
static void measure_tiles(const PairTile* tiles, std::size_t count, TileResult* results) noexcept {
    for (std::size_t t = 0; t < count; ++t) {
        results[t].apart = 0;
        for (unsigned at = 0; at < kTilePairs; at += kW) {
            const TilePairs picked = tile_pairs(tiles[t], at);
            const auto p = sat::scaled_pair(picked.a, picked.b, picked.d);
            const sat::Closest<V> closest = sat::closest_direction(p, sat::axes_of(p));
            const auto apart = lanes::either(
                picked.apart(), sat::separates<false>(p, closest.direction, V::of(0.0F)));
            results[t].apart |= (apart.bits() & kLaneBits) << at;
            lanes::max(sat::certified_distance(p, closest.direction), V::of(0.0F))
                .store(&results[t].distance_mm[at]);
        }
    }
}

static bool pair_apart_in_double(const sat::TrianglePair<double>& p) noexcept {
    return sat::apart_in_double<false>(p, 0.0);
}

static double pair_distance_in_double(const sat::TrianglePair<double>& p) noexcept {
    const sat::Closest<double> closest = sat::closest_direction(p, sat::axes_of(p));
    return lanes::max(sat::certified_distance(p, closest.direction), 0.0);
}

}  // namespace axg::AXG_TRAVERSE_NAMESPACE
