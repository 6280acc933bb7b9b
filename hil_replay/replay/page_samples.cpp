// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/page_samples.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastColumn = 1;  // "clearance_mm", by which a row chooses its sample
constexpr std::size_t kPairColumn = 2, kToolColumn = 5, kFirstAxis = 11, kColumnsOfAxis = 5;

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

/// Merges row `b` into the earlier row `a`. Each row has its own clearance at kLeastColumn.
void merge(std::span<const PageColumn> columns, std::span<double> a, std::span<const double> b) {
    const bool takes_b = b[kLeastColumn] < a[kLeastColumn];
    for (std::size_t i = 0; i < columns.size(); ++i) {
        switch (columns[i].keep) {
            case Keep::least:
                a[i] = std::fmin(a[i], b[i]);  // of a number and NaN: the number
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

PageCycle page_cycle(bool has_permit, const CycleResult& result) {
    PageCycle cycle{.has_permit = has_permit};
    cycle.valid_periods = has_permit ? result.samples : std::uint8_t{0};
    if (result.has_cap) {
        cycle.cap = result.cap_order.cap;
    }
    return cycle;
}

PageSamples::PageSamples(const Machine& machine, std::size_t rows_max)
    : machine_(machine), rows_max_(rows_max) {
    columns_ = {
        {"time_s", Keep::shown},        {"clearance_mm", Keep::least}, {"pair", Keep::shown},
        {"triangle_a", Keep::shown},    {"triangle_b", Keep::shown},   {"tool", Keep::shown},
        {"permit", Keep::least},        {"cycle_us", Keep::most},      {"level", Keep::least},
        {"valid_periods", Keep::least}, {"cap_percent", Keep::least}};
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
             static_cast<double>(cycle.clearance_level),
             cycle.valid_periods ? *cycle.valid_periods : kNothing,
             cycle.cap ? 100.0 * *cycle.cap / kCapRapid : kNothing};
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
    note_detail(cycle.has_permit);
}

/// Stores the newest sample in the detail under way, or else in the ring.
void PageSamples::note_detail(bool has_permit) {
    const std::uint64_t sample = samples_ - 1;
    const bool is_lost = had_permit_ && !has_permit;
    had_permit_ = has_permit;
    if (sample < detail_ends_) {
        std::vector<double>& values = details_.back().values;
        values.insert(values.end(), next_.begin(), next_.end());
        return;
    }
    const std::size_t width = columns_.size();
    recent_.resize(kDetailBefore * width);
    std::copy(next_.begin(), next_.end(),
              recent_.begin() + static_cast<std::ptrdiff_t>(sample % kDetailBefore * width));
    if (is_lost && details_.size() < kDetailsMax) {
        keep_recent(kDetailBefore);
        detail_ends_ = samples_ + kDetailAfter;
    }
}

/// Adds a detail with the newest `before` samples of the ring that no other detail contains.
void PageSamples::keep_recent(std::uint64_t before) {
    const std::size_t width = columns_.size();
    Detail detail{.first = std::max(detail_ends_, samples_ - std::min(samples_, before)),
                  .values = {}};
    for (std::uint64_t i = detail.first; i < samples_; ++i) {
        const auto from = recent_.begin() + static_cast<std::ptrdiff_t>(i % kDetailBefore * width);
        detail.values.insert(detail.values.end(), from, from + static_cast<std::ptrdiff_t>(width));
    }
    details_.push_back(std::move(detail));
}

void PageSamples::finish() {
    if (samples_ > detail_ends_) {
        keep_recent(kDetailBefore);
    }
    const std::size_t width = columns_.size();
    if (stride_ == 1 || width == 0) {
        return;  // each sample has its row
    }
    std::vector<std::vector<double>> merged;
    const auto add_rows = [&](std::span<const double> values) {
        for (std::size_t at = 0; at + width <= values.size(); at += width) {
            merged.emplace_back(values.begin() + static_cast<std::ptrdiff_t>(at),
                                values.begin() + static_cast<std::ptrdiff_t>(at + width));
        }
    };
    // Details that follow one another replace a row together.
    const auto is_replaced = [&](std::uint64_t first, std::uint64_t end) {
        for (const Detail& detail : details_) {
            const std::uint64_t detail_end = detail.first + detail.values.size() / width;
            if (detail.first <= first && first < detail_end) {
                first = std::max(first, std::min(end, detail_end));
            }
        }
        return first >= end;
    };
    for (std::size_t i = 0; i < rows(); ++i) {
        const std::uint64_t first = i * stride_;
        if (!is_replaced(first, std::min(samples_, first + stride_))) {
            add_rows(row(i));
        }
    }
    for (const Detail& detail : details_) {
        add_rows(detail.values);
    }
    std::stable_sort(merged.begin(), merged.end(),
                     [](const auto& a, const auto& b) { return a.front() < b.front(); });
    values_.clear();
    for (const std::vector<double>& one : merged) {
        values_.insert(values_.end(), one.begin(), one.end());
    }
}

void PageSamples::settle(
    const std::function<PageClearances(const AxisSnapshot&, std::span<const double>)>& nearest) {
    const std::size_t width = columns_.size(), pairs = machine_.pairs.size();
    for (std::size_t i = 0; i < rows(); ++i) {
        const std::span<double> at(values_.data() + i * width, width);
        if (!(at[kLeastColumn] < kNotNear)) {
            continue;
        }
        AxisSnapshot snapshot;
        snapshot.axis_count = static_cast<std::uint32_t>(machine_.axes.size());
        snapshot.tool = static_cast<std::uint16_t>(at[kToolColumn]);
        for (std::size_t axis = 0; axis < machine_.axes.size(); ++axis) {
            snapshot.position.at(axis) =
                at[kFirstAxis + kColumnsOfAxis * axis] / shown_unit(machine_.axes[axis]);
        }
        const PageClearances found = nearest(snapshot, at.last(pairs));
        const bool has_pair = found.pair != kNoIndex;
        double least_mm = kNotNear;
        for (const double mm : found.mm) {
            least_mm = std::min(least_mm, mm);
        }
        at[kLeastColumn] = least_mm;
        at[kPairColumn] = has_pair ? found.pair : kNothing;
        at[kPairColumn + 1] = has_pair ? found.triangles.a : kNothing;
        at[kPairColumn + 2] = has_pair ? found.triangles.b : kNothing;
    }
}

void PageSamples::put(std::span<const double> values) {
    const std::uint64_t place = samples_++;
    if (place % stride_ != 0) {
        merge(columns_, {values_.data() + (rows() - 1) * columns_.size(), columns_.size()}, values);
        return;
    }
    if (rows() == rows_max_) {
        halve();
        // rows_max_ is even, so the samples fill the merged rows and this one begins a new row.
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
