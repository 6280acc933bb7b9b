// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/capped_clock.hpp"

#include <algorithm>
#include <cmath>

#include "hil_replay/motion/cell_search.hpp"

namespace axg {

namespace {

/// The speed after a step that ends on the braking curve to the end of `cell`: v^2 = out^2 +
/// 2 a (end - x), where x is the place after a step at the mean speed. 0 if no speed solves it.
double speed_on_curve(const Cell& cell, double at_mm, double speed) noexcept {
    const double slope = cell.acceleration * kMotionStepS;
    const double left_mm = cell.start_mm + cell.length_mm - at_mm;
    const double constant =
        slope * speed - cell.speed_out * cell.speed_out - 2 * cell.acceleration * left_mm;
    const double square = slope * slope - 4 * constant;
    return square <= 0 ? 0 : std::max(0.0, 0.5 * (std::sqrt(square) - slope));
}

}  // namespace

void CappedClock::begin(const std::vector<Cell>* cells,
                        const std::vector<RapidCell>* rapids) noexcept {
    cells_ = cells;
    rapids_ = rapids;
    cell_ = rapid_ = 0;
    at_mm_ = speed_ = 0;
    is_at_end_ = cells->empty();
    total_mm_ = is_at_end_ ? 0 : cells->back().start_mm + cells->back().length_mm;
}

double CappedClock::step(double speed_share) noexcept {
    if (is_at_end_) {
        return total_mm_;
    }
    const double change = (*cells_)[cell_].acceleration * kMotionStepS;
    const double wanted = speed_share * (*rapids_)[rapid_].speed;
    const auto reached_mm = [this](double speed) {
        return at_mm_ + 0.5 * (speed_ + speed) * kMotionStepS;
    };
    double speed = std::clamp(wanted, speed_ - change, speed_ + change);
    // The plan's own limits at the place after this step: the speed of its cell, and the speed from
    // which the path can still brake to the speed at the end of that cell.
    const Cell& ahead = (*cells_)[cell_at(*cells_, cell_, reached_mm(speed))];
    speed = std::min({speed, ahead.speed_max, speed_on_curve(ahead, at_mm_, speed_)});
    if (wanted <= 0 && speed <= 0) {  // at rest within the run; a later share moves it on
        at_mm_ = std::min(reached_mm(0), total_mm_);
        speed_ = 0;
        return at_mm_;
    }
    at_mm_ = reached_mm(speed);
    speed_ = speed;
    if (speed <= 0 || at_mm_ >= total_mm_) {
        is_at_end_ = true;
        return total_mm_;
    }
    cell_ = cell_at(*cells_, cell_, at_mm_);
    while (rapid_ + 1 < rapids_->size() && (*rapids_)[rapid_].end_mm <= at_mm_) {
        ++rapid_;
    }
    return at_mm_;
}

}  // namespace axg
