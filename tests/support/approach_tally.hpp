// SPDX-License-Identifier: Apache-2.0
// Many random approaches, and what became of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "tests/support/approach_run.hpp"

namespace axg::test {

struct ApproachTally {
    std::uint64_t approaches = 0, moved = 0, touched = 0, stopped = 0, passed = 0, slowed = 0;
    std::uint64_t frozen = 0, frozen_touched = 0, left_cap = 0, left_limits = 0, left_reach = 0;
    std::uint64_t breaches = 0, uncovered = 0, refused_cap = 0;
    std::uint64_t samples = 0, refused = 0;
    WildCounts wire;
    double least_mm = HUGE_VAL;
    std::vector<double> rest_mm;              // of those that were stopped
    std::vector<std::uint64_t> caught_after;  // samples

    void add(const ApproachOutcome& one) {
        ++approaches;
        moved += one.has_moved ? 1 : 0;
        touched += one.touches ? 1 : 0;
        stopped += one.state == BoardState::stopped ? 1 : 0;
        frozen += one.is_frozen ? 1 : 0;
        frozen_touched += one.is_frozen && one.touches ? 1 : 0;
        passed += one.state == BoardState::finished ? 1 : 0;
        slowed += one.is_slowed ? 1 : 0;
        left_cap += one.stop.reason == StopReason::left_cap ? 1 : 0;
        left_limits += one.stop.reason == StopReason::left_limits ? 1 : 0;
        left_reach += one.left_reach ? 1 : 0;
        breaches += one.breaches;
        uncovered += one.uncovered;
        refused_cap += one.refused_cap;
        samples += one.samples;
        refused += one.refused;
        for (std::size_t n = 0; n < wire.permits.size(); ++n) {
            wire.permits[n] += one.wire.permits[n];
        }
        wire.late += one.wire.late;
        wire.twice += one.wire.twice;
        wire.lost += one.wire.lost;
        if (one.has_moved) {
            least_mm = std::min(least_mm, one.least_mm);
        }
        if (one.state == BoardState::stopped) {
            rest_mm.push_back(one.rest_mm);
        }
        if (one.caught_after > 0) {
            caught_after.push_back(one.caught_after);
        }
    }
};

/// Of `seed`, seed + 1 and so on: each approach has a seed of its own.
inline ApproachTally run_approaches(std::uint64_t seed, std::uint64_t count, Wrong wrong, Aim aim) {
    ApproachScene scene;
    const Machine as_made = scene.loaded.machine;
    ApproachTally tally;
    for (std::uint64_t i = 0; i < count; ++i) {
        const ApproachOutcome one = ApproachRun(scene, seed + i, wrong, aim).play();
        scene.loaded.machine = as_made;
        tally.add(one);
        const bool is_frozen = wrong == Wrong::frozen;
        const bool is_red = one.touches || one.breaches > 0 ||
                            (one.stop.reason == StopReason::left_limits && !is_frozen);
        if (is_red && (wrong == Wrong::nothing || is_frozen)) {
            std::printf("touches, leaves its limits or breaks its cap: AXG_SEED=%llu AXG_COUNT=1\n",
                        static_cast<unsigned long long>(seed + i));
        }
    }
    return tally;
}

inline void print(const char* name, ApproachTally t) {
    const auto u = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::sort(t.rest_mm.begin(), t.rest_mm.end());
    std::sort(t.caught_after.begin(), t.caught_after.end());
    std::printf(
        "%s: %llu approaches, %llu moved, %llu touch, %llu stopped, %llu at their end, %llu "
        "slowed; least %.4f mm, at rest %.2f mm (median)\n",
        name, u(t.approaches), u(t.moved), u(t.touched), u(t.stopped), u(t.passed), u(t.slowed),
        t.least_mm, t.rest_mm.empty() ? 0 : t.rest_mm[t.rest_mm.size() / 2]);
    std::printf("  %llu samples; permits with n = 1 to 15:", u(t.samples));
    for (std::size_t n = 1; n < t.wire.permits.size(); ++n) {
        std::printf(" %llu", u(t.wire.permits[n]));
    }
    std::printf("; late %llu, twice %llu; frames lost %llu, refused %llu, for rule (iii) %llu\n",
                u(t.wire.late), u(t.wire.twice), u(t.wire.lost), u(t.refused), u(t.refused_cap));
    if (t.left_cap > 0 || t.uncovered > 0) {
        const auto within = std::upper_bound(t.caught_after.begin(), t.caught_after.end(), 16U);
        std::printf(
            "  left_cap %llu, of %zu that were too fast %zu within 16 samples, median %llu, "
            "last %llu; permits against rule (iii) %llu\n",
            u(t.left_cap), t.caught_after.size(),
            static_cast<std::size_t>(within - t.caught_after.begin()),
            t.caught_after.empty() ? 0 : u(t.caught_after[t.caught_after.size() / 2]),
            t.caught_after.empty() ? 0 : u(t.caught_after.back()), u(t.uncovered));
    }
}

}  // namespace axg::test
