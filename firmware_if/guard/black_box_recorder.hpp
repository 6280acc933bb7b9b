// SPDX-License-Identifier: Apache-2.0
// Hands what happens at the bus to the logger's black box: every frame read and sent passes through
// it, the rest is given to it. What was sent is handed over when the turn ends, so that a stop that
// leaves before the rest of the turn stands where the replay looks for it. Never waits: where the
// queue is full, what is lost is counted, and the count is the next record that finds room. No
// allocation.
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

    /// Stamps what comes from now on.
    void set_time(std::int64_t now_us) noexcept { now_us_ = now_us; }
    /// Every turn leaves a record, so that all of them can be made again at their times: a note is
    /// none, for notes are made between turns too.
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
