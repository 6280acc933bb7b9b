// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/added_session.hpp"

#include <optional>
#include <utility>

#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNonce = 0x5E5510;
constexpr std::uint32_t kFirst = 2;  // a guard accepts the session of a sample that it knows

class AddedSession final : public TraceReader {
  public:
    AddedSession(std::unique_ptr<TraceReader> trace, const CanLayout& can)
        : trace_(std::move(trace)), sync_id_(can.sync_id), session_id_(can.session_in_id) {}

    [[nodiscard]] bool next(CanFrame& frame) override {
        if (added_) {
            frame = *std::exchange(added_, std::nullopt);
            return true;
        }
        if (!trace_->next(frame)) {
            return false;
        }
        const bool is_plain = !frame.extended && !frame.remote && !frame.error && !frame.fd;
        if (is_plain && frame.id == sync_id_ && frame.length_bytes == 1) {
            on_sync(frame.data[0], frame.time_us);
        }
        return true;
    }
    [[nodiscard]] const std::string& error() const noexcept override { return trace_->error(); }
    [[nodiscard]] std::uint64_t line() const noexcept override { return trace_->line(); }
    [[nodiscard]] std::uint64_t skipped() const noexcept override { return trace_->skipped(); }
    [[nodiscard]] std::string first_skipped() const override { return trace_->first_skipped(); }
    [[nodiscard]] std::string_view device() const noexcept override { return trace_->device(); }
    [[nodiscard]] double share() const noexcept override { return trace_->share(); }

  private:
    void on_sync(std::uint8_t counter, std::int64_t time_us) {
        lap_ = static_cast<std::uint16_t>(lap_ + (counter < last_counter_ ? 1 : 0));
        last_counter_ = counter;
        if (sent_ >= kFirst && time_us - sent_us_ < kSessionPeriodUs) {
            return;
        }
        added_ = encode_session(session_id_,
                                {.nonce = kNonce,
                                 .lap = lap_,
                                 .sync_counter = counter,
                                 .counter = static_cast<std::uint8_t>(sent_ & 15U)},
                                time_us);
        ++sent_;
        sent_us_ = time_us;
    }

    std::unique_ptr<TraceReader> trace_;
    std::uint32_t sync_id_, session_id_, sent_ = 0;
    std::optional<CanFrame> added_;
    std::int64_t sent_us_ = 0;
    std::uint16_t lap_ = 0;
    std::uint8_t last_counter_ = 0;
};

}  // namespace

std::unique_ptr<TraceReader> with_session(std::unique_ptr<TraceReader> trace,
                                          const CanLayout& can) {
    return std::make_unique<AddedSession>(std::move(trace), can);
}

}  // namespace axg
