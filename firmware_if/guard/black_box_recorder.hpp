// SPDX-License-Identifier: Apache-2.0
// Passes bus events to the logger's black box: every frame read and sent passes through it, callers
// add the rest. It records sent frames at the end of the turn, so that a stop sent before the rest
// of the turn is recorded where the replay expects it. Never waits: when the queue is full, it
// counts the lost records, and the count is the next record that fits. No allocation.
#pragma once

#include <array>
#include <cstddef>
#include <variant>

#include "firmware_if/guard/black_box_record.hpp"

namespace axg {

class BlackBoxRecorder final : public CanTransport {
  public:
    /// @param queue  null: nothing is recorded
    BlackBoxRecorder(CanTransport& wire, BlackBoxQueue* queue) noexcept
        : wire_(wire), queue_(queue) {}

    /// Sets the time of all records from now on.
    void set_time(std::int64_t now_us) noexcept { now_us_ = now_us; }
    /// Every turn writes a record, so that a replay repeats all turns at their times. Notes do not
    /// count: they are also written between turns.
    void begin_turn(std::int64_t now_us) noexcept {
        now_us_ = now_us;
        has_record_ = false;
    }
    void end_turn() noexcept {
        add_sent();
        if (!has_record_) {
            add(EmptyTurn{});
        }
    }
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

    void add(const BlackBoxContent& content) noexcept {
        has_record_ = has_record_ || !std::holds_alternative<LiveNote>(content);
        if (queue_ == nullptr) {
            return;
        }
        const LostRecords gap{.count = untold_};
        if (untold_ != 0 && queue_->push({now_us_, gap})) {
            untold_ = 0;
        }
        if (untold_ != 0 || !queue_->push({now_us_, content})) {
            ++untold_;
            ++lost_;
        }
    }

    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override {
        const SendStatus status = wire_.send(frame);
        if (sent_count_ == sent_.size()) {
            add_sent();
        }
        sent_[sent_count_++] = {frame, status};
        return status;
    }
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override {
        const ReadStatus status = wire_.read(out);
        if (status == ReadStatus::frame) {
            add(out);
        } else if (status != ReadStatus::none) {
            add(status);
        }
        return status;
    }

  private:
    void add_sent() noexcept {
        for (std::size_t i = 0; i < sent_count_; ++i) {
            add(sent_[i]);
        }
        sent_count_ = 0;
    }

    CanTransport& wire_;
    BlackBoxQueue* queue_;
    std::int64_t now_us_ = 0;
    std::uint64_t lost_ = 0;
    std::uint32_t untold_ = 0;
    std::array<SentFrame, 32> sent_{};  // in this turn: a stop, and a quick stop for each drive
    std::size_t sent_count_ = 0;
    bool has_record_ = false;  // of this turn
};

}  // namespace axg
