// SPDX-License-Identifier: Apache-2.0
// Frames that the live guard sends, in order of rank: stop, quick stops of drives, permit and twin,
// emergency, heartbeat, hashes, status for an operator, hints. The kernel may lose a frame that it
// accepted, so each half has one own frame in flight until its echo is seen: the permit and its
// twin wait for each other, and so do the last five. On the bus these lose against every axis
// frame, and a permit must not wait for them. The stop, the quick stops and the word stop wait for
// no echo; the first two are sent again. A full queue is tried again every 0.1 ms. No allocation,
// no wait.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/limits.hpp"
#include "firmware_if/can/can_transport.hpp"

namespace axg {

inline constexpr std::int64_t kSendRetryUs = 100;

/// Result of the frames since the last call.
struct OutboxResult {
    bool was_heard = false;              // an own frame was seen on the bus
    bool has_failed = false;             // one was refused for too long or not seen in time
    SendStatus status = SendStatus::ok;  // why; ok: its echo is missing
};

class Outbox {
  public:
    /// @param limit_us  longest time until the wire accepts a frame, and then to its echo
    Outbox(CanTransport& wire, std::int64_t limit_us) noexcept : wire_(wire), limit_us_(limit_us) {}

    /// Goes before everything else. Withdraws a permit and quick stops of an earlier stop that were
    /// not sent yet.
    void put_stop(const CanFrame& frame) noexcept;
    /// Follows the stop, in the order of the calls; kAxesMax at most, others are not sent.
    void put_quick_stop(const CanFrame& frame) noexcept;
    /// Replaces a pair of which no frame was sent yet.
    void put_permit(const std::array<CanFrame, 2>& pair) noexcept;
    /// The pair with the word stop, right after its stop and the quick stops. Only the stop's echo
    /// is awaited, and a repeated stop does not withdraw the pair.
    void put_stop_word(const std::array<CanFrame, 2>& pair) noexcept;
    void put_emergency(const CanFrame& frame) noexcept { put(kEmergency, frame); }
    void put_hash(const CanFrame& frame) noexcept { put(kHash, frame); }
    void put_heartbeat(const CanFrame& frame) noexcept { put(kHeartbeat, frame); }
    void put_status(const CanFrame& frame) noexcept { put(kStatus, frame); }
    void put_hints(const CanFrame& frame) noexcept { put(kHints, frame); }

    /// An own frame came back.
    void on_echo(const CanFrame& frame) noexcept;
    /// Sends only the stop and the frames after it; the result is in `work`.
    void send_stop(std::int64_t now_us) noexcept;
    /// Sends what may be sent now.
    [[nodiscard]] OutboxResult work(std::int64_t now_us) noexcept;
    /// Latest time of the next call of `work`; INT64_MAX: when a frame was put or came back.
    [[nodiscard]] std::int64_t next_due_us() const noexcept;

  private:
    enum Rank : std::uint8_t {
        kStop,
        kQuickStop,
        kPlain,
        kTwin,
        kEmergency,
        kHeartbeat,
        kHash,
        kStatus,
        kHints,
        kRanks
    };
    struct Slot {
        CanFrame frame;
        bool is_waiting = false;
        std::int64_t refused_us = 0;  // first time the kernel refused it; 0: not yet
    };

    /// A frame that was sent, without its echo yet.
    struct Flight {
        CanFrame frame;
        std::int64_t sent_us = 0;
        bool is_on = false;
    };

    void put(Rank rank, const CanFrame& frame) noexcept;
    void withdraw_permit() noexcept;
    [[nodiscard]] Rank next() const noexcept;
    [[nodiscard]] bool is_of_stop(Rank rank) const noexcept;
    [[nodiscard]] bool send_one(Rank rank, std::int64_t now_us, OutboxResult& result) noexcept;
    [[nodiscard]] bool is_missing(const Flight& flight, std::int64_t now_us) const noexcept {
        return flight.is_on && now_us - flight.sent_us > limit_us_;
    }
    void fail(OutboxResult& result, SendStatus status) noexcept;

    CanTransport& wire_;
    std::int64_t limit_us_;
    std::array<Slot, kRanks> slots_{};
    std::array<CanFrame, kAxesMax> quick_stops_{};
    std::uint32_t quick_next_ = 0, quick_end_ = 0;  // those between wait; the slot holds the first
    Flight urgent_, background_;                    // stop and permit; all others
    std::int64_t retry_us_ = 0;
    OutboxResult untold_;  // of send_stop(), for the next work()
    bool was_heard_ = false;
    bool is_stop_word_ = false;  // the pair that was put last
    bool owes_twin_ = false;  // the plain frame is out: its twin is due before anything but a stop
};

}  // namespace axg
