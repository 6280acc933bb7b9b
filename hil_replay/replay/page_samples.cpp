// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/page_samples.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastColumn = 1;  // "clearance_mm", by which a row chooses its sample

double shown_unit(const Axis& axis) {
    return axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
}

/// mm/s or degrees/s; an endless axis goes the short way round.
double speed_of(const Axis& axis, double from, double to, double seconds) {
    double way = to - from;
    if (axis.unlimited) {
        way = std::remainder(way, 2.0 * kPi);
    }
    return seconds > 0 ? way / seconds * shown_unit(axis) : kNothing;
}

/// `b` came after `a`. Each row has its own clearance at kLeastColumn.
void merge(std::span<const PageColumn> columns, std::span<double> a, std::span<const double> b) {
    const bool takes_b = b[kLeastColumn] < a[kLeastColumn];
    for (std::size_t i = 0; i < columns.size(); ++i) {
        switch (columns[i].keep) {
            case Keep::least:
                a[i] = std::fmin(a[i], b[i]);  // of a number and none: the number
                break;
            case Keep::most:
                a[i] = std::fmax(a[i], b[i]);
                break;
            case Keep::shown:
                a[i] = takes_b ? b[i] : a[i];
                break;
        }
    }
}

}  // namespace

PageSamples::PageSamples(const Machine& machine, std::size_t rows_max)
    : machine_(machine), rows_max_(rows_max) {
    columns_ = {{"time_s", Keep::shown},     {"clearance_mm", Keep::least}, {"pair", Keep::shown},
                {"triangle_a", Keep::shown}, {"triangle_b", Keep::shown},   {"tool", Keep::shown},
                {"permit", Keep::least},     {"cycle_us", Keep::most},      {"level", Keep::least}};
    for (const Axis& axis : machine.axes) {
        const char* unit = axis.kind == AxisKind::rotary ? "deg" : "mm";
        columns_.push_back({axis.name + "_" + unit, Keep::shown});
        columns_.push_back({axis.name + "_least_" + unit, Keep::least});
        columns_.push_back({axis.name + "_most_" + unit, Keep::most});
        columns_.push_back({axis.name + "_least_" + unit + "_s", Keep::least});
        columns_.push_back({axis.name + "_most_" + unit + "_s", Keep::most});
    }
    for (std::size_t i = 0; i < machine.pairs.size(); ++i) {
        columns_.push_back({"pair_" + std::to_string(i) + "_mm", Keep::least});
    }
    next_.reserve(columns_.size());
}

void PageSamples::add(const AxisSnapshot& snapshot, const PageCycle& cycle,
                      const PageClearances& clearances) {
    double least_mm = kNotNear;
    for (const double mm : clearances.mm) {
        least_mm = std::min(least_mm, mm);
    }
    const bool has_pair = clearances.pair != kNoIndex;
    next_ = {static_cast<double>(snapshot.arrived_us) * 1e-6,
             least_mm,
             has_pair ? clearances.pair : kNothing,
             has_pair ? clearances.triangles.a : kNothing,
             has_pair ? clearances.triangles.b : kNothing,
             static_cast<double>(snapshot.tool),
             cycle.has_permit ? 1.0 : 0.0,
             cycle.spent_ns != 0 ? static_cast<double>(cycle.spent_ns) * 1e-3 : kNothing,
             static_cast<double>(cycle.clearance_level)};
    const double seconds = static_cast<double>(snapshot.latched_us - last_.latched_us) * 1e-6;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        const Axis& axis = machine_.axes[i];
        const double at = snapshot.position[i] * shown_unit(axis);
        const double speed = samples_ == 0
                                 ? kNothing
                                 : speed_of(axis, last_.position[i], snapshot.position[i], seconds);
        next_.insert(next_.end(), {at, at, at, speed, speed});
    }
    next_.insert(next_.end(), clearances.mm.begin(), clearances.mm.end());
    next_.resize(columns_.size(), kNotNear);
    last_ = snapshot;
    put(next_);
}

void PageSamples::put(std::span<const double> values) {
    const std::uint64_t place = samples_++;
    if (place % stride_ != 0) {
        merge(columns_, {values_.data() + (rows() - 1) * columns_.size(), columns_.size()}, values);
        return;
    }
    if (rows() == rows_max_) {
        halve();
        // As many samples as there is room for fill the rows evenly, so this one begins a row.
    }
    values_.insert(values_.end(), values.begin(), values.end());
}

void PageSamples::halve() {
    const std::size_t width = columns_.size(), kept = rows() / 2;
    for (std::size_t i = 0; i < kept; ++i) {
        double* to = values_.data() + i * width;
        std::copy_n(values_.data() + 2 * i * width, width, to);
        merge(columns_, {to, width}, row(2 * i + 1));
    }
    values_.resize(kept * width);
    stride_ *= 2;
}

}  // namespace axg
