// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/place_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace axg::chart {
namespace {

constexpr std::array<double, 9> kAwayPx = {4, 10, 18, 28, 40, 55, 75, 100, 130};
constexpr int kDirections = 24;
constexpr double kLeaderPx = 14;  // beyond it, a line from mark to text is needed

LabelBox box_of(const Label& label) {
    return {label.text_left, label.text_mid - label.height / 2, label.text_left + label.width,
            label.text_mid + label.height / 2};
}

double overlap(const LabelBox& a, const LabelBox& b) {
    const double wide = std::min(a.right, b.right) - std::max(a.left, b.left);
    const double high = std::min(a.top, b.top) - std::max(a.bottom, b.bottom);
    return wide > 0 && high > 0 ? wide * high : 0;
}

/// Area of `box` outside the frame.
double outside(const LabelBox& box, const LabelBox& frame) {
    return (box.right - box.left) * (box.top - box.bottom) - overlap(box, frame);
}

/// Moves the label's box around the mark, its nearest point about `away` px from the mark's centre.
void put(Label& label, int direction, double away) {
    constexpr double kTurn = 6.283185307179586 / kDirections;
    const double c = std::cos(direction * kTurn), s = std::sin(direction * kTurn);
    const double mid_x = label.x + away * c + label.width / 2 * std::clamp(2 * c, -1.0, 1.0);
    label.text_left = mid_x - label.width / 2;
    label.text_mid = label.y + away * s + label.height / 2 * std::clamp(2 * s, -1.0, 1.0);
}

/// Overlap of `box` with all `taken` boxes, plus twice its area outside the frame.
double fault_of(const LabelBox& box, const LabelBox& frame, const std::vector<LabelBox>& taken) {
    double fault = 2 * outside(box, frame);
    for (const LabelBox& other : taken) {
        fault += overlap(box, other);
    }
    return fault;
}

double distance(const LabelBox& box, double x, double y) {
    return std::hypot(std::max({box.left - x, x - box.right, 0.0}),
                      std::max({box.bottom - y, y - box.top, 0.0}));
}

/// Whether another mark is about as near to the label as its own.
bool is_near_another(const std::vector<Label>& labels, const Label& label) {
    const LabelBox box = box_of(label);
    const double own = distance(box, label.x, label.y);
    return std::any_of(labels.begin(), labels.end(), [&](const Label& other) {
        return (other.x != label.x || other.y != label.y) &&
               distance(box, other.x, other.y) < own + kLeaderPx;
    });
}

}  // namespace

void place_labels(std::vector<Label>& labels, const LabelBox& frame, double mark_radius,
                  std::span<const LabelBox> taken) {
    std::vector<LabelBox> occupied(taken.begin(), taken.end());
    for (const Label& mark : labels) {
        occupied.push_back({mark.x - mark_radius, mark.y - mark_radius, mark.x + mark_radius,
                            mark.y + mark_radius});
    }
    const auto crowd = [&labels](std::size_t i) {
        double sum = 0;
        for (const Label& other : labels) {
            sum += 1 / (20 + std::hypot(other.x - labels[i].x, other.y - labels[i].y));
        }
        return sum;
    };
    std::vector<std::size_t> order(labels.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&crowd](std::size_t a, std::size_t b) { return crowd(a) > crowd(b); });
    for (const std::size_t i : order) {
        Label best = labels[i];
        double least = HUGE_VAL;
        for (const double away : kAwayPx) {
            for (int direction = 0; direction < kDirections && least > 0; ++direction) {
                put(labels[i], direction, mark_radius + away);
                const double fault = fault_of(box_of(labels[i]), frame, occupied);
                if (fault < least) {
                    least = fault;
                    best = labels[i];
                    best.is_away = away > kLeaderPx;
                }
            }
        }
        labels[i] = best;
        labels[i].is_away = best.is_away || is_near_another(labels, best);
        occupied.push_back(box_of(best));
    }
}

}  // namespace axg::chart
