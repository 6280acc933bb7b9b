// SPDX-License-Identifier: Apache-2.0
// Runs the deployed guard again, turn by turn at the times of a dump that begins at the start of
// its process: it reads the recorded frames, receives its engine's results at the recorded times,
// and must send the same frames.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "firmware_if/guard/guard_node.hpp"

namespace axg {

/// Frames that were sent; `different` also counts missing and additional ones.
struct SentComparison {
    std::uint64_t same = 0, different = 0;
    std::optional<SentFrame> first_different;  // as recorded; an additional one as sent
};

/// The frames that were read in the turn, and the wire's status of each frame that was sent in it.
class RecordedWire final : public CanTransport {
  public:
    struct Reading {
        ReadStatus status = ReadStatus::frame;
        CanArrival arrival;  // status frame
    };

    void add(const Reading& reading) { readings_.push_back(reading); }
    void add(const SentFrame& sent) { sent_.push_back(sent); }
    [[nodiscard]] bool has_sent() const noexcept { return !sent_.empty(); }
    [[nodiscard]] bool has_readings() const noexcept { return !readings_.empty(); }
    /// Counts the recorded frames that were not sent as different.
    void end_turn() noexcept;
    [[nodiscard]] const SentComparison& comparison() const noexcept { return comparison_; }

    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override;
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override;

  private:
    void differ(const SentFrame& sent) noexcept;

    std::vector<Reading> readings_;  // of one turn, as the frames sent
    std::vector<SentFrame> sent_;
    std::size_t read_ = 0, made_ = 0;
    SentComparison comparison_;
};

class RecordedGuard {
  public:
    /// @param now_us      when the process constructed its guard
    /// @param is_latched  by an earlier run
    RecordedGuard(const Machine& machine, const LiveOptions& options, bool is_latched,
                  std::int64_t now_us);

    // Call in the order of the records. A result contains the recorded times.
    void on(const RecordedWire::Reading& reading, std::int64_t time_us);
    void on(const SentFrame& sent, std::int64_t time_us);
    void on(const LiveResult& live_result, std::int64_t time_us);
    void on(const LiveCall& call, std::int64_t time_us);
    void on_turn(std::int64_t time_us);
    /// After the last record.
    void end();

    [[nodiscard]] const SentComparison& comparison() const noexcept { return wire_.comparison(); }
    /// The newest stop.
    [[nodiscard]] const std::optional<LiveNote>& stop() const noexcept { return stop_; }
    [[nodiscard]] ReceiverFault stop_fault() const noexcept { return stop_fault_; }

  private:
    void run();
    void make_calls();
    void make(const LiveCall& call, std::int64_t time_us);

    RecordedWire wire_;
    LiveQueues queues_;
    LatchCell latch_{};
    std::optional<GuardNode> guard_;
    std::int64_t turn_us_;
    std::vector<std::pair<LiveCall, std::int64_t>> calls_;  // since the last turn, and when
    bool has_turn_ = false;
    std::optional<LiveNote> stop_;
    ReceiverFault fault_ = ReceiverFault::none, stop_fault_ = ReceiverFault::none;
};

}  // namespace axg
