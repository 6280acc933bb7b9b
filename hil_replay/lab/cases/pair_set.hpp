// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles as every method of the laboratory likes them: as they were given, in double,
// in float, and in the tiles of the certified test. mm. Made once, outside of any clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/collision/pair_tile.hpp"
#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

/// Beyond it the proof of the certified test says nothing (docs/theory/accuracy.md, section 1):
/// local coordinates stay within 2^20.
inline constexpr double kLabDomainMm = 0x1p19;

enum class Fitness : std::uint8_t {
    usable,
    outside,   // a coordinate beyond kLabDomainMm: nothing is proven
    rejected,  // a NaN or an infinity, told by its bits
};

/// The same pairs side by side; place i of each list is pair i, and of the tiles place i % 32 of
/// tile i / 32. Pairs that are not usable have zeros in the tiles, which prove nothing.
class PairSet {
  public:
    /// Vertices exactly as given.
    void add(const Pair<double>& pair);
    void add(const Pair<float>& pair);
    /// b's vertices lie at R q + t, the matrix taken as it is, rigid or not.
    void add(const Pair<double>& pair, const Pose& pose);
    void reserve(std::size_t count);

    [[nodiscard]] std::size_t size() const noexcept { return fitness.size(); }

    std::vector<Pair<double>> given;  // b in its own frame where there are poses
    std::vector<Pose> poses;          // one a pair, or none at all
    std::vector<Pair<double>> f64;    // b placed, within error_mm
    std::vector<Pair<float>> f32;     // the same rounded once: what a method in float is handed
    std::vector<PairTile> tiles;      // less a's first vertex, rounded once from double
    std::vector<double> error_mm;     // of each coordinate in f64: 0 where nothing was placed
    std::vector<Fitness> fitness;

  private:
    void put(const Pair<double>& placed, double error);
    void put_tile(const Pair<double>& placed, double error);
};

}  // namespace axg::lab
