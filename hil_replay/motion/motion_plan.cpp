// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace axg {
namespace {

/// A piece's limits, valid from the averaging distance before the piece to the same distance after
/// it.
struct Zone {
    double start_mm, end_mm, speed, acceleration, rapid;
};

std::vector<Zone> make_zones(const Run& run, const MotionLimits& limits) {
    // Three steps more than the window: third differences reach that far.
    const double window_s = limits.smooth_s + 3 * kMotionStepS;
    const double total_mm = static_cast<double>(run.length) * kMmPerPathUnit;
    std::vector<Zone> zones;
    zones.reserve(run.pieces.size());
    for (const Piece& piece : run.pieces) {
        const double reach_mm = piece.speed * window_s;
        const double start_mm = static_cast<double>(piece.start) * kMmPerPathUnit;
        const double length_mm = static_cast<double>(piece.length) * kMmPerPathUnit;
        zones.push_back({std::max(0.0, start_mm - reach_mm),
                         std::min(total_mm, start_mm + length_mm + reach_mm), piece.speed,
                         piece.acceleration, piece.rapid});
    }
    std::sort(zones.begin(), zones.end(),
              [](const Zone& a, const Zone& b) { return a.start_mm < b.start_mm; });
    return zones;
}

/// The least of one limit over the zones that cover a point, for points in increasing order.
class LeastOpen {
  public:
    void add(double value, double end_mm) { open_.push({value, end_mm}); }
    double at(double from_mm) {
        while (!open_.empty() && open_.top().end_mm <= from_mm) {
            open_.pop();
        }
        return open_.empty() ? 0.0 : open_.top().value;
    }

  private:
    struct Entry {
        double value, end_mm;
        bool operator<(const Entry& other) const { return value > other.value; }
    };
    std::priority_queue<Entry> open_;
};

std::vector<double> edges_of(const std::vector<Zone>& zones) {
    std::vector<double> edges;
    edges.reserve(2 * zones.size());
    for (const Zone& zone : zones) {
        edges.push_back(zone.start_mm);
        edges.push_back(zone.end_mm);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

void make_cells(const Run& run, const MotionLimits& limits, std::vector<Cell>& cells) {
    const std::vector<Zone> zones = make_zones(run, limits);
    const std::vector<double> edges = edges_of(zones);
    LeastOpen speeds, accelerations;
    std::size_t next = 0;
    cells.clear();
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        for (; next < zones.size() && zones[next].start_mm <= edges[i]; ++next) {
            speeds.add(zones[next].speed, zones[next].end_mm);
            accelerations.add(zones[next].acceleration, zones[next].end_mm);
        }
        const double speed = speeds.at(edges[i]), acceleration = accelerations.at(edges[i]);
        if (!cells.empty() && cells.back().speed_max == speed &&
            cells.back().acceleration == acceleration) {
            cells.back().length_mm = edges[i + 1] - cells.back().start_mm;
            continue;
        }
        cells.push_back({.start_mm = edges[i],
                         .length_mm = edges[i + 1] - edges[i],
                         .speed_max = speed,
                         .acceleration = acceleration});
    }
}

double reachable(double speed, const Cell& cell) {
    return std::sqrt(speed * speed + 2 * cell.acceleration * cell.length_mm);
}

/// The fastest speed inside a cell that its length, its limit and the speeds at its ends allow.
double peak_of(const Cell& cell) {
    const double squares = cell.speed_in * cell.speed_in + cell.speed_out * cell.speed_out;
    const double peak = std::sqrt(squares / 2 + cell.acceleration * cell.length_mm);
    return std::max({std::min(peak, cell.speed_max), cell.speed_in, cell.speed_out});
}

double cruise_mm(const Cell& cell, double peak) {
    const double ramps =
        (2 * peak * peak - cell.speed_in * cell.speed_in - cell.speed_out * cell.speed_out) /
        (2 * cell.acceleration);
    return std::max(0.0, cell.length_mm - ramps);
}

}  // namespace

void plan_run(const Run& run, const MotionLimits& limits, std::vector<Cell>& cells) {
    make_cells(run, limits, cells);
    double speed = 0;
    for (Cell& cell : cells) {
        cell.speed_in = std::min(speed, cell.speed_max);
        speed = std::min(cell.speed_max, reachable(cell.speed_in, cell));
    }
    speed = 0;
    for (std::size_t i = cells.size(); i-- > 0;) {
        Cell& cell = cells[i];
        cell.speed_out = std::min(speed, cell.speed_max);
        const double ahead = i + 1 < cells.size() ? cells[i + 1].speed_in : 0.0;
        cell.speed_out = std::min(cell.speed_out, ahead);
        cell.speed_in = std::min(cell.speed_in, reachable(cell.speed_out, cell));
        speed = cell.speed_in;
    }
}

void plan_rapid(const Run& run, const MotionLimits& limits, std::vector<RapidCell>& rapids) {
    const std::vector<Zone> zones = make_zones(run, limits);
    const std::vector<double> edges = edges_of(zones);
    LeastOpen speeds;
    std::size_t next = 0;
    rapids.clear();
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        for (; next < zones.size() && zones[next].start_mm <= edges[i]; ++next) {
            speeds.add(zones[next].rapid, zones[next].end_mm);
        }
        rapids.push_back({edges[i + 1], speeds.at(edges[i])});
    }
}

double cell_seconds(const Cell& cell) {
    const double peak = peak_of(cell);
    return (2 * peak - cell.speed_in - cell.speed_out) / cell.acceleration +
           cruise_mm(cell, peak) / peak;
}

void ProfileClock::begin(const std::vector<Cell>* cells) {
    cells_ = cells;
    cell_ = 0;
    time_s_ = 0;
    is_at_end_ = cells->empty();
    if (!is_at_end_) {
        start_mm_ = 0;
        enter_cell();
    }
}

void ProfileClock::enter_cell() noexcept {
    const Cell& cell = (*cells_)[cell_];
    peak_ = peak_of(cell);
    start_mm_ = cell.start_mm;
    enter_phase(0);
}

/// Returns false if the cell has no such phase.
bool ProfileClock::enter_phase(int phase) noexcept {
    const Cell& cell = (*cells_)[cell_];
    phase_ = phase;
    if (phase == 0) {
        speed_ = cell.speed_in;
        acceleration_ = cell.acceleration;
        duration_s_ = (peak_ - cell.speed_in) / cell.acceleration;
    } else if (phase == 1) {
        start_mm_ += (peak_ * peak_ - cell.speed_in * cell.speed_in) / (2 * cell.acceleration);
        speed_ = peak_;
        acceleration_ = 0;
        duration_s_ = cruise_mm(cell, peak_) / peak_;
    } else if (phase == 2) {
        start_mm_ += cruise_mm(cell, peak_);
        speed_ = peak_;
        acceleration_ = -cell.acceleration;
        duration_s_ = (peak_ - cell.speed_out) / cell.acceleration;
    }
    return phase <= 2;
}

double ProfileClock::step() noexcept {
    const Cell& last = cells_->back();
    const double total_mm = last.start_mm + last.length_mm;
    if (is_at_end_) {
        return total_mm;
    }
    time_s_ += kMotionStepS;
    while (time_s_ >= duration_s_) {
        time_s_ -= duration_s_;
        if (enter_phase(phase_ + 1)) {
            continue;
        }
        if (++cell_ == cells_->size()) {
            is_at_end_ = true;
            return total_mm;
        }
        enter_cell();
    }
    return std::min(total_mm, start_mm_ + time_s_ * (speed_ + acceleration_ * time_s_ / 2));
}

}  // namespace axg
