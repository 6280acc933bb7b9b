// SPDX-License-Identifier: Apache-2.0
// All seventeen axes of a pair of triangles, from shared triple products, nothing left early: 9 ns
// a pair with AVX-512 and 18 with AVX2 on one core. From a list that stays near the core, and from
// one that does not. Least and median of the passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "hil_replay/lab/methods/throughput.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kSeed = 20261121;
constexpr std::size_t kPasses = 501;

struct TileTime {
    double least_ns = 0, median_ns = 0;  // a pair
};

TileTime time_shared_axes(const LaneKernels& lanes, const lab::PairSet& pairs) {
    using Clock = std::chrono::steady_clock;
    std::vector<TileResult> results(pairs.tiles.size());
    std::vector<double> ns;
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
        const Clock::time_point begun = Clock::now();
        lanes.share_tiles(pairs.tiles.data(), pairs.tiles.size(), results.data());
        const std::chrono::duration<double, std::nano> spent = Clock::now() - begun;
        ns.push_back(spent.count() / static_cast<double>(pairs.size()));
    }
    std::sort(ns.begin(), ns.end());
    EXPECT_TRUE(std::any_of(results.begin(), results.end(),
                            [](const TileResult& result) { return result.apart != 0; }));
    return {ns.front(), ns[ns.size() / 2]};
}

TEST(SharedAxesSpeed, SeventeenAxesAPair) {
    const struct {
        LaneSet set;
        double wanted_ns;
    } wanted[] = {{LaneSet::avx512, 9}, {LaneSet::avx2, 18}};
    for (const auto& [set, wanted_ns] : wanted) {
        if (!has_lane_set(set)) {
            std::printf("this processor lacks a lane set: %d\n", static_cast<int>(set));
            continue;
        }
        const LaneKernels& lanes = *lane_kernels(set);
        for (const std::size_t count : {4096U, 16384U}) {
            const TileTime time = time_shared_axes(lanes, lab::overlapping_pairs(count, kSeed));
            std::printf("%-8s %6zu pairs: least %.2f, median %.2f ns a pair\n", lanes.name, count,
                        time.least_ns, time.median_ns);
            EXPECT_LE(time.least_ns, wanted_ns);
        }
    }
}

}  // namespace
}  // namespace axg::test
