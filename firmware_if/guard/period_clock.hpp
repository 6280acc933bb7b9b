// SPDX-License-Identifier: Apache-2.0
// The end of each guard period: an absolute schedule on the monotonic clock. It continues without
// frames, and moves towards the board's snapshots too slowly for any sender to delay it. Snapshots
// arrive in the middle of the time that their evaluation leaves of the period, so that neither
// arrival nor result falls close to its end.
#pragma once

#include <algorithm>
#include <cstdint>

namespace axg {

class PeriodClock {
  public:
    /// @param response_us  longest time of an evaluation
    PeriodClock(std::int64_t period_us, std::int64_t response_us, std::int64_t now_us) noexcept
        : period_us_(period_us),
          slack_us_(std::max<std::int64_t>(0, (period_us - response_us) / 2)),
          next_us_(now_us + period_us) {}

    [[nodiscard]] std::int64_t next_us() const noexcept { return next_us_; }
    void advance() noexcept {
        next_us_ += period_us_;
        has_snapshot_ = false;
    }
    /// After a gap: the missed periods are not made up for.
    void restart(std::int64_t now_us) noexcept { next_us_ = now_us + period_us_; }

    /// The period has its sample.
    void take_snapshot() noexcept { has_snapshot_ = true; }
    [[nodiscard]] bool has_snapshot() const noexcept { return has_snapshot_; }

    /// A snapshot was complete at this instant.
    /// @param may_jump  no permit was issued yet, and no period was good: may move at once
    void follow(std::int64_t arrived_us, bool may_jump) noexcept {
        std::int64_t off_us = (arrived_us - slack_us_ - next_us_) % period_us_;
        off_us += off_us < -period_us_ / 2 ? period_us_ : 0;
        off_us -= off_us > period_us_ / 2 ? period_us_ : 0;
        const std::int64_t most_us = period_us_ / kLeanShare;
        const bool jumps = may_jump && std::abs(off_us) > period_us_ / 4;
        next_us_ += jumps ? off_us : std::clamp(off_us / 4, -most_us, most_us);
    }

    /// Whether a snapshot before the end may end the period. Never twice in a row: the end would
    /// run away from the clock, and a missing snapshot would be detected late.
    [[nodiscard]] bool may_end(std::int64_t arrived_us) const noexcept {
        return next_us_ - arrived_us < period_us_;
    }

    /// The arrival is nearer to the one expected in the next period than to that in this one. After
    /// a loss, or with less load on the bus, a snapshot may be complete before its period.
    [[nodiscard]] bool is_of_next(std::int64_t arrived_us) const noexcept {
        return next_us_ - arrived_us < period_us_ / 2 - slack_us_;
    }

  private:
    static constexpr std::int64_t kLeanShare = 50;  // of a period, at most, with each snapshot

    std::int64_t period_us_, slack_us_, next_us_;
    bool has_snapshot_ = false;
};

}  // namespace axg
