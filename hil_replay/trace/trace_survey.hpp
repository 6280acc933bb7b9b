// SPDX-License-Identifier: Apache-2.0
// Surveys a recorded bus: each identifier with its rate, jitter and gaps, and the motion of the
// axes of a machine. us, mm, rad.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

/// A gap is a pause this many times as long as the median period.
inline constexpr std::int64_t kGapPeriods = 5;

/// One identifier. Periods are between a frame and the one before it.
struct IdSurvey {
    std::uint64_t frames = 0, gaps = 0;
    std::uint8_t bytes_min = 64, bytes_max = 0;
    std::int64_t first_us = 0, last_us = 0;
    std::int64_t period_us_median = 0, period_us_p1 = 0, period_us_p99 = 0;
    std::int64_t longest_us = 0, longest_at_us = 0;  // the longest pause, and when it began
};

/// An identifier and its kind of frame; all error frames are one kind.
struct IdKey {
    bool is_error = false, is_extended = false, is_remote = false, is_fd = false;
    std::uint32_t id = 0;
    friend auto operator<=>(const IdKey&, const IdKey&) = default;
};

/// "1A0", "0000031A fd", "error".
[[nodiscard]] std::string name_of(const IdKey& key);
/// 0 of a single frame.
[[nodiscard]] double per_second(const IdSurvey& survey);

struct AxisSurvey {
    double least = 0, most = 0, last = 0;
    double speed_max = 0;  // from snapshot to snapshot
};

/// A value of the axis as people read it: mm or degrees.
[[nodiscard]] double shown_value(const Axis& axis, double value);

struct SnapshotSurvey {
    std::uint64_t snapshots = 0, samples_lost = 0;
    ReceiverCounters counters;
    std::array<AxisSurvey, kAxesMax> axes{};
    std::vector<std::uint16_t> tools;  // in the order in which they first came
};

/// Fed frame by frame. Memory: 8 bytes a frame, for the medians are exact.
class TraceSurvey {
  public:
    /// @param machine  null: only identifiers; else it must outlive the survey
    explicit TraceSurvey(const Machine* machine);

    void add(const CanFrame& frame);
    /// After the last frame.
    [[nodiscard]] std::map<IdKey, IdSurvey> ids() const;
    [[nodiscard]] const SnapshotSurvey& snapshots() const noexcept { return snapshots_; }
    /// Precondition: a machine.
    [[nodiscard]] const LimitSurvey& limits() const noexcept { return *limits_; }
    [[nodiscard]] std::uint64_t frame_count() const noexcept { return frame_count_; }
    [[nodiscard]] std::int64_t first_us() const noexcept { return first_us_; }
    [[nodiscard]] std::int64_t last_us() const noexcept { return last_us_; }

  private:
    struct Times {
        IdSurvey survey;
        std::vector<std::int64_t> periods_us;
    };

    void add_snapshot(const AxisSnapshot& snapshot);

    const Machine* machine_;
    AxisReceiver receiver_;
    std::map<IdKey, Times> ids_;
    SnapshotSurvey snapshots_;
    std::optional<LimitSurvey> limits_;
    AxisSnapshot last_snapshot_{};
    std::uint64_t frame_count_ = 0;
    std::int64_t first_us_ = 0, last_us_ = 0;
};

}  // namespace axg
