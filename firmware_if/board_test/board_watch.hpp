// SPDX-License-Identifier: Apache-2.0
// Rules that a board has to follow the whole time, judged from every frame of it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>

#include "core/machine/machine.hpp"
#include "firmware_if/board_test/board_cases.hpp"
#include "firmware_if/board_test/motion_record.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

struct WatchedState {
    bool is_judged = false;
    std::uint64_t faults = 0;
    std::string found;       // the first fault
    std::int64_t at_us = 0;  // of the frame that showed it
};

/// Figures of the board's SYNC as this computer received it, delays of bus and computer included.
struct SyncFigures {
    std::uint64_t samples = 0;
    double mean_us = 0;        // period
    double jitter_us_max = 0;  // off the period
};

class BoardWatch {
  public:
    BoardWatch(const Machine& machine, CapPromise cap) noexcept : machine_(machine), cap_(cap) {}

    /// Counts a violation of a rule; stores the text of the first one of each rule.
    void fail(Watched watched, std::int64_t at_us, std::string found);
    /// Marks the rule as judged: the test included its situation.
    void note(Watched watched) noexcept { state(watched).is_judged = true; }

    /// @param measured_period_ns  ReceiverCounters::measured_period_ns
    void on_fault(const ReceiverEvent& event, std::int64_t measured_period_ns);
    void on_session(const Session& session, std::int64_t time_us);
    /// @param is_braking  the board is in a stop
    void on_sample(const ReceiverEvent& event, const MotionRecord& record, bool is_braking);
    void on_permit(const Permit& permit) noexcept;
    /// A nonce that the board had before is a fault.
    void on_new_nonce(std::uint32_t nonce, std::int64_t time_us);

    [[nodiscard]] const WatchedState& of(Watched watched) const noexcept {
        return states_[static_cast<std::size_t>(watched)];
    }
    [[nodiscard]] SyncFigures sync() const noexcept;
    /// Whether the samples are too faulty to judge any rule.
    [[nodiscard]] bool is_unusable() const noexcept {
        return has_wrong_period_ || of(Watched::samples).faults >= kSampleFaultsMax;
    }
    /// The highest cap that the newest sample may name, of this axis; 250 without an ack.
    [[nodiscard]] std::uint8_t acked_cap(std::size_t axis) const noexcept {
        return bounds_.empty() ? kPermitCapNone : bounds_.back()[axis];
    }

  private:
    static constexpr std::uint64_t kSampleFaultsMax = 20;

    using Bounds = std::array<std::uint8_t, kAxesMax>;
    [[nodiscard]] WatchedState& state(Watched watched) noexcept {
        return states_[static_cast<std::size_t>(watched)];
    }
    void judge_sync(const ReceiverEvent& event);
    void judge_tool(const AxisSnapshot& snapshot, bool is_braking);
    void judge_ack(const AxisSnapshot& snapshot);
    void judge_speeds(const AxisSnapshot& snapshot, const MotionRecord& record);

    const Machine& machine_;
    CapPromise cap_;
    std::array<WatchedState, static_cast<std::size_t>(Watched::count)> states_{};
    std::set<std::uint32_t> nonces_;
    std::int64_t session_us_ = 0;

    std::uint64_t first_sample_ = 0, last_sample_ = 0, samples_ = 0;
    std::int64_t first_us_ = 0, last_us_ = 0;
    double jitter_us_ = 0;
    bool has_wrong_period_ = false;

    std::uint16_t tool_ = 0;
    bool has_tool_ = false;
    std::optional<std::int64_t> announced_us_;

    std::array<Permit, 256> sent_{};  // by live counter
    std::uint64_t sent_count_ = 0;
    std::uint64_t acked_ = 0;  // of those sent, counted from 1; 0: none
    std::deque<Bounds> bounds_;
};

}  // namespace axg
