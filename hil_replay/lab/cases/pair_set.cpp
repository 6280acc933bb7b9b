// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/cases/pair_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/base/finite.hpp"

namespace axg::lab {
namespace {

std::array<double, 18> coordinates_of(const Pair<double>& pair) noexcept {
    std::array<double, 18> out{};
    for (std::size_t v = 0; v < 3; ++v) {
        for (std::size_t side = 0; side < 2; ++side) {
            const Vec3d& at = side == 0 ? pair.a[v] : pair.b[v];
            out[9 * side + 3 * v] = at.x;
            out[9 * side + 3 * v + 1] = at.y;
            out[9 * side + 3 * v + 2] = at.z;
        }
    }
    return out;
}

/// One coordinate of R q + t: three fused operations, three roundings. Raises `weight` to the
/// largest sum of sizes, which bounds each of them.
double placed_coordinate(const Pose& p, int k, const Vec3d& q, double& weight) noexcept {
    weight = std::max(weight, std::fabs(p.t[k]) + std::fabs(p.r[k][0] * q.x) +
                                  std::fabs(p.r[k][1] * q.y) + std::fabs(p.r[k][2] * q.z));
    return std::fma(p.r[k][0], q.x, std::fma(p.r[k][1], q.y, std::fma(p.r[k][2], q.z, p.t[k])));
}

bool all_finite(const Pose& pose) noexcept {
    bool all = true;
    for (int i = 0; i < 3; ++i) {
        all = all && is_finite(pose.t[i]);
        for (int j = 0; j < 3; ++j) {
            all = all && is_finite(pose.r[i][j]);
        }
    }
    return all;
}

Fitness fitness_of(const Pair<double>& pair) noexcept {
    double most = 0;
    for (const double x : coordinates_of(pair)) {
        if (!is_finite(x)) {
            return Fitness::rejected;
        }
        most = std::max(most, std::fabs(x));
    }
    return most <= kLabDomainMm ? Fitness::usable : Fitness::outside;
}

float up(double d) noexcept {
    return static_cast<float>(d * (1.0 + 0x1p-22));
}

/// Rounds to float; beyond its range to infinity, as a plain conversion does.
Vec3f narrowed(const Vec3d& v) noexcept {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

void PairSet::reserve(std::size_t count) {
    given.reserve(count);
    f64.reserve(count);
    f32.reserve(count);
    tiles.reserve((count + kTilePairs - 1) / kTilePairs);
    error_mm.reserve(count);
    fitness.reserve(count);
}

void PairSet::add(const Pair<double>& pair) {
    given.push_back(pair);
    fitness.push_back(fitness_of(pair));
    put(pair, 0.0);
}

void PairSet::add(const Pair<float>& pair) {
    Pair<double> wide;
    for (int v = 0; v < 3; ++v) {
        wide.a[v] = widen(pair.a[v]);
        wide.b[v] = widen(pair.b[v]);
    }
    add(wide);
}

void PairSet::add(const Pair<double>& pair, const Pose& pose) {
    if (poses.size() != given.size()) {
        throw std::logic_error("PairSet: pairs with and without a pose in one set");
    }
    given.push_back(pair);
    poses.push_back(pose);
    const Fitness raw = fitness_of(pair);
    Pair<double> placed = pair;
    double weight = 0;
    for (int v = 0; v < 3; ++v) {
        placed.b[v] = {placed_coordinate(pose, 0, pair.b[v], weight),
                       placed_coordinate(pose, 1, pair.b[v], weight),
                       placed_coordinate(pose, 2, pair.b[v], weight)};
    }
    if (raw == Fitness::rejected || !all_finite(pose)) {
        fitness.push_back(Fitness::rejected);
    } else {
        fitness.push_back(weight <= kLabDomainMm ? raw : Fitness::outside);
    }
    // Three roundings of 2^-53 of the weight each, and a bound of underflow.
    put(placed, 0x1p-51 * weight + 0x1p-1000);
}

void PairSet::put(const Pair<double>& placed, double error) {
    f64.push_back(placed);
    error_mm.push_back(error);
    Pair<float> rounded;
    for (int v = 0; v < 3; ++v) {
        rounded.a[v] = narrowed(placed.a[v]);
        rounded.b[v] = narrowed(placed.b[v]);
    }
    f32.push_back(rounded);
    put_tile(placed, error);
}

void PairSet::put_tile(const Pair<double>& placed, double error) {
    const std::size_t i = fitness.size() - 1;
    if (i % kTilePairs == 0) {
        tiles.emplace_back();  // zeros
    }
    if (fitness[i] != Fitness::usable) {
        return;
    }
    PairTile& tile = tiles.back();
    const std::array<double, 18> at = coordinates_of(placed);
    double most = 0;
    for (std::size_t c = 0; c < 18; ++c) {
        const double local = at[c] - static_cast<double>(static_cast<float>(at[c % 3]));
        most = std::max(most, std::fabs(local));
        tile.v[c][i % kTilePairs] = static_cast<float>(local);
    }
    // The subtraction rounds once more, by 2^-53 of the local coordinate: 2^-52 with room.
    tile.d[i % kTilePairs] = up(0x1p21 * (error + 0x1p-52 * most)) + 0x1p-90F;
}

}  // namespace axg::lab
