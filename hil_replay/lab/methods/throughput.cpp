// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/methods/throughput.hpp"

#include <algorithm>
#include <chrono>
#include <random>

namespace axg::lab {
namespace {

using Random = std::mt19937_64;

/// Own code, because the distributions of the standard libraries differ.
float between(Random& random, double low, double high) {
    return static_cast<float>(low +
                              (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53));
}

Vec3f some_point(Random& random, double size) {
    const float x = between(random, -size, size), y = between(random, -size, size);
    return {x, y, between(random, -size, size)};
}

bool boxes_overlap(const Pair<float>& p) {
    for (float Vec3f::*const k : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
        const auto [low_a, high_a] = std::minmax({p.a[0].*k, p.a[1].*k, p.a[2].*k});
        const auto [low_b, high_b] = std::minmax({p.b[0].*k, p.b[1].*k, p.b[2].*k});
        if (low_b > high_a || low_a > high_b) {
            return false;
        }
    }
    return true;
}

Pair<float> overlapping_pair(Random& random) {
    for (;;) {
        Pair<float> pair;
        const Vec3f from_a = some_point(random, 100), away = some_point(random, 4);
        for (int v = 0; v < 3; ++v) {
            pair.a[v] = from_a + some_point(random, 4);
            pair.b[v] = from_a + away + some_point(random, 4);
        }
        if (boxes_overlap(pair)) {
            return pair;
        }
    }
}

double elapsed_ns(const Method& method, const PairSet& pairs, std::span<Verdict> verdicts) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    run_method(method, pairs, verdicts, {});
    const std::chrono::duration<double, std::nano> spent = Clock::now() - start;
    return spent.count();
}

}  // namespace

PairSet overlapping_pairs(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    PairSet pairs;
    pairs.reserve(count);
    while (pairs.size() < count) {
        pairs.add(overlapping_pair(random));
    }
    return pairs;
}

PairSet intersecting_pairs(std::size_t count, std::uint64_t seed) {
    const Method& judge_of_them = *find_method("sat17-f64");
    Random random(seed);
    PairSet pairs;
    pairs.reserve(count);
    while (pairs.size() < count) {
        const Pair<float> pair = overlapping_pair(random);
        PairSet one;
        one.add(pair);
        if (judge(judge_of_them, one, false).verdicts[0] == Verdict::intersecting) {
            pairs.add(pair);
        }
    }
    return pairs;
}

std::vector<PairTime> time_methods(std::span<const Method* const> methods, const PairSet& pairs,
                                   unsigned passes) {
    std::vector<std::vector<double>> samples(methods.size());
    std::vector<Verdict> verdicts(pairs.size());
    for (unsigned pass = 0; pass < passes; ++pass) {
        for (std::size_t m = 0; m < methods.size(); ++m) {
            samples[m].push_back(elapsed_ns(*methods[m], pairs, verdicts));
        }
    }
    std::vector<PairTime> times;
    for (std::vector<double>& sample : samples) {
        std::sort(sample.begin(), sample.end());
        const auto count = static_cast<double>(pairs.size());
        times.push_back({sample.front() / count, sample[sample.size() / 2] / count});
    }
    return times;
}

}  // namespace axg::lab
