// SPDX-License-Identifier: Apache-2.0
// Places the labels of a crowded figure without overlap; pixels, y upwards. Greedy: each label gets
// the free place nearest to its mark, the most crowded mark first.
#pragma once

#include <span>
#include <vector>

namespace axg::chart {

struct LabelBox {
    double left = 0, bottom = 0, right = 0, top = 0;
};

struct Label {
    double x = 0, y = 0;                 // the mark
    double width = 0, height = 0;        // of the label's text
    double text_left = 0, text_mid = 0;  // out: left end and middle height of the text
    bool is_away = false;                // out: needs a line from the mark to the text
};

/// Places every label inside `frame`, off the marks, the occupied boxes `taken` and other labels
/// where possible. Cost: labels * (labels + occupied boxes) * 216 candidate places.
void place_labels(std::vector<Label>& labels, const LabelBox& frame, double mark_radius,
                  std::span<const LabelBox> taken);

}  // namespace axg::chart
