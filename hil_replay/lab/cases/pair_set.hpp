// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles in the layouts that the methods need: as given, in double, in float, and in
// the tiles of the certified test. mm. Built once, outside of any timing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/collision/pair_tile.hpp"
#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

/// Largest coordinate for which the certified test is proven (docs/theory/accuracy.md, section 1):
/// local coordinates stay within 2^20.
inline constexpr double kLabDomainMm = 0x1p19;

enum class Fitness : std::uint8_t {
    usable,
    outside,   // a coordinate beyond kLabDomainMm: the proof does not apply
    rejected,  // a NaN or an infinity, recognised by its bits
};

/// The same pairs in parallel lists: element i of each list is pair i; in the tiles it is place
/// i % 32 of tile i / 32. Pairs that are not usable have zeros in the tiles, which prove nothing.
class PairSet {
  public:
    /// Adds a pair with its vertices exactly as given.
    void add(const Pair<double>& pair);
    void add(const Pair<float>& pair);
    /// Adds a pair with b's vertices at R q + t, with the matrix exactly as given, rigid or not.
    void add(const Pair<double>& pair, const Pose& pose);
    void reserve(std::size_t count);

    [[nodiscard]] std::size_t size() const noexcept { return fitness.size(); }

    std::vector<Pair<double>> given;  // b in its own frame if there are poses
    std::vector<Pose> poses;          // one a pair, or none at all
    std::vector<Pair<double>> f64;    // b placed, within error_mm
    std::vector<Pair<float>> f32;     // the same rounded once: input of the methods in float
    std::vector<PairTile> tiles;      // less a's first vertex, rounded once from double
    std::vector<double> error_mm;     // of each coordinate in f64: 0 without a pose
    std::vector<Fitness> fitness;

  private:
    void put(const Pair<double>& placed, double error);
    void put_tile(const Pair<double>& placed, double error);
};

}  // namespace axg::lab
