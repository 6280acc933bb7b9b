// SPDX-License-Identifier: Apache-2.0
// The board's last samples, endless axes unwound: how fast each axis was, and whether it rests.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct RecordedSample {
    std::uint64_t number = 0;
    std::int64_t latched_us = 0;
    std::uint8_t mode = 0;
    std::array<double, kAxesMax> position{};  // mm or rad
};

class MotionRecord {
  public:
    static constexpr std::size_t kSamples = 16384;

    explicit MotionRecord(const Machine& machine);

    void add(const AxisSnapshot& snapshot);
    void forget() noexcept { samples_.clear(); }

    [[nodiscard]] bool is_empty() const noexcept { return samples_.empty(); }
    [[nodiscard]] const RecordedSample& newest() const noexcept { return samples_.back(); }
    [[nodiscard]] const std::deque<RecordedSample>& samples() const noexcept { return samples_; }
    /// The newest sample with at most this number. Precondition: not empty.
    [[nodiscard]] const RecordedSample& at(std::uint64_t number) const noexcept;

    /// mm or rad that two reports of one place may differ by.
    [[nodiscard]] double resolution(std::size_t axis) const noexcept { return resolution_[axis]; }
    /// Mean speed from one sample to another, mm/s or rad/s.
    [[nodiscard]] double speed(std::size_t axis, std::uint64_t from,
                               std::uint64_t to) const noexcept;
    /// Whether every axis stayed within its resolution for so long.
    [[nodiscard]] bool rests(std::int64_t for_us) const noexcept;
    /// An axis that is farther than its resolution from where it was at this sample; kNoIndex:
    /// none.
    [[nodiscard]] std::uint32_t left_place(std::uint64_t since) const noexcept;

  private:
    const Machine& machine_;
    std::vector<double> resolution_;
    std::deque<RecordedSample> samples_;
};

}  // namespace axg
