// SPDX-License-Identifier: Apache-2.0
// Samples of a run for a page, in bounded memory: at most a stated number of rows, each of equally
// many consecutive samples, with the least and the most of every column; and a row for each sample
// around a loss of the permit. mm, degrees, s, us.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/guard/margin_state.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// How samples that share a row merge their values of a column.
enum class Keep : std::uint8_t { least, most, shown };  // shown: of the sample of least clearance

struct PageColumn {
    std::string name;
    Keep keep = Keep::shown;
};

/// The certified clearances of one sample.
struct PageClearances {
    std::span<const double> mm;     // [pairs]; kNotNear: farther than was queried, or not queried
    std::uint32_t pair = kNoIndex;  // the nearest
    TriangleIds triangles{};        // that set its clearance
};
inline constexpr double kNotNear = std::numeric_limits<double>::infinity();

/// Result of a cycle.
struct PageCycle {
    bool has_permit = false;
    std::int64_t spent_ns = 0;  // 0: not measured
    ClearanceLevel clearance_level = ClearanceLevel::clear;
    // Periods for which the permit is proven, 0: there is none; and the cap that it orders, 1/250
    // of rapid. Empty: unknown, or no cap is ordered.
    std::optional<std::uint8_t> valid_periods{};
    std::optional<std::uint8_t> cap{};
};

/// Includes the validity and the cap of this result's permit.
[[nodiscard]] PageCycle page_cycle(bool has_permit, const CycleResult& result);

// Around the first losses of the permit, and the end of the run, this many samples before and after
// have one row each.
inline constexpr std::size_t kDetailBefore = 256, kDetailAfter = 64, kDetailsMax = 16;

class PageSamples {
  public:
    /// @param rows_max  even; detailed rows not counted
    PageSamples(const Machine& machine, std::size_t rows_max);

    /// Call in order of time. `machine` must still exist.
    void add(const AxisSnapshot& snapshot, const PageCycle& cycle,
             const PageClearances& clearances);
    /// Call after the last sample: inserts the detailed rows by time, and removes each row that
    /// they replace completely.
    void finish();
    /// Queries each row's shown sample again: the clearance, the pair and its triangles.
    /// @param nearest  receives that sample and the row's clearances, [pairs]
    void settle(
        const std::function<PageClearances(const AxisSnapshot&, std::span<const double>)>& nearest);

    [[nodiscard]] std::span<const PageColumn> columns() const noexcept { return columns_; }
    [[nodiscard]] std::size_t rows() const noexcept {
        return columns_.empty() ? 0 : values_.size() / columns_.size();
    }
    /// [columns] of one row. Not a number: no value.
    [[nodiscard]] std::span<const double> row(std::size_t i) const noexcept {
        return {values_.data() + i * columns_.size(), columns_.size()};
    }
    [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
    /// Samples a row; the last row may have fewer, and a detailed row has one.
    [[nodiscard]] std::uint64_t stride() const noexcept { return stride_; }

  private:
    /// Samples that have a row each: `first` and those after it.
    struct Detail {
        std::uint64_t first = 0;
        std::vector<double> values;
    };

    void put(std::span<const double> values);
    void halve();
    void note_detail(bool has_permit);
    void keep_recent(std::uint64_t before);

    const Machine& machine_;
    std::size_t rows_max_;
    std::vector<PageColumn> columns_;
    std::vector<double> values_, next_;  // row by row; the row of the sample under way
    std::uint64_t samples_ = 0, stride_ = 1;
    std::vector<double> recent_;  // the last kDetailBefore samples, a ring
    std::vector<Detail> details_;
    std::uint64_t detail_ends_ = 0;  // sample
    bool had_permit_ = false;
    AxisSnapshot last_;
};

}  // namespace axg
