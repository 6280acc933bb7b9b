// SPDX-License-Identifier: Apache-2.0
// The permits that a guard issues: their numbers, the board's session that they answer for, and the
// caps that its samples name. No clock, no allocation. Source: docs/reference/board.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/guard/ack_ledger.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

class PermitIssue {
  public:
    /// Both must outlive it.
    PermitIssue(const Machine& machine, const AxisReceiver& receiver) noexcept;

    /// The guard begins anew: the board no longer names earlier permits.
    void begin() noexcept { ledger_.clear(); }
    /// The caps in force on the board at a sample; of no meaning without guard.cap.
    [[nodiscard]] CapFacts note_sample(const ReceiverEvent& event) noexcept;

    /// The next permit. Without a sample counter no board can obey it, and it is not sent.
    [[nodiscard]] Permit issue(const LiveResult& result) noexcept;
    /// With the word stop, for a board that does not obey the stop frame. The board checks only
    /// the word and the twin: a guard without input has no sample to echo.
    [[nodiscard]] Permit stop_word() noexcept;

    /// The CRC of a permit covers the board's nonce and the sample's lap: the board would refuse a
    /// permit without them.
    [[nodiscard]] bool has_session_of(std::uint8_t sync_counter) const noexcept {
        return !has_sample_counter(machine_.can) || receiver_.session_of(sync_counter).has_value();
    }

    /// The board stopped by itself under permits. It latches: a person arms it, which draws a new
    /// nonce. Until then no person has checked the cause, which may be a frozen encoder.
    void note_own_stop() noexcept { own_stop_ = {.is_on = true, .nonce = newest_nonce()}; }
    /// A person armed the guard.
    void forget_own_stop() noexcept { own_stop_.is_on = false; }
    [[nodiscard]] bool has_own_stop() const noexcept { return own_stop_.is_on; }
    /// Nobody armed the board since.
    [[nodiscard]] bool waits_for_board() const noexcept;

  private:
    struct SeenOwnStop {
        bool is_on = false;
        std::optional<std::uint32_t> nonce;
    };
    [[nodiscard]] bool keeps_cap() const noexcept { return machine_.guard.cap != CapPromise::none; }
    [[nodiscard]] std::optional<std::uint32_t> newest_nonce() const noexcept;
    void answer(Permit& permit) const noexcept;

    const Machine& machine_;
    const AxisReceiver& receiver_;
    std::uint32_t age_samples_;  // of their positions
    AckLedger ledger_;           // permits that the samples of a board with caps name
    std::uint8_t live_counter_ = 0;
    SeenOwnStop own_stop_;
};

}  // namespace axg
