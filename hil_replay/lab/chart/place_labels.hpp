// SPDX-License-Identifier: Apache-2.0
// Where the words beside the marks of a crowded picture go, so that none lies on another: pixels,
// y upwards. Greedy: each takes the free place nearest to its mark, the most crowded mark first.
#pragma once

#include <span>
#include <vector>

namespace axg::chart {

struct LabelBox {
    double left = 0, bottom = 0, right = 0, top = 0;
};

struct Label {
    double x = 0, y = 0;                 // the mark
    double width = 0, height = 0;        // of the words
    double text_left = 0, text_mid = 0;  // out: left end and middle height of the words
    bool is_away = false;                // out: so far off that a line should lead there
};

/// Places every label inside `frame`, off the marks, off what is `taken` and off each other where
/// there is room. Cost: labels times (labels + taken) times some two hundred candidate places.
void place_labels(std::vector<Label>& labels, const LabelBox& frame, double mark_radius,
                  std::span<const LabelBox> taken);

}  // namespace axg::chart
