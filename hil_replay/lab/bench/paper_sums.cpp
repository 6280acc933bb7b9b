// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/paper_sums.hpp"

#include <algorithm>
#include <utility>

namespace axg {
namespace {

Spread spread_of(const std::vector<double>& values) {
    Spread s{0, values.front(), values.front()};
    for (const double value : values) {
        s.average += value;
        s.least = std::min(s.least, value);
        s.most = std::max(s.most, value);
    }
    s.average /= static_cast<double>(values.size());
    return s;
}

}  // namespace

Spread of_pair(const PaperBenchmark& benchmark, const PaperSeries& series, std::size_t pair) {
    std::vector<double> us;
    for (std::size_t i = pair; i < series.us.size(); i += benchmark.pairs.size()) {
        us.push_back(series.us[i]);
    }
    return spread_of(us);
}

Spread of_pose(const PaperBenchmark& benchmark, const PaperSeries& series) {
    std::vector<double> us(benchmark.pose_count(), 0.0);
    for (std::size_t i = 0; i < series.us.size(); ++i) {
        us[i / benchmark.pairs.size()] += series.us[i];
    }
    return spread_of(us);
}

double per_pose(const PaperBenchmark& benchmark, const PaperSeries& series,
                std::uint32_t paper::Found::*count) {
    double sum = 0;
    for (const paper::Found& found : series.found) {
        sum += found.*count;
    }
    return sum / static_cast<double>(benchmark.pose_count());
}

std::size_t hits_of(const PaperSeries& series) {
    return static_cast<std::size_t>(
        std::count_if(series.found.begin(), series.found.end(),
                      [](const paper::Found& found) { return found.touching != 0; }));
}

std::string name_of(const paper::Techniques& t) {
    const std::pair<bool, const char*> parts[] = {{t.boxes, "boxes"},
                                                  {t.interchange, "interchange"},
                                                  {t.unroll, "unroll"},
                                                  {t.prefetch, "prefetch"},
                                                  {t.carry, "carry"}};
    if (t.coalesced) {
        return "coalesced";
    }
    std::string on, off;
    int count = 0;
    for (const auto& [is_on, name] : parts) {
        (is_on ? on : off) += std::string((is_on ? on : off).empty() ? "" : ", ") + name;
        count += is_on ? 1 : 0;
    }
    return count == 0 ? "none" : count == 5 ? "all" : count == 4 ? "all but " + off : on;
}

std::vector<const PaperSeries*> all_series(const PaperBenchmark& benchmark) {
    std::vector<const PaperSeries*> all;
    for (const std::vector<PaperSeries>* const list :
         {&benchmark.cpu, &benchmark.gpu, &benchmark.together}) {
        for (const PaperSeries& series : *list) {
            all.push_back(&series);
        }
    }
    return all;
}

}  // namespace axg
