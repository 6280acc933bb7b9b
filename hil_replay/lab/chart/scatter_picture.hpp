// SPDX-License-Identifier: Apache-2.0
// A figure of panels, one above the other, that share a logarithmic axis of time: one mark per
// method, its label in the nearest free place. 600 px wide, so that text appears at its drawn size;
// marks differ in shape, not only in colour.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hil_replay/plan/gnuplot.hpp"

namespace axg::chart {

enum class MarkStyle : unsigned char { ours, paper, other, other_double, predicted };

struct ScatterMark {
    double x = 0, y = 0;
    MarkStyle style = MarkStyle::other;
    std::string words{};  // empty: no label
};

struct ScatterPanel {
    std::string title, y_label;
    std::string y_ticks;  // gnuplot's list, without brackets
    double y_low = 1, y_high = 10;
    double bottom = 0, top = 1;  // shares of the figure's height
    std::vector<ScatterMark> marks{};
    std::vector<std::pair<std::size_t, std::size_t>> joined{};  // marks joined by a thin line
    std::vector<std::size_t> pareto{};  // marks that no other beats in both, from left to right
    double wall_x = 0;                  // position of a vertical line; 0: none
    std::string wall_words{};
    // Position of the arrow to the fast and exact corner, as shares of the panel.
    double better_x = 0.03, better_y = 0.03;
};

struct ScatterPicture {
    std::string name, title, x_label, x_ticks;
    double x_low = 1, x_high = 10;
    PictureSize size{600, 800, 2};
    std::vector<std::pair<MarkStyle, std::string>> legend{};
    std::vector<std::string> beneath{};  // lines under the panels
    std::vector<ScatterPanel> panels{};
};

/// Marks that no other measured mark beats in both time and height, from left to right.
[[nodiscard]] std::vector<std::size_t> pareto_of(const std::vector<ScatterMark>& marks);

/// The text of NAME.gp, which contains the marks as data.
[[nodiscard]] std::string scatter_script(const ScatterPicture& picture);

}  // namespace axg::chart
