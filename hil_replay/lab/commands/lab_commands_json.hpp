// SPDX-License-Identifier: Apache-2.0
// The documents that accuracy, chart and query write with --json, as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/lab/methods/method.hpp"
#include "hil_replay/lab/methods/throughput.hpp"

namespace axg {

/// The document of accuracy --list: every method.
[[nodiscard]] std::string describe_methods();

/// Results of accuracy --time: each method on the same pairs.
struct TimedMethods {
    std::size_t pairs = 0;
    unsigned passes = 0;
    const std::vector<const lab::Method*>& methods;
    const std::vector<lab::PairTime>&overlapping, &intersecting;
};
[[nodiscard]] std::string describe_times(const TimedMethods& times);

struct AccuracyCounts {
    std::size_t separated = 0, intersecting = 0, undecided = 0, rejected = 0;
};
[[nodiscard]] std::string describe_accuracy(const std::string& cases, const lab::Method& method,
                                            std::size_t count, const AccuracyCounts& counts);

struct ChartDocument {
    struct Entry {
        std::string figure;
        bool is_drawn = false;
        std::string summary;  // Figure::summary
    };
    std::uint64_t seed = 1;
    bool is_quick = false;
    std::vector<Entry> figures;
};
[[nodiscard]] std::string describe_chart(const ChartDocument& chart);

struct QueryReport {
    std::size_t poses = 0, pairs = 0;
    std::string engine, lanes, kind;
    std::size_t hits = 0, over_capacity = 0;
    std::size_t contained = 0;  // of the hits: apart, and one inside the other
    unsigned passes = 0;        // 0: not timed
    double cycle_us_median = 0, cycle_us_p99 = 0, cycle_us_max = 0;
};
[[nodiscard]] std::string describe_queries(const QueryReport& report);

}  // namespace axg
