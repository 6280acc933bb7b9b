// SPDX-License-Identifier: Apache-2.0
// Independent pairs of triangles, 32 at a time, coordinate by coordinate: the input of the
// certified test in a benchmark, a chart or the laboratory. mm.
#pragma once

#include <cstdint>

#include "core/base/limits.hpp"

namespace axg {

inline constexpr unsigned kTilePairs = kNodeWidth;

/// Every vertex less an origin near its own pair, rounded once to float, |coordinate| <= 2^20.
/// Empty places hold any finite pair: zeros, or copies.
struct PairTile {
    alignas(64) float v[18][kTilePairs];  // a's vertices x y z x y z x y z, then b's
    float d[kTilePairs];                  // d of scale_of: the vertices' own errors, mm / (8u)
};

struct TileResult {
    std::uint32_t apart;  // one bit a pair: proven to share no point
    // Certified lower bound of the distance, mm; 0 if no bound is proven or none was requested.
    alignas(64) float distance_mm[kTilePairs];
};

}  // namespace axg
