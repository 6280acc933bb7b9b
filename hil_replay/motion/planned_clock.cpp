// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/planned_clock.hpp"

#include <algorithm>
#include <cmath>

#include "hil_replay/motion/cell_search.hpp"

namespace axg {

namespace {

constexpr double kSpeedSlack = 1e-9;  // of a speed: rounding is no excess

double start_of(const Piece& piece) noexcept {
    return static_cast<double>(piece.start) * kMmPerPathUnit;
}

double end_of(const Piece& piece) noexcept {
    return static_cast<double>(piece.start + piece.length) * kMmPerPathUnit;
}

/// The largest speed after a step from which the next steps can brake to `least` at `end_mm`.
double speed_towards(double end_mm, double least, double acceleration, double at_mm,
                     double speed) noexcept {
    const double slope = acceleration * kMotionStepS;
    const double left_mm = end_mm - at_mm;
    const double constant = slope * speed - least * least - 2 * acceleration * left_mm;
    const double square = slope * slope - 4 * constant;
    return square <= 0 ? least : std::max(least, 0.5 * (std::sqrt(square) - slope));
}

}  // namespace

void PlannedClock::begin(const Run* run, const MotionLimits& limits,
                         const std::vector<Cell>* cells) noexcept {
    run_ = run;
    cells_ = cells;
    axes_ = limits.axis_count;
    window_s_ = limits.smooth_s + 3 * kMotionStepS;
    cell_ = piece_ = 0;
    at_mm_ = speed_ = 0;
    is_at_end_ = cells->empty();
    total_mm_ = is_at_end_ ? 0 : cells->back().start_mm + cells->back().length_mm;
}

/// Visits every piece in the averaging window, and those ahead up to where the path could stop.
template <class Visit>
void PlannedClock::visit_ahead(const AxisShares& shares, Visit&& visit) noexcept {
    const std::vector<Piece>& pieces = run_->pieces;
    while (piece_ + 1 < pieces.size() &&
           end_of(pieces[piece_]) + pieces[piece_].speed * window_s_ <= at_mm_) {
        ++piece_;
    }
    std::size_t cell = cell_;
    double acceleration = (*cells_)[cell].acceleration;
    const double fastest = speed_ + acceleration * kMotionStepS;
    for (std::size_t i = piece_; i < pieces.size(); ++i) {
        const Piece& piece = pieces[i];
        const double start_mm = start_of(piece), end_mm = end_of(piece);
        for (; cell + 1 < cells_->size() && (*cells_)[cell + 1].start_mm < start_mm; ++cell) {
            acceleration = std::min(acceleration, (*cells_)[cell + 1].acceleration);
        }
        const double brake_mm = 0.5 * fastest * fastest / acceleration;
        if (start_mm - fastest * window_s_ > at_mm_ + brake_mm) {
            return;
        }
        double most = piece.speed;
        for (std::uint32_t axis = 0; axis < axes_; ++axis) {
            const double per_mm = piece.share_per_mm[axis];
            most = per_mm > 0 ? std::min(most, shares.wanted[axis] / per_mm) : most;
        }
        if (at_mm_ < end_mm + std::max(most, std::min(fastest, piece.speed)) * window_s_) {
            visit(piece, Place{start_mm, end_mm, most, acceleration});
        }
    }
}

/// The largest speed, up to `speed`, that obeys the shares in every piece. A piece's limit applies
/// from the averaging distance at this limit before the piece to the same distance after it.
double PlannedClock::speed_within(const AxisShares& shares, double speed) noexcept {
    visit_ahead(shares, [&](const Piece&, const Place& place) {
        const double from_mm = place.start_mm - place.most * window_s_;
        speed = std::min(
            speed, at_mm_ >= from_mm
                       ? place.most
                       : speed_towards(from_mm, place.most, place.acceleration, at_mm_, speed_));
    });
    return speed;
}

void PlannedClock::note_needs(AxisShares& shares) noexcept {
    visit_ahead(shares, [&](const Piece& piece, const Place& place) {
        const auto speed_after = [&](double way_mm) {
            const double square =
                speed_ * speed_ - 2 * place.acceleration * std::max(0.0, way_mm - at_mm_);
            return std::min(std::sqrt(std::max(0.0, square)), piece.speed);
        };
        double speed = speed_after(place.start_mm - place.most * window_s_);
        if (speed > place.most * (1 + kSpeedSlack)) {  // too fast to brake to the limit in time
            speed = speed_after(place.start_mm - speed_ * window_s_);
        }
        for (std::uint32_t axis = 0; axis < axes_; ++axis) {
            shares.needed[axis] =
                std::max(shares.needed[axis], speed * double{piece.share_per_mm[axis]});
        }
    });
}

double PlannedClock::step(AxisShares& shares) noexcept {
    if (is_at_end_) {
        return total_mm_;
    }
    const double change = (*cells_)[cell_].acceleration * kMotionStepS;
    const double wanted = speed_within(shares, speed_ + change);
    const auto reached_mm = [this](double speed) {
        return at_mm_ + 0.5 * (speed_ + speed) * kMotionStepS;
    };
    double speed = std::max(wanted, speed_ - change);
    // The plan's own limits at the place after this step.
    const Cell& ahead = (*cells_)[cell_at(*cells_, cell_, reached_mm(speed))];
    const double planned =
        std::min({speed, ahead.speed_max,
                  speed_towards(ahead.start_mm + ahead.length_mm, ahead.speed_out,
                                ahead.acceleration, at_mm_, speed_)});
    if (wanted <= 0 && speed <= 0) {  // at rest within the run; later shares move it on
        at_mm_ = std::min(reached_mm(0), total_mm_);
        speed_ = 0;
        note_needs(shares);
        return at_mm_;
    }
    at_mm_ = reached_mm(planned);
    speed_ = planned;
    if (planned <= 0 || at_mm_ >= total_mm_) {
        is_at_end_ = true;
        return total_mm_;
    }
    cell_ = cell_at(*cells_, cell_, at_mm_);
    note_needs(shares);
    return at_mm_;
}

}  // namespace axg
