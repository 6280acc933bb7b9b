// SPDX-License-Identifier: Apache-2.0
// The certified test on bare pairs: tiles in the widest lanes of the processor, then a recheck in
// double of each pair that float left undecided. Source: docs/theory/accuracy.md.
#include "hil_replay/lab/methods/certified.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/rounding_mode.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/collision/tri_sat.hpp"

namespace axg::lab {
namespace {

/// The un-rounded vertices relative to the tile's origin; d covers the error of their placement.
sat::TrianglePair<double> double_pair(const PairSet& pairs, std::size_t i) noexcept {
    const Pair<double>& pair = pairs.f64[i];
    const auto nearest = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    const Vec3d origin{nearest(pair.a[0].x), nearest(pair.a[0].y), nearest(pair.a[0].z)};
    Vec3d most;
    const auto local = [&](const Vec3d& v) {
        const Vec3d c = v - origin;
        most = {std::max(most.x, std::fabs(c.x)), std::max(most.y, std::fabs(c.y)),
                std::max(most.z, std::fabs(c.z))};
        return sat::V3<double>{c.x, c.y, c.z};
    };
    sat::TrianglePair<double> p;
    for (int v = 0; v < 3; ++v) {
        p.a[v] = local(pair.a[v]);
        p.b[v] = local(pair.b[v]);
    }
    const double d = 0x1p50 * pairs.error_mm[i] * (1.0 + 0x1p-50);
    p.scale = {sat::scale_of(most.x, d), sat::scale_of(most.y, d), sat::scale_of(most.z, d)};
    return p;
}

void recheck(const LaneKernels& lanes, const PairSet& pairs, std::size_t i, Verdict& verdict,
             double* distance_mm) noexcept {
    if (verdict == Verdict::separated && distance_mm == nullptr) {
        return;
    }
    if (pairs.fitness[i] != Fitness::usable) {
        return;
    }
    const sat::TrianglePair<double> p = double_pair(pairs, i);
    if (verdict != Verdict::separated && lanes.apart_in_double(p)) {
        verdict = Verdict::separated;
    }
    if (distance_mm != nullptr && verdict == Verdict::separated) {
        *distance_mm = std::max(*distance_mm, lanes.distance_in_double(p));
    }
}

void write_verdicts(std::uint32_t apart, std::span<Verdict> verdicts) noexcept {
    for (Verdict& verdict : verdicts) {
        verdict = (apart & 1U) != 0 ? Verdict::separated : Verdict::undecided;
        apart >>= 1U;
    }
}

enum class Stages { shared, in_float, with_recheck };

constexpr std::size_t kTilesAtOnce = 64;  // so that the pairs left by a first stage fill the lanes

template <Stages kStages>
void judge_certified(const PairSet& pairs, std::span<Verdict> verdicts,
                     std::span<double> distances_mm) {
    if (!rounds_to_nearest()) {
        std::fill(verdicts.begin(), verdicts.end(), Verdict::undecided);  // no proof holds
        std::fill(distances_mm.begin(), distances_mm.end(), 0.0);
        return;
    }
    const LaneKernels& lanes = *lane_kernels(LaneSet::widest);
    const bool measures = !distances_mm.empty();
    const auto test = measures                    ? lanes.measure_tiles
                      : kStages == Stages::shared ? lanes.share_tiles
                                                  : lanes.test_tiles;
    std::array<TileResult, kTilesAtOnce> results;
    for (std::size_t t = 0; t < pairs.tiles.size(); t += kTilesAtOnce) {
        const std::size_t end = std::min(t + kTilesAtOnce, pairs.tiles.size());
        test(&pairs.tiles[t], end - t, results.data());
        for (std::size_t tile = t; tile < end; ++tile) {
            const std::size_t first = tile * kTilePairs;
            const std::size_t count = std::min<std::size_t>(kTilePairs, pairs.size() - first);
            const TileResult& result = results[tile - t];
            write_verdicts(result.apart, verdicts.subspan(first, count));
            for (std::size_t i = 0; measures && i < count; ++i) {
                distances_mm[first + i] = static_cast<double>(result.distance_mm[i]);
            }
            for (std::size_t i = first; kStages == Stages::with_recheck && i < first + count; ++i) {
                recheck(lanes, pairs, i, verdicts[i], measures ? &distances_mm[i] : nullptr);
            }
        }
    }
}

}  // namespace

void add_certified(std::vector<Method>& methods) {
    if (!has_lane_set(LaneSet::widest)) {
        return;
    }
    constexpr std::string_view kSource =
        "axguard, docs/theory/accuracy.md: any vector may separate, and "
        "does when the gap exceeds its own rounding";
    methods.push_back(
        {.name = "certified-shared-f32",
         .source = "axguard, docs/theory/accuracy.md, section 10: seventeen axes from shared "
                   "triple products",
         .scalar = Scalar::f32,
         .certified = true,
         .on_set = &judge_certified<Stages::shared>});
    methods.push_back({.name = "certified-f32",
                       .source = kSource,
                       .scalar = Scalar::f32,
                       .certified = true,
                       .gives_distance = true,
                       .on_set = &judge_certified<Stages::in_float>});
    methods.push_back({.name = "certified-f32+f64",
                       .source = kSource,
                       .scalar = Scalar::f32_then_f64,
                       .certified = true,
                       .gives_distance = true,
                       .on_set = &judge_certified<Stages::with_recheck>});
}

}  // namespace axg::lab
