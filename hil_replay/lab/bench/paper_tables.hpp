// SPDX-License-Identifier: Apache-2.0
// The seed paper's two tables of times, all 56 figures: eight pairs of its own machine on its CPU
// and on a Tesla K20c. Source: Siao, Lin, Chien, Chang, Intelligent Automation & Soft Computing
// 29(2), 2021, tables 2 and 3. Its shapes are not published; ours have its numbers of triangles.
#pragma once

#include <array>
#include <string_view>

namespace axg {

/// us
struct Spread {
    double average = 0, least = 0, most = 0;
};

struct PaperRow {
    std::string_view pair;
    Spread cpu, gpu;
    double speed_up = 0;  // CPU over GPU, of the averages, as the paper prints it
};

inline constexpr std::array<PaperRow, 8> kPaperRows = {{
    {"z-y", {8323.44, 4949.18, 18169.06}, {256.29, 140.12, 537.57}, 32.47},
    {"z-a", {12729.96, 6721.09, 24505.73}, {306.24, 199.27, 695.53}, 41.56},
    {"z-c", {39336, 13095.01, 48574}, {1082, 388.16, 1407.63}, 36.35},
    {"z-x", {11198.24, 6105.13, 22214.41}, {327.54, 179.68, 688.24}, 34.18},
    {"cutter-a", {31290, 15576.16, 40528}, {762.17, 508.21, 1165.77}, 41.05},
    {"cutter-c", {89698, 39336, 108174}, {2260.53, 1287.31, 3108.75}, 39.68},
    {"cutter-y", {22895.64, 19203.72, 33078}, {648.92, 498.83, 986.98}, 35.28},
    {"cutter-x", {14562.96, 9691.56, 23376.91}, {401.46, 302.69, 781.43}, 36.27},
}};
inline constexpr double kPaperSpeedUp = 37.1;  // the mean that the paper states

/// Sums over the eight pairs: of the averages, of the least and of the longest times.
[[nodiscard]] constexpr Spread paper_sum(Spread PaperRow::*times) noexcept {
    Spread sum;
    for (const PaperRow& row : kPaperRows) {
        sum.average += (row.*times).average;
        sum.least += (row.*times).least;
        sum.most += (row.*times).most;
    }
    return sum;
}

}  // namespace axg
